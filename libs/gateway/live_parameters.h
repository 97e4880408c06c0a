// SPDX-License-Identifier: Apache-2.0
// The live parameters of a session as the protocol shows them, and changes of them.
//
// A value is the scene's until the session has answered. Values are requested from the session when it begins, after a
// reset, and when another program has changed one; they are those that a change ends at, where it is spread over time.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/json.h"
#include "gateway/requests.h"
#include "scene/parameters.h"

namespace slew::gateway {

class LiveParameters {
 public:
  using Changed = std::function<void(const std::string& name)>;

  // requests: outlives this. changed: a value has changed.
  LiveParameters(const scene::Scene& scene, Requests& requests, Changed changed);

  // {name, value, type, unit, range, doc} of the named parameters, and `step`, from which the value holds, where the
  // session has stated it; minimum and maximum where the range has them. Empty: of all. Unknown names are left out, as
  // the protocol demands.
  [[nodiscard]] Json values(const std::vector<std::string>& names) const;

  // Empty: the session has accepted the change, which holds from the step on. Else the reason of the refusal.
  using Done = std::function<void(const std::string& problem, StepIndex step)>;
  // value: SI, or a text as for `slewring param set`: "1500kg", the name of a choice. owner: client.
  void set(const std::string& name, const std::variant<double, std::string>& value, std::optional<SimDuration> over,
           Requests::Owner owner, const Done& done, std::int64_t now_ns);

  // Requests all values again.
  void refresh();
  // A reply to another program's request.
  void take(const wire::ControlReply& reply);
  // Sends requests for values that wait.
  void poll(std::int64_t now_ns);

 private:
  struct Present {
    const scene::ParameterInfo* about = nullptr;
    double value = 0;            // SI
    StepIndex step = kJoinStep;  // -1: the scene's
  };
  [[nodiscard]] Json to_json(const Present& present) const;
  void take_value(const std::string& name, double value, StepIndex step);

  scene::ParameterDirectory directory_;
  Requests& requests_;
  Changed changed_;
  std::map<std::string, Present, std::less<>> live_;  // by path
  std::deque<std::string> to_request_;
};

}  // namespace slew::gateway
