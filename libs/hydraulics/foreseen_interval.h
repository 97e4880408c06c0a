// SPDX-License-Identifier: Apache-2.0
// What the actuators do over an interval that comes, and how a relaxing spring would answer to their motion.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slew::hydraulics {

// Over H seconds: integrals of the pressure force F, its end, and the mean springs of the chambers.
struct ForeseenActuator {
  double impulse = 0;    // N s, int F dt
  double moment = 0;     // N s2, int F (H - t) dt
  double end = 0;        // N
  double K[2] = {0, 0};  // N/m, means of the springs of chambers A and B
};

// r' = v - v_ref - lambda r from r = 0, and its integrals over H.
struct SpringWay {
  double r = 0;       // m
  double way = 0;     // m s, int r dt
  double moment = 0;  // m s2, int r (H - t) dt
};

class ForeseenInterval {
 public:
  explicit ForeseenInterval(std::size_t ports);

  std::vector<ForeseenActuator> actuators;

  void clear() noexcept;
  // A sub-step of h seconds, then the speeds of all actuators in it: v - v_ref [m/s] at both ends, the acceleration
  // [m/s2] at the begin. False: too many sub-steps. No allocation.
  [[nodiscard]] bool add(double h) noexcept;
  void add_speed(double begin, double acceleration, double end) noexcept {
    speeds_.push_back({begin, acceleration, end});
  }
  // Of the actuator j, speeds by the parabola of each sub-step.
  [[nodiscard]] SpringWay way(std::size_t j, double lambda) const noexcept;

 private:
  struct Speed {
    double begin, acceleration, end;
  };
  std::vector<double> h_;
  std::vector<Speed> speeds_;  // of all actuators, sub-step after sub-step
};

}  // namespace slew::hydraulics
