// SPDX-License-Identifier: Apache-2.0
// Values of XML elements: names, numbers, triples; problems go to the report with the element's line.
#pragma once

#include <tinyxml2.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "scene/diagnostic.h"
#include "urdf/robot.h"

namespace slew::urdf {

using tinyxml2::XMLElement;

// kg, kg m2: below a grain of dust; exporters print -5e-20 for 0.
inline constexpr double kRoundOff = 1e-15;

class ElementValues {
 public:
  ElementValues(int source, scene::Report& report, std::vector<Note>& notes)
      : source_(source), report_(report), notes_(notes) {}

  // "link 'arm'": prefix of a problem.
  void set_owner(std::string owner) { owner_ = std::move(owner); }
  void report_problem(const XMLElement& element, std::string what, std::string expected = "") {
    report_.add({source_, element.GetLineNum(), 0}, owner_, {std::move(what), std::move(expected), ""});
  }
  void note(const XMLElement& element, const std::string& text) {
    notes_.push_back({element.GetLineNum(), owner_.empty() ? text : owner_ + ": " + text});
  }

  // Text of an attribute; reports a problem if it is missing or empty.
  [[nodiscard]] std::optional<std::string> name(const XMLElement& element, const char* attribute);

  // A finite decimal number; `missing` for an attribute that is not there, reports a problem if that is empty.
  [[nodiscard]] double number(const XMLElement& element, const char* attribute, std::optional<double> missing);
  [[nodiscard]] double number_not_negative(const XMLElement& element, const char* attribute,
                                           std::optional<double> missing);
  // A value that rounding made negative is 0: kRoundOff.
  [[nodiscard]] double moment(const XMLElement& element, const char* attribute);
  [[nodiscard]] Triple triple(const XMLElement& element, const char* attribute, std::optional<Triple> missing);

  // The child with this tag, or null; reports a problem of every further one: none of them would have an effect.
  [[nodiscard]] const XMLElement* only_child(const XMLElement& element, const char* tag);

  // The element's <origin>, or none.
  [[nodiscard]] Origin origin(const XMLElement& element);

  // Notes the attributes that are not in the list.
  void note_other_attributes(const XMLElement& element, std::span<const std::string_view> known);

 private:
  int source_;
  scene::Report& report_;
  std::vector<Note>& notes_;
  std::string owner_;
};

}  // namespace slew::urdf
