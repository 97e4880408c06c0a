// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/singular_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "core/index.h"
#include "multibody/constraints/constraint.h"
#include "multibody/constraints/loops.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace {

// A loop's part of the mechanism: the links of all loops that share links with it.
struct Chain {
  std::vector<char> has;  // by link
  double rate = 0;        // rad/s, largest speed of a joint there
  double length = 0;      // m, largest distance between joints there
};

// Leaves the links that both ends hang on, which carry the loop as a whole.
void mark_own_links(const Model& model, const Cut& cut, std::vector<char>& has) {
  const auto branch = [&](int link) {
    std::vector<int> links;
    for (; link > 0; link = model.links[at(link)].parent) links.push_back(link);
    return links;
  };
  std::vector<int> first = branch(cut.link1), second = branch(cut.link2);
  while (!first.empty() && !second.empty() && first.back() == second.back()) first.pop_back(), second.pop_back();
  for (const std::vector<int>* links : {&first, &second}) {
    for (const int link : *links) has[at(link)] = 1;
  }
}

std::vector<char> own_links(const Model& model, std::size_t row) {
  std::vector<char> has(model.links.size());
  for (const Cut& cut : model.cuts) {
    if (row >= at(cut.first_row) && row < at(cut.first_row) + cut.rows.size()) mark_own_links(model, cut, has);
  }
  const auto first_gear = at(model.cut_row_count());
  if (row < first_gear) return has;
  const Gear& gear = model.gears[row - first_gear];
  for (int i = gear.first_support; i < gear.support_end; ++i) has[at(model.supports[at(i)])] = 1;
  return has;
}

Chain chain_of(const Model& model, const Workspace& ws, std::vector<char> has) {
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const Cut& cut : model.cuts) {
      std::vector<char> other(has.size());
      mark_own_links(model, cut, other);
      bool is_shared = false, is_new = false;
      for (std::size_t i = 0; i < has.size(); ++i) {
        is_shared = is_shared || (other[i] != 0 && has[i] != 0);
        is_new = is_new || (other[i] != 0 && has[i] == 0);
      }
      if (!is_shared || !is_new) continue;
      for (std::size_t i = 0; i < has.size(); ++i) has[i] = static_cast<char>(has[i] | other[i]);
      has_grown = true;
    }
  }
  Chain chain{.has = std::move(has)};
  for (const Cut& cut : model.cuts) {
    for (const auto& [link, point] : {std::pair(cut.link1, cut.p_L1), std::pair(cut.link2, cut.p_L2)}) {
      if (chain.has[at(link)] != 0) chain.length = std::max(chain.length, math::norm(point));
    }
  }
  double slide = 0;
  for (std::size_t i = 1; i < chain.has.size(); ++i) {
    if (chain.has[i] == 0) continue;
    const LinkMotion &m = ws.motion[i], &parent = ws.motion[at(model.links[i].parent)];
    chain.length = std::max(chain.length, norm(m.r));
    chain.rate = std::max(chain.rate, norm(m.w - parent.w));
    slide = std::max(slide, norm(m.v - parent.v - cross(parent.w, m.r)));
  }
  if (chain.length > 0) chain.rate = std::max(chain.rate, slide / chain.length);
  return chain;
}

std::string names_of(const Model& model, const std::vector<char>& has) {
  constexpr int kMostNames = 8;
  std::string names;
  int count = 0;
  for (const Joint& joint : model.joints) {
    if (joint.link == 0 || has[at(joint.link)] == 0) continue;
    if (++count > kMostNames) return names + ", ...";
    names += (names.empty() ? "'" : ", '") + joint.name + "'";
  }
  return names;
}

// J u' + b of all rows, with forces that make it zero in the independent ones: lambda^T b in the others.
std::vector<double> left_accelerations(const Model& model, Workspace& ws) {
  LoopWorkspace& loops = ws.loops;
  const std::size_t speeds = ws.udot.size();
  std::vector<double> left(loops.rows.size());
  for (std::size_t k = 0; k < left.size(); ++k) left[k] = loops.rows[k].bias;  // of gears
  for (const Cut& cut : model.cuts) {
    for (std::size_t i = 0; i < cut.rows.size(); ++i) {
      const std::size_t k = at(cut.first_row) + i;
      left[k] = acceleration_of(loops.rows[k], ws.motion[at(cut.link1)], ws.motion[at(cut.link2)]);
    }
  }
  std::vector<double> forces(left.size()), residual(speeds);
  for (std::size_t k = 0; k < left.size(); ++k) forces[k] = -left[k];
  loops.factor.solve(forces);
  for (std::size_t k = 0; k < left.size(); ++k) {
    for (std::size_t j = 0; j < speeds; ++j) residual[j] += loops.residual[k * speeds + j] * forces[k];
  }
  for (std::size_t k = 0; k < left.size(); ++k) {
    for (std::size_t j = 0; j < speeds; ++j) left[k] += loops.rate[k * speeds + j] * residual[j];
  }
  return left;
}

}  // namespace

std::vector<AssemblyReport::Singular> find_singular_rows(const Model& model, double tolerance, Workspace& ws) {
  constexpr double kRest = 1e-9;      // rad/s
  constexpr double kRounding = 1e-9;  // share of the accelerations that cancel in (1)
  constexpr double kExact = 1e-12;    // pivot of a position given with the digits of a scene
  constexpr double kUnevenness = 10;  // of lambda: its largest element over that of the named row
  std::vector<AssemblyReport::Singular> found;
  const LoopWorkspace& loops = ws.loops;
  if (loops.factor.rank() == loops.factor.size()) return found;
  // (1) is met up to the distance from the singular position, the root of the pivot
  const double distance = std::sqrt(std::clamp(loops.factor.smallest_pivot(), kExact, tolerance));
  const std::vector<double> left = left_accelerations(model, ws);
  const auto first_gear = at(model.cut_row_count());
  double carried = norm(model.gravity);
  for (const LinkMotion& m : ws.motion) carried = std::max(carried, norm(m.a));
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (!loops.factor.is_redundant(static_cast<int>(k))) continue;
    AssemblyReport::Singular entry;
    bool is_turn = false;
    for (const Cut& cut : model.cuts) {
      if (k < at(cut.first_row) || k >= at(cut.first_row) + cut.rows.size()) continue;
      const ConstraintRow& row = cut.rows[k - at(cut.first_row)];
      entry.joint = model.joints[at(cut.joint)].name;
      is_turn = is_angle(row.form);
    }
    if (k >= first_gear) {
      const Gear& gear = model.gears[k - first_gear];
      entry.joint = gear.name;
      is_turn = is_angle(gear.kind, 0) && is_angle(gear.kind, 1);
    }
    std::vector<char> own = own_links(model, k);
    entry.others = names_of(model, own);
    const Chain chain = chain_of(model, ws, std::move(own));
    const double length = is_turn ? 1 : chain.length;
    entry.is_at_rest = chain.rate <= kRest;
    const double allowed = kUnevenness * distance * chain.rate * chain.rate * length + kRounding * carried;
    entry.goes_on = !(std::fabs(left[k]) > allowed);
    found.push_back(entry);
  }
  return found;
}

}  // namespace slew::multibody
