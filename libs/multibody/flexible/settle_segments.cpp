// SPDX-License-Identifier: Apache-2.0
// Static equilibrium of bodies of finite segments at the start.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/index.h"
#include "math/small_solve.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/flexible/segmented_part.h"
#include "multibody/formulations/passes.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Mat3;
using math::Quaternion;
using math::Vec3;

namespace {

constexpr int kMostSettlingCorrections = 60;
constexpr int kMostSettlingHalvings = 12;
constexpr int kPatience = 3;                // corrections by compliance without required decrease
constexpr double kShrinks = 0.5;            // required decrease; otherwise Newton's method
constexpr double kSegmentsSettled = 1e-12;  // largest correction: m over the connector's length, rad
constexpr double kSettlingRounding = 1e-8;  // below it corrections that do not shrink any more are rounding
constexpr double kSettlingProbe = 1e-7;     // step of the differences, the same

class Chains {
 public:
  Chains(const Model& model, const std::vector<bool>& selected) : model_(model), carrier_(model.links.size()) {
    for (std::size_t i = 1; i < carrier_.size(); ++i) carrier_[i] = model.links[i].parent;
    for (std::size_t p = 0; p < model.segmented.size(); ++p) {
      const SegmentedPart& part = model.segmented[p];
      if (!part.is_free || !selected[p]) continue;
      for (std::size_t k = 0; k < part.source->connectors.size(); ++k) {
        const FramePair& frames = beam_of(part, k).frames;
        carrier_[at(frames.link2)] = frames.link1;
      }
      parts_.push_back(&part);
    }
    for (std::size_t i = 1; i < carrier_.size(); ++i) order_.push_back(static_cast<int>(i));
    std::stable_sort(order_.begin(), order_.end(), [this](int a, int b) { return depth(a) < depth(b); });
    std::stable_sort(parts_.begin(), parts_.end(), [this](const SegmentedPart* a, const SegmentedPart* b) {
      return depth(root_of(*a)) < depth(root_of(*b));
    });
    for (const SegmentedPart* part : parts_) count_ += 6 * part->source->connectors.size();
  }

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] const std::vector<int>& order() const noexcept { return order_; }  // links, carriers first
  [[nodiscard]] int carrier(int link) const noexcept { return carrier_[at(link)]; }

  // visit(beam, length) for every connector, in the order of the unknowns
  template <typename Visit>
  void for_each(Visit visit) const {
    for (const SegmentedPart* part : parts_) {
      for (std::size_t k = 0; k < part->source->connectors.size(); ++k) {
        visit(beam_of(*part, k), part->source->connectors[k].length);
      }
    }
  }

  // Lumps at the relative coordinates x (d, then the rotation vector, by connector) into q, and with u at the roots'
  // speeds.
  void place(std::span<const double> x, std::span<double> q, std::span<double> u, Workspace& ws) const {
    std::size_t next = 0;
    for (const SegmentedPart* part : parts_) {
      update_motion(model_, q, u, ws);
      const LinkMotion root = ws.motion[at(root_of(*part))];
      std::vector<LinkMotion> placed(model_.links.size());
      placed[at(root_of(*part))] = root;
      for (std::size_t k = 0; k < part->source->connectors.size(); ++k, next += 6) {
        const FramePair& frames = beam_of(*part, k).frames;
        const LinkMotion& near = placed[at(frames.link1)];
        const Mat3 R_1 = near.R * frames.R_L1;
        const Vec3 d(x[next], x[next + 1], x[next + 2]), theta(x[next + 3], x[next + 4], x[next + 5]);
        const Vec3 P2 = near.p + near.R * frames.p_L1 + R_1 * (frames.rest + d);
        LinkMotion& far = placed[at(frames.link2)];
        far.R = R_1 * math::rotation_of(math::turn_by(theta)) * transpose(frames.R_L2);
        far.p = P2 - far.R * frames.p_L2;
        write(model_.links[at(frames.link2)], far, root, q, u);
      }
    }
    update_motion(model_, q, u, ws);
  }

 private:
  [[nodiscard]] const Beam& beam_of(const SegmentedPart& part, std::size_t k) const {
    return model_.elements.beams[part.first_beam + k];
  }
  [[nodiscard]] int root_of(const SegmentedPart& part) const {
    return model_.bodies[at(part.bodies[part.source->root])].link;
  }
  [[nodiscard]] int depth(int link) const {
    int steps = 0;
    for (; link > 0; link = carrier_[at(link)]) ++steps;
    return steps;
  }

  static void write(const Link& link, const LinkMotion& pose, const LinkMotion& root, std::span<double> q,
                    std::span<double> u) {
    const Quaternion attitude = math::quaternion_of(pose.R);
    const Vec3 v = root.v + cross(root.w, pose.p - root.p);
    const double coordinates[] = {pose.p.x(), pose.p.y(), pose.p.z(), attitude.w, attitude.x, attitude.y, attitude.z};
    const double speeds[] = {v.x(), v.y(), v.z(), root.w.x(), root.w.y(), root.w.z()};
    std::copy(std::begin(coordinates), std::end(coordinates), q.begin() + link.q);
    std::copy(std::begin(speeds), std::end(speeds), u.begin() + link.u);
  }

  const Model& model_;
  std::vector<int> carrier_;  // by link: parent, or the link of the connector's near end
  std::vector<int> order_;
  std::vector<const SegmentedPart*> parts_;
  std::size_t count_ = 0;
};

class Settling {
 public:
  Settling(Model& model, const std::vector<bool>& selected)
      : model_(model), chains_(model, selected), ws_(model), state_(start_state(model)), rest_(state_.u.size()) {}

  bool run() {
    begin_contacts(model_, state_, ws_);
    set_time(model_, 0, ws_);
    std::vector<double> x(chains_.count()), r(x.size());
    double merit = residual(x, r), before = 0;
    bool is_newton = false;
    for (int i = 0; i < kMostSettlingCorrections; ++i) {
      std::vector<double> step = is_newton ? correction(x, r) : compliance(r);
      double change = size_of(step);
      if (!is_newton && i >= kPatience && !(change < kShrinks * before)) {
        is_newton = true;
        step = correction(x, r);
        change = size_of(step);
      }
      if (!std::isfinite(change)) return false;
      merit = go(step, merit, x, r);
      if (change <= kSegmentsSettled || (i > 0 && change < kSettlingRounding && change >= before)) return keep(x);
      before = change;
    }
    return false;
  }

 private:
  // (1) and its merit, forces over the stiffness of their direction
  double residual(const std::vector<double>& x, std::vector<double>& r) {
    chains_.place(x, state_.q, rest_, ws_);
    apply_all(model_, state_.q, ws_);
    for (const CoupledMass& mass : model_.coupled) add_coupled(mass);
    // loads required for equilibrium of a link, summed inwards about the links' origins
    const std::vector<int>& order = chains_.order();
    for (std::size_t i = order.size(); i-- > 0;) {
      const int link = order[i], carrier = chains_.carrier(link);
      if (carrier == 0) continue;
      const ArticulatedInertia& own = ws_.inertia[at(link)];
      ArticulatedInertia& into = ws_.inertia[at(carrier)];
      into.f += own.f;
      into.n += own.n + cross(ws_.motion[at(link)].p - ws_.motion[at(carrier)].p, own.f);
    }
    std::size_t next = 0;
    double merit = 0;
    chains_.for_each([&](const Beam& beam, double) {
      const LinkMotion &near = ws_.motion[at(beam.frames.link1)], &far = ws_.motion[at(beam.frames.link2)];
      const ArticulatedInertia& beyond = ws_.inertia[at(beam.frames.link2)];
      const Mat3 R_1 = near.R * beam.frames.R_L1;
      const Vec3 F = transpose_multiply(R_1, beyond.f);
      const Vec3 M = transpose_multiply(R_1, beyond.n - cross(far.R * beam.frames.p_L2, beyond.f));
      const double stiffness[] = {beam.K.k11, beam.K.k22, beam.K.k33, beam.K.k44, beam.K.k55, beam.K.k66};
      for (int k = 0; k < 3; ++k) r[next + at(k)] = F[k], r[next + 3 + at(k)] = M[k];
      for (std::size_t k = 0; k < 6; ++k) merit += r[next + k] * r[next + k] / stiffness[k];
      next += 6;
    });
    return merit;
  }

  // cylinder and piston carried by a line
  void add_coupled(const CoupledMass& mass) {
    const LineElement& line = model_.lines[at(mass.line)];
    const auto index = static_cast<std::size_t>(&mass - model_.coupled.data());
    const auto put = [&](int link, Vec3 point, Vec3 force) {
      ws_.inertia[at(link)].f += force;
      ws_.inertia[at(link)].n += cross(point - ws_.motion[at(link)].p, force);
    };
    put(line.link1, ws_.lines[at(mass.line)].P1, ws_.coupled[index].F1);
    put(line.link2, ws_.lines[at(mass.line)].P2, ws_.coupled[index].F2);
  }

  // (2)
  std::vector<double> compliance(const std::vector<double>& r) const {
    std::vector<double> step;
    chains_.for_each([&](const Beam& beam, double) {
      const BeamStiffness& K = beam.K;
      const double* at_beam = r.data() + step.size();
      const double in_xy = K.k22 * K.k66 - K.k26 * K.k26, in_xz = K.k33 * K.k55 - K.k35 * K.k35;
      const double x[] = {at_beam[0] / K.k11,
                          (K.k66 * at_beam[1] - K.k26 * at_beam[5]) / in_xy,
                          (K.k55 * at_beam[2] - K.k35 * at_beam[4]) / in_xz,
                          at_beam[3] / K.k44,
                          (K.k33 * at_beam[4] - K.k35 * at_beam[2]) / in_xz,
                          (K.k22 * at_beam[5] - K.k26 * at_beam[1]) / in_xy};
      for (const double change : x) step.push_back(-change);
    });
    return step;
  }

  std::vector<double> correction(const std::vector<double>& x, const std::vector<double>& r) {
    const std::size_t n = x.size();
    std::vector<double> A(n * n), moved(n), probe = x, step(n);
    const std::vector<double> scale = scales();
    for (std::size_t j = 0; j < n; ++j) {
      probe[j] = x[j] + kSettlingProbe * scale[j];
      residual(probe, moved);
      probe[j] = x[j];
      for (std::size_t i = 0; i < n; ++i) A[i * n + j] = (moved[i] - r[i]) / (kSettlingProbe * scale[j]);
    }
    for (std::size_t i = 0; i < n; ++i) step[i] = -r[i];
    if (!math::solve_in_place(A.data(), step.data(), n, 1)) std::fill(step.begin(), step.end(), std::nan(""));
    return step;
  }

  [[nodiscard]] std::vector<double> scales() const {
    std::vector<double> scale;
    chains_.for_each([&](const Beam&, double length) {
      scale.insert(scale.end(), 3, length);
      scale.insert(scale.end(), 3, 1.0);
    });
    return scale;
  }

  [[nodiscard]] double size_of(const std::vector<double>& step) const {
    const std::vector<double> scale = scales();
    double largest = 0;
    for (std::size_t i = 0; i < step.size(); ++i) {
      if (!std::isfinite(step[i])) return step[i];
      largest = std::max(largest, std::fabs(step[i]) / scale[i]);
    }
    return largest;
  }

  // x moved by the step, which is halved while (1) grows
  double go(const std::vector<double>& step, double merit, std::vector<double>& x, std::vector<double>& r) {
    const std::vector<double> from = x;
    double found = merit, share = 1;
    for (int i = 0; i <= kMostSettlingHalvings; ++i, share /= 2) {
      for (std::size_t k = 0; k < x.size(); ++k) x[k] = from[k] + share * step[k];
      found = residual(x, r);
      if (found < merit) break;
      if (size_of(step) < kSettlingRounding) break;
    }
    return found;
  }

  bool keep(const std::vector<double>& x) {
    chains_.place(x, model_.start_q, model_.start_u, ws_);
    return true;
  }

  Model& model_;
  Chains chains_;
  Workspace ws_;
  State state_;
  std::vector<double> rest_;  // speeds
};

}  // namespace

void straighten_segments(const Model& model, std::span<double> q, std::span<double> u) {
  if (model.segmented.empty()) return;
  const Chains chains(model, std::vector<bool>(model.segmented.size(), true));
  if (chains.count() == 0) return;
  Workspace ws(model);
  chains.place(std::vector<double>(chains.count()), q, u, ws);
}

bool settle_segments(Model& model, const std::vector<bool>& selected) {
  const bool any = std::find(selected.begin(), selected.end(), true) != selected.end();
  return !any || Settling(model, selected).run();
}

}  // namespace slew::multibody
