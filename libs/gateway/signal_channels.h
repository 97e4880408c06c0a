// SPDX-License-Identifier: Apache-2.0
// Named signals: one channel for each element, with its variables as fields, so that a plot finds `Cyl_Lift.force` as
// field `force` of topic `/Cyl_Lift`.
//
// The parts of a variable's name behind the element are nested objects: Bag.position.x is {"position": {"x": 0.5}}.
// Values are numbers in SI; the schema has the unit of each as "unit" and "description". A value that does not exist or
// is not finite is null. The order of the elements and fields is that of the variables.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "gateway/step_snapshot.h"
#include "observer/session_view.h"

namespace slew::gateway {

struct SignalChannel {
  std::string topic;        // "/Cyl_Lift"
  std::string schema_name;  // "slewring.Cyl_Lift"
  std::string schema;       // JSON schema
  struct Piece {
    std::string text;  // of the message, in front of the value
    observer::VariablePlace place;
  };
  std::vector<Piece> pieces;
  std::string end;  // of the message

  // A message with the values of a snapshot, appended.
  void encode(const StepSnapshot& snapshot, std::string& message) const;
};

struct NamedPlace {
  std::string name;  // "Cyl_Lift.force"
  std::string unit;
  observer::VariablePlace place;
};

[[nodiscard]] std::vector<SignalChannel> signal_channels(std::span<const NamedPlace> variables);

// JSON text of a number: null if it is not finite, else the shortest that reads as the same number.
void put_number(double value, std::string& text);

}  // namespace slew::gateway
