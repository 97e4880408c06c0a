// SPDX-License-Identifier: Apache-2.0
// The messages of a session as JSON, with the names of idl/slewring.idl: the expected result of an independent decoder.
//
// Written from the structs, not from the bytes. Integers of 64 bits and numbers that JSON lacks become strings.
#pragma once

#include <nlohmann/json.hpp>

#include "transport/wire.h"

namespace slew::recording {

[[nodiscard]] nlohmann::json to_json(const wire::SessionDescription& m);
[[nodiscard]] nlohmann::json to_json(const wire::NodeStatus& m);
[[nodiscard]] nlohmann::json to_json(const wire::Tick& m);
[[nodiscard]] nlohmann::json to_json(const wire::MechanismMessage& m);
[[nodiscard]] nlohmann::json to_json(const wire::ActuatorMessage& m);
[[nodiscard]] nlohmann::json to_json(const wire::FlexibleMessage& m);
[[nodiscard]] nlohmann::json to_json(const wire::ElasticMessage& m);
[[nodiscard]] nlohmann::json to_json(const wire::VariableDirectory& m);
[[nodiscard]] nlohmann::json to_json(const wire::VariableBlock& m);
[[nodiscard]] nlohmann::json to_json(const wire::ControllerInput& m);
[[nodiscard]] nlohmann::json to_json(const wire::ControllerLease& m);
[[nodiscard]] nlohmann::json to_json(const wire::ControlRequest& m);
[[nodiscard]] nlohmann::json to_json(const wire::ControlReply& m);
[[nodiscard]] nlohmann::json to_json(const wire::Health& m);
[[nodiscard]] nlohmann::json to_json(const wire::ResendRequest& m);
[[nodiscard]] nlohmann::json to_json(const wire::StatePart& m);

}  // namespace slew::recording
