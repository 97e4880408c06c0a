// SPDX-License-Identifier: Apache-2.0
// One mass on one oil spring, split at the spring: the linear system on which coupling levels are analysed
// (coupling study, section 3).
//
//   m v' = F - d v,   F' = -K v - lambda F,   omega = sqrt(K / m),   d = 2 zeta omega m
//
// Both halves are integrated by the code of the nodes: PortDynamics on the mechanics' side, RODAS3 on the hydraulics';
// of level tlm the equations of hydraulics/line_chambers.h with the shares that the circuit has, the chamber's own part
// in closed form.
// m = 1 kg and omega = 1 rad/s, so that H is Omega = omega H.
#pragma once

#include <memory>

#include "coupling/level.h"

namespace slew::coupling::test {

// Whether the hydraulics takes the mechanics' true position at each exchange.
enum class Volume { consistent, own };

struct OscillatorDef {
  double Omega = 0.1;  // omega H
  double zeta = 0;     // mechanical damping ratio
  double lambda = 0;   // leakage of the spring, in omega
  Level level = Level::two;
  Volume volume = Volume::consistent;
};

class SplitOscillator {
 public:
  explicit SplitOscillator(const OscillatorDef& def);
  ~SplitOscillator();
  SplitOscillator(const SplitOscillator&) = delete;
  SplitOscillator& operator=(const SplitOscillator&) = delete;

  void step();
  // sqrt(v^2 + F^2 / (K m)), F moved to the true position, of a line the mean of both waves; 1 at the start.
  [[nodiscard]] double amplitude() const;
  [[nodiscard]] double speed() const;

 private:
  void step_of_line();

  struct Halves;
  std::unique_ptr<Halves> halves_;
};

// Mean growth of the amplitude per unit of omega t over a number of exchanges, by the ratio of late to early maxima.
[[nodiscard]] double growth_rate(const OscillatorDef& def, int exchanges);

// Frequency of the swing over omega, from the zeros of the speed.
[[nodiscard]] double frequency(const OscillatorDef& def, int exchanges);

}  // namespace slew::coupling::test
