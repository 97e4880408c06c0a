// SPDX-License-Identifier: Apache-2.0
// The terminal's keyboard as a controller: reads keys without waiting, keeps lever positions, publishes them.
//
// The first channels of the scene get a pair of keys each (q/a, w/s, e/d, r/f, t/g, y/h) that move the lever by a tenth
// up and down; left/right are the first channel too, up/down the second. A digital channel is toggled by its upper key.
// Inputs with a lockstep controller are left to it. Space puts everything to neutral. Levers keep their positions,
// since a terminal reports no key releases.
#pragma once

#include <termios.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "observer/observer.h"
#include "scene/scene.h"

namespace slew::cli {

// The lever positions that the keys have set. Independent of a terminal: for tests.
class Levers {
 public:
  explicit Levers(const std::vector<scene::InputDef>& inputs);

  // Characters as a terminal sends them; arrows are escape sequences.
  void take_keys(std::string_view keys);

  [[nodiscard]] std::size_t size() const noexcept { return levers_.size(); }
  [[nodiscard]] const std::string& channel(std::size_t i) const noexcept { return levers_[i].channel; }
  [[nodiscard]] double value(std::size_t i) const noexcept { return levers_[i].tenths * 0.1; }
  // "q/a Input_Slew  w/s Input_Lift  space neutral".
  [[nodiscard]] std::string help() const;

 private:
  struct Lever {
    std::string channel;
    bool is_digital = false;
    int tenths = 0;
  };
  void move(std::size_t lever, int direction);
  std::vector<Lever> levers_;
};

class Keyboard {
 public:
  // Throws Failure (bad_input) when standard input is no terminal.
  explicit Keyboard(const scene::Scene& scene);
  // Restores the terminal.
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  [[nodiscard]] const Levers& levers() const noexcept { return levers_; }
  // Reads the typed keys and publishes the levers every 50 ms.
  void poll(observer::Observer& observer, std::int64_t now_ns);

 private:
  void publish(observer::Observer& observer, std::size_t lever, wire::ControllerAction action);
  void acquire_missing(observer::Observer& observer);

  Levers levers_;
  termios saved_{};
  std::int64_t next_write_ns_ = 0;
  std::int64_t next_acquire_ns_ = 0;
  std::uint64_t sequence_ = std::random_device()() * (std::uint64_t{1} << 31);  // no other process's numbers
};

}  // namespace slew::cli
