// SPDX-License-Identifier: Apache-2.0
// Lists of variables as plain LCM structs of their own: step, time, and one double for each variable.
//
//   crane=Cyl_Lift.stroke,Cyl_Lift.force      ->      struct crane_t {
//                                                       int64_t step;
//                                                       double time;              // s
//                                                       double Cyl_Lift_stroke;   // m
//                                                       double Cyl_Lift_force;    // N
//                                                     }
// The fingerprint is the one that lcm-gen computes for this text, so that its code decodes these messages.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/status.h"

namespace slew::lcm_log {

struct SignalList {
  std::string name;                    // of the struct, without _t, and of the channel: an identifier
  std::vector<std::string> variables;  // "Cyl_Lift.stroke"
  std::vector<std::string> fields{};   // "Cyl_Lift_stroke"
  std::int64_t fingerprint = 0;
};

// Reads NAME=var,var... Error (bad_input): a wrong form, or two variables with one name of a field.
[[nodiscard]] Status read_signal_list(const std::string& text, SignalList& list);

// values: in the order of the list's variables.
void encode(const SignalList& list, std::int64_t step, double time, std::span<const double> values, std::string& bytes);

// The text for lcm-gen. units: of the variables, by list.
[[nodiscard]] std::string types_text(std::span<const SignalList> lists,
                                     std::span<const std::vector<std::string>> units);

}  // namespace slew::lcm_log
