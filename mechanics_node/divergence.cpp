// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/divergence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/index.h"
#include "multibody/flexible/deflection.h"
#include "multibody/results/observe.h"

namespace slew::mechanics_node {
namespace {

constexpr double kHalfTurn = std::numbers::pi;  // rad; in a sub-step: beyond, the direction of the turn is unknown
constexpr double kFar = 1;                      // m a sub-step: no body of a machine moves so far
constexpr double kOpen = 1e-6;                  // m or rad: a sound joint stays below, except in `penalty`
constexpr const char* kRemedy =
    "the motion is not the mechanism's any more. Use a shorter session.step or mechanics.max_substep, or another "
    "mechanics.integrator or formulation";
// before the name of a motion
constexpr const char* kDriven = "; or keep the loop off a dead centre, past which it cannot follow the motion ";

struct BentBody {
  std::string_view name;
  double share = 0;  // deflection over its length
};

BentBody most_bent(const multibody::Model& model, const multibody::State& state,
                   const multibody::Workspace& ws) noexcept {
  BentBody most;
  const auto look = [&most](const std::string& name, double share) {
    if (share > most.share) most = {name, share};
  };
  for (std::size_t part = 0; part < model.parts.size(); ++part) {
    look(model.parts[part].name, multibody::deflection_share(model, part, state.q));
  }
  for (const multibody::SegmentedPart& part : model.segmented) {
    look(part.name, multibody::deflection_share(model, part, ws));
  }
  return most;
}

struct FastBody {
  std::string_view name;
  double speed = 0;  // m/s or rad/s
};

template <typename Speed>
FastBody fastest(const multibody::Model& model, const multibody::Workspace& ws, Speed speed_of) noexcept {
  FastBody found;
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const double speed = norm(speed_of(ws.motion[at(model.bodies[i].link)]));
    if (found.name.empty() || speed > found.speed) found = {model.bodies[i].name, speed};
  }
  return found;
}

// True if the joint of this link lies in the loop that the cut joint closes.
bool is_in_loop(const multibody::Model& model, const multibody::Cut& cut, int link) noexcept {
  const auto is_above = [&](int end) {
    while (end > 0 && end != link) end = model.links[at(end)].parent;
    return end == link;
  };
  return is_above(cut.link1) != is_above(cut.link2);
}

// The first prescribed motion that drives a joint of a loop; empty: none.
std::string_view motion_of_loop(const multibody::Model& model) noexcept {
  for (const multibody::Drive& drive : model.drives) {
    for (const multibody::Cut& cut : model.cuts) {
      const bool drives_it = drive.link > 0 ? is_in_loop(model, cut, drive.link) : cut.joint == drive.joint;
      if (drives_it) return drive.name;
    }
  }
  return {};
}

}  // namespace

void DivergenceWatch::count_step(bool has_converged) noexcept {
  unconverged_ = std::clamp(unconverged_ + (has_converged ? -1 : 1), 0, kMostUnconverged);
}

template <typename... Values>
void DivergenceWatch::write(const char* form, const Values&... values) noexcept {
  const auto written = fmt::format_to_n(text_.data(), text_.size(), fmt::runtime(form), values...);
  text_length_ = std::min(written.size, text_.size());
}

bool DivergenceWatch::name_bent_body(const multibody::Model& model, const multibody::State& state,
                                     const multibody::Workspace& ws) noexcept {
  const BentBody bent = most_bent(model, state, ws);
  if (!(bent.share > multibody::kLostDeflection)) return false;
  write("{}: bent by {:.3g} times its length, further than a body can be; {}, fewer modes, or type: segmented",
        bent.name, bent.share, kRemedy);
  return true;
}

bool DivergenceWatch::name_turned_frames(const multibody::Model& model, const multibody::Workspace& ws) noexcept {
  const auto name_if_turned = [&](const std::string& name, const multibody::FramePair& pair, const char* kind) {
    const double turn =
        norm(multibody::deflection_of(pair, ws.motion[at(pair.link1)], ws.motion[at(pair.link2)]).theta);
    if (!(turn > multibody::kMostBushingRotation)) return false;
    write(
        "{}: its frames are turned by {:.4g} deg against each other, and at 180 deg a {}'s moment jumps. Use a "
        "rotational force about the axis of a revolute joint, or limits that keep the frames below 170 deg",
        name, turn * 180 / std::numbers::pi, kind);
    return true;
  };
  for (const multibody::Bushing& bushing : model.elements.bushings) {
    if (multibody::holds_rotation(bushing) && name_if_turned(bushing.name, bushing.frames, "bushing")) return true;
  }
  return std::any_of(model.elements.beams.begin(), model.elements.beams.end(),
                     [&](const multibody::Beam& beam) { return name_if_turned(beam.name, beam.frames, "beam"); });
}

bool DivergenceWatch::name_turned_angle(const multibody::Model& model, const multibody::Workspace& ws,
                                        double H) noexcept {
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    const multibody::AngleElement& element = model.angles[i];
    const multibody::ElementLaw& law = element.law;
    const bool has_coordinate = element.has_row || law.spring != 0 || law.end_spring > 0 || !law.spring_curve.empty();
    if (element.is_coaxial || !has_coordinate) continue;
    const multibody::AngleMotion& motion = ws.angles[i];
    const double ahead = motion.angle * motion.rate > 0 ? std::fabs(motion.rate) * H : 0;
    if (!(std::fabs(motion.angle) + ahead > kHalfTurn)) continue;
    write(
        "{}: its angle is {:.4g} deg, and at 180 deg it jumps by a whole turn: revolute joints about its axis, which "
        "would count turns, do not connect its bodies. Use a revolute joint, or limits of the joint that keep the "
        "angle within 180 deg",
        element.name, motion.angle * 180 / std::numbers::pi);
    return true;
  }
  return false;
}

bool DivergenceWatch::name_suspect(const multibody::Model& model, const multibody::State& state,
                                   const multibody::Workspace& ws, double h) noexcept {
  constexpr const char* kOften = "of late more steps did not converge than did";
  if (const BentBody bent = most_bent(model, state, ws); bent.share > multibody::kSmallDeflection) {
    write("{}: {}, and it is bent by {:.2g} of its length: {}", bent.name, kOften, bent.share, kRemedy);
    return true;
  }
  const FastBody turning = fastest(model, ws, [](const multibody::LinkMotion& m) { return m.w; });
  if (turning.speed * h > kHalfTurn) {
    write("{}: {}, and it turns by {:.2g} rad in a sub-step: {}", turning.name, kOften, turning.speed * h, kRemedy);
    return true;
  }
  if (const multibody::JointGap gap = gauge_.measure(ws); gap.joint >= 0 && gap.position > kOpen) {
    const multibody::Joint& joint = model.joints[at(gap.joint)];
    const int body = joint.body2 > 0 ? joint.body2 : joint.body1;
    const std::string_view motion = motion_of_loop(model);
    write("{}: {}, and its joint '{}' is open by {:.2g} m or rad: {}{}{}", model.bodies[at(body)].name, kOften,
          joint.name, gap.position, kRemedy, motion.empty() ? "" : kDriven, motion);
    return true;
  }
  const FastBody moving = fastest(model, ws, [](const multibody::LinkMotion& m) { return m.v; });
  if (!(moving.speed * h <= kFar)) {
    write("{}: {}, and it is the fastest body with {:.3g} m/s: {}", moving.name, kOften, moving.speed, kRemedy);
    return true;
  }
  return false;
}

void DivergenceWatch::name_lost_motion(const multibody::Model& model, std::string_view joint) noexcept {
  const std::string_view motion = motion_of_loop(model);
  if (motion.empty()) return;
  write(
      "{} is not finite; the last good state is kept in the recording; reduce session.step, or look at what happened "
      "just before in a plot{}{}",
      joint, kDriven, motion);
}

bool DivergenceWatch::ends_run(const multibody::Model& model, const multibody::State& state,
                               const multibody::Workspace& ws, double h, double H) noexcept {
  if (name_bent_body(model, state, ws) || name_turned_frames(model, ws) || name_turned_angle(model, ws, H)) return true;
  if (unconverged_ < kMostUnconverged) return false;
  return name_suspect(model, state, ws, h);
}

}  // namespace slew::mechanics_node
