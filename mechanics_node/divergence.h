// SPDX-License-Identifier: Apache-2.0
// Ends a run whose motion has left the mechanism's while its numbers are still finite.
//
// Three rules, checked after every step:
//   - The excess of steps that did not converge over those that did reaches kMostUnconverged (more than half of the
//     steps), and the motion shows an error: a body is bent beyond small deflections, turns by half a turn or moves by
//     a metre in a sub-step, or a joint is open. The count decreases by one with each converged step, down to zero, so
//     that single steps never add up to an end. Without such an error (a wheel of 6000 rpm on its axis, a load that is
//     pressed onto a stiff stop) the steps are only flagged.
//   - A flexible body is bent by more than kLostDeflection of its length (multibody/flexible/deflection.h).
//   - A bushing that holds rotation, or a beam, is turned by more than kMostBushingRotation, short of the jump of its
//     moment.
//   - The angle of a rotational force with a spring, an end damper or an actuator comes within one step of half a turn,
//     unless revolute joints about its axis count its turns: there the angle jumps by a whole turn.
// A drive may push its loop past a dead centre, where no pose closes it: beside an open joint, and a joint that is not
// finite, the text then names a prescribed motion that drives a loop.
// Not covered: motion that is finite, small and converged, and wrong.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "core/state_hash.h"
#include "multibody/joints/joint_gauge.h"
#include "multibody/model/model.h"
#include "multibody/model/state.h"

namespace slew::mechanics_node {

// More than a hit, a stop or a whip takes in a sound run: no step of the repository's scenes fails to converge at steps
// of 0.5 to 5 ms.
inline constexpr int kMostUnconverged = 20;  // steps

class DivergenceWatch {
 public:
  // Allocates.
  explicit DivergenceWatch(const multibody::Model& model) : gauge_(model) {}

  void reset() noexcept { unconverged_ = 0, text_length_ = 0; }
  void count_step(bool has_converged) noexcept;

  // For the motion in ws, as Dynamics::observe() leaves it, and sub-steps of h [s] in steps of H [s]. True: the run
  // ends; text() names the body or the force and the reason. Neither allocates.
  [[nodiscard]] bool ends_run(const multibody::Model& model, const multibody::State& state,
                              const multibody::Workspace& ws, double h, double H) noexcept;
  // After a state that is not finite: if a prescribed motion drives a loop, the text names it beside the joint.
  void name_lost_motion(const multibody::Model& model, std::string_view joint) noexcept;
  [[nodiscard]] std::string_view text() const noexcept { return {text_.data(), text_length_}; }

  // Adds nothing while all recent steps have converged: the hash of a sound run is that of its motion.
  void add_to(StateHash& hash) const noexcept {
    if (unconverged_ != 0) hash.add(unconverged_);
  }
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes) {
    bytes.count(self.unconverged_, kMostUnconverged);
    bytes.count(self.text_length_, self.text_.size());
    bytes.numbers(std::span(self.text_).first(self.text_length_));
  }

 private:
  [[nodiscard]] bool name_bent_body(const multibody::Model& model, const multibody::State& state,
                                    const multibody::Workspace& ws) noexcept;
  [[nodiscard]] bool name_turned_frames(const multibody::Model& model, const multibody::Workspace& ws) noexcept;
  [[nodiscard]] bool name_turned_angle(const multibody::Model& model, const multibody::Workspace& ws,
                                       double H) noexcept;
  [[nodiscard]] bool name_suspect(const multibody::Model& model, const multibody::State& state,
                                  const multibody::Workspace& ws, double h) noexcept;
  template <typename... Values>
  void write(const char* form, const Values&... values) noexcept;

  multibody::JointGauge gauge_;
  int unconverged_ = 0;  // excess, at most kMostUnconverged
  std::array<char, 512> text_{};
  std::size_t text_length_ = 0;
};

}  // namespace slew::mechanics_node
