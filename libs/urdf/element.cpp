// SPDX-License-Identifier: Apache-2.0
#include "urdf/element.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace slew::urdf {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

// Removes and returns the number at the start of the text; nothing if there is no finite number.
std::optional<double> take_number(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  std::string_view digits = text;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text = digits.substr(static_cast<std::size_t>(end - digits.data()));
  if (!text.empty() && kSpace.find(text.front()) == std::string_view::npos) return std::nullopt;
  return value;
}

bool is_blank(std::string_view text) {
  return text.find_first_not_of(kSpace) == std::string_view::npos;
}

std::string in_tag(const XMLElement& element, const char* attribute) {
  return fmt::format("<{} {}>", element.Name(), attribute);
}

}  // namespace

std::optional<std::string> ElementValues::name(const XMLElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  if (text != nullptr && !is_blank(text)) return text;
  report_problem(element, fmt::format("{} has no value", in_tag(element, attribute)), "a name");
  return std::nullopt;
}

double ElementValues::number(const XMLElement& element, const char* attribute, std::optional<double> missing) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) {
    if (!missing) report_problem(element, fmt::format("{} is missing", in_tag(element, attribute)), "a number");
    return missing.value_or(0);
  }
  std::string_view rest = text;
  const std::optional<double> value = take_number(rest);
  if (value && is_blank(rest)) return *value;
  report_problem(element, fmt::format("{} is '{}'", in_tag(element, attribute), text), "a finite number");
  return 0;
}

double ElementValues::number_not_negative(const XMLElement& element, const char* attribute,
                                          std::optional<double> missing) {
  const double value = number(element, attribute, missing);
  if (value < -kRoundOff) {
    report_problem(element, fmt::format("{} is {}", in_tag(element, attribute), value), "at least 0");
  }
  return std::max(value, 0.0);
}

double ElementValues::moment(const XMLElement& element, const char* attribute) {
  const double value = number(element, attribute, std::nullopt);
  return value < 0 && value >= -kRoundOff ? 0 : value;
}

Triple ElementValues::triple(const XMLElement& element, const char* attribute, std::optional<Triple> missing) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) {
    if (!missing) report_problem(element, fmt::format("{} is missing", in_tag(element, attribute)), "three numbers");
    return missing.value_or(Triple{});
  }
  Triple values{};
  std::string_view rest = text;
  for (double& value : values) {
    const std::optional<double> one = take_number(rest);
    if (!one) {
      report_problem(element, fmt::format("{} is '{}'", in_tag(element, attribute), text), "three finite numbers");
      return {};
    }
    value = *one;
  }
  if (!is_blank(rest)) {
    report_problem(element, fmt::format("{} is '{}'", in_tag(element, attribute), text), "three finite numbers");
  }
  return values;
}

const XMLElement* ElementValues::only_child(const XMLElement& element, const char* tag) {
  const XMLElement* const child = element.FirstChildElement(tag);
  if (child == nullptr) return nullptr;
  for (const auto* other = child->NextSiblingElement(tag); other != nullptr; other = other->NextSiblingElement(tag)) {
    report_problem(*other, fmt::format("<{}> has a second <{}>", element.Name(), tag), "one");
  }
  return child;
}

Origin ElementValues::origin(const XMLElement& element) {
  const XMLElement* origin = only_child(element, "origin");
  if (origin == nullptr) return {};
  constexpr std::string_view kKnown[] = {"xyz", "rpy"};
  note_other_attributes(*origin, kKnown);
  return {.xyz = triple(*origin, "xyz", Triple{}), .rpy = triple(*origin, "rpy", Triple{})};
}

void ElementValues::note_other_attributes(const XMLElement& element, std::span<const std::string_view> known) {
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    if (std::find(known.begin(), known.end(), attribute->Name()) != known.end()) continue;
    note(element, fmt::format("{}=\"{}\" is not taken over", in_tag(element, attribute->Name()), attribute->Value()));
  }
}

}  // namespace slew::urdf
