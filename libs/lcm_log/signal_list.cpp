// SPDX-License-Identifier: Apache-2.0
#include "lcm_log/signal_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <string_view>

#include "lcm_log/big_endian.h"

namespace slew::lcm_log {
namespace {

constexpr std::uint64_t kHashBegin = 0x12345678;

// locale-independent
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool is_letter_or_digit(char c) {
  return is_letter(c) || (c >= '0' && c <= '9');
}

std::string field_of(const std::string& variable) {
  std::string field;
  for (const char c : variable) field += is_letter_or_digit(c) ? c : '_';
  return !field.empty() && is_letter(field.front()) ? field : "v_" + field;
}

// lcm-gen's fingerprint of a struct without nested ones: of each member its name, its primitive type and its
// dimensions, which are none here.
class Fingerprint {
 public:
  void add_member(std::string_view name, std::string_view type) {
    add(name);
    add(type);
    add('\0');
  }
  [[nodiscard]] std::int64_t value() const noexcept { return static_cast<std::int64_t>(std::rotl(hash_, 1)); }

 private:
  void add(char c) noexcept {
    const auto sign_filled = static_cast<std::uint64_t>(static_cast<std::int64_t>(hash_) >> 55);
    hash_ = ((hash_ << 8) ^ sign_filled) + static_cast<std::uint64_t>(static_cast<std::int64_t>(c));
  }
  void add(std::string_view text) noexcept {
    add(static_cast<char>(text.size()));
    for (const char c : text) add(c);
  }
  std::uint64_t hash_ = kHashBegin;
};

}  // namespace

Status read_signal_list(const std::string& text, SignalList& list) {
  const auto refuse = [&](const std::string& problem) {
    return Status::error(ExitCode::bad_input, "--signals " + text + ": " + problem +
                                                  "; nothing was started; expected for example "
                                                  "crane=Cyl_Lift.stroke,Cyl_Lift.force");
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return refuse("the '=' is missing");
  list = {text.substr(0, equals), {}};
  const bool is_identifier =
      !list.name.empty() && is_letter(list.name.front()) &&
      std::all_of(list.name.begin(), list.name.end(), [](char c) { return is_letter_or_digit(c) || c == '_'; });
  if (!is_identifier) return refuse("'" + list.name + "' is no name of a struct (letters, digits and _)");
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string variable = text.substr(begin, end - begin);
    if (variable.empty()) return refuse("the name of a variable is missing");
    list.variables.push_back(variable);
    begin = end + 1;
  }
  Fingerprint fingerprint;
  list.fields = {"step", "time"};
  fingerprint.add_member("step", "int64_t");
  fingerprint.add_member("time", "double");
  for (const std::string& variable : list.variables) {
    const std::string field = field_of(variable);
    if (std::find(list.fields.begin(), list.fields.end(), field) != list.fields.end())
      return refuse("two members would have the name " + field);
    fingerprint.add_member(field, "double");
    list.fields.push_back(field);
  }
  list.fields.erase(list.fields.begin(), list.fields.begin() + 2);
  list.fingerprint = fingerprint.value();
  return Status::ok();
}

void encode(const SignalList& list, std::int64_t step, double time, std::span<const double> values,
            std::string& bytes) {
  bytes.clear();
  put_big_endian(bytes, list.fingerprint);
  put_big_endian(bytes, step);
  put_big_endian(bytes, std::bit_cast<std::uint64_t>(time));
  for (const double value : values) put_big_endian(bytes, std::bit_cast<std::uint64_t>(value));
}

std::string types_text(std::span<const SignalList> lists, std::span<const std::vector<std::string>> units) {
  std::string text = "// Written by 'slewring bridge lcm --write-types'.\npackage slewring;\n";
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const SignalList& list = lists[i];
    text += fmt::format("\nstruct {}_t {{\n  int64_t step;\n  double time;  // s\n", list.name);
    for (std::size_t k = 0; k < list.fields.size(); ++k)
      text += fmt::format("  double {};  // {} [{}]\n", list.fields[k], list.variables[k], units[i][k]);
    text += "}\n";
  }
  return text;
}

}  // namespace slew::lcm_log
