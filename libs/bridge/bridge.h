// SPDX-License-Identifier: Apache-2.0
// `slewring bridge lcm`: a live session towards LCM, which takes inputs and parameter requests from there.
//
// The bridge is an observer of the session and a controller in it, in a process of its own: LCM loses messages, so
// nothing of it may be part of a step.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridge/settings.h"
#include "core/json.h"
#include "observer/observer.h"

namespace slew::bridge {

class Bridge {
 public:
  // Checks the settings before anything is opened. Throws Failure.
  explicit Bridge(Settings settings);
  ~Bridge();

  // Of the observer that is given to the others.
  [[nodiscard]] observer::Receiver& receiver() noexcept;
  // It sends into the session.
  [[nodiscard]] bool is_door() const noexcept;

  // The types of the signal lists, with the units of the session. Throws Failure.
  [[nodiscard]] std::string types(observer::Observer& observer);
  // Until the session ends or a stop is requested. report: takes a line for the user. Throws Failure.
  void run(observer::Observer& observer, const SceneView& scene, const std::function<void(const std::string&)>& report);
  // What it did, for programs and as text.
  [[nodiscard]] Json summary() const;
  [[nodiscard]] std::string summary_text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slew::bridge
