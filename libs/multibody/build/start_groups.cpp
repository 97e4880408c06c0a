// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/start_groups.h"

#include <cstddef>
#include <numeric>

#include "core/index.h"
#include "multibody/constraints/gear.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/link_stiffness.h"
#include "multibody/formulations/passes.h"
#include "multibody/model/state.h"

namespace slew::multibody {

namespace {

// Links, flexible parts and segmented parts in groups.
class StartGrouping {
 public:
  explicit StartGrouping(const Model& model)
      : model_(model),
        group_(model.links.size() + model.parts.size() + model.segmented.size()),
        is_grounded_(group_.size()),
        is_held_(group_.size()) {
    std::iota(group_.begin(), group_.end(), std::size_t{0});
    connect_bodies();
    connect_elements();
    see_starts();
  }

  [[nodiscard]] StartRest rest_of_part(std::size_t part) const { return rest_of(model_.links.size() + part); }
  [[nodiscard]] StartRest rest_of_segmented(std::size_t part) const {
    const std::size_t member = model_.links.size() + model_.parts.size() + part;
    const StartRest rest = rest_of(member);
    return rest != StartRest::held && is_straight_ ? StartRest::given : rest;
  }

 private:
  [[nodiscard]] std::size_t find(std::size_t member) const {
    while (group_[member] != member) member = group_[member];
    return member;
  }

  // 0: Ground
  void connect(std::size_t a, std::size_t b) {
    if (a == 0 && b == 0) return;
    if (a == 0 || b == 0) {
      is_grounded_[find(a + b)] = true;
      return;
    }
    const std::size_t into = find(a), from = find(b);
    if (into == from) return;
    group_[from] = into;
    is_grounded_[into] = is_grounded_[into] || is_grounded_[from];
  }

  void connect_bodies() {
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      const Link& link = model_.links[i];
      if (link.joint != LinkJoint::floating) connect(i, at(link.parent));
      if (link.joint == LinkJoint::node) {
        connect(i, model_.links.size() + at(model_.nodes[at(link.node)].part));
      }
    }
    for (std::size_t p = 0; p < model_.parts.size(); ++p) connect(model_.links.size() + p, at(model_.parts[p].link));
    for (std::size_t s = 0; s < model_.segmented.size(); ++s) {
      for (const int body : model_.segmented[s].bodies) {
        connect(model_.links.size() + model_.parts.size() + s, at(model_.bodies[at(body)].link));
      }
    }
  }

  void connect_elements() {
    const auto couple = [this](int link1, int link2) { connect(at(link1), at(link2)); };
    if (has_contact_forces()) {
      for_each_coupling(model_, couple);
    } else {
      for_each_element_coupling(model_, couple);
    }
    for (const Cut& cut : model_.cuts) connect(at(cut.link1), at(cut.link2));
    for (const Gear& gear : model_.gears) {
      const std::vector<int> links = links_of(model_, gear);
      for (const int link : links) connect(at(links.front()), at(link));
    }
  }

  void see_starts() {
    const auto hold_group = [this](std::size_t member) { is_held_[find(member)] = true; };
    for (const Cut& cut : model_.cuts) hold_group(at(cut.link1 + (cut.link1 == 0 ? cut.link2 : 0)));
    for (const Gear& gear : model_.gears) {
      for (const int link : links_of(model_, gear)) hold_group(at(link));
    }
    for (std::size_t s = 0; s < model_.segmented.size(); ++s) {
      const std::size_t member = model_.links.size() + model_.parts.size() + s;
      if (!model_.segmented[s].is_free) hold_group(member);
      is_straight_ = is_straight_ || model_.segmented[s].start == SegmentStart::straight;
    }
  }

  // at the start
  [[nodiscard]] bool has_contact_forces() const {
    if (model_.contact == nullptr) return false;
    Workspace ws(model_);
    const State start = start_state(model_);
    begin_contacts(model_, start, ws);
    set_time(model_, 0, ws);
    update_motion(model_, start.q, start.u, ws);
    update_contacts(model_, ws);
    return ws.contact->force_count > 0;
  }

  [[nodiscard]] StartRest rest_of(std::size_t member) const {
    const std::size_t group = find(member);
    return is_held_[group] ? StartRest::held : is_grounded_[group] ? StartRest::computed : StartRest::falls;
  }

  const Model& model_;
  std::vector<std::size_t> group_;  // by member: another one of its group, or itself
  // by the member that stands for the group
  std::vector<bool> is_grounded_, is_held_;
  bool is_straight_ = false;  // the scene selects a straight start for a segmented body, and so for all
};

}  // namespace

StartGroups find_start_groups(const Model& model) {
  StartGroups result;
  if (model.parts.empty() && model.segmented.empty()) return result;
  const StartGrouping groups(model);
  for (std::size_t p = 0; p < model.parts.size(); ++p) result.parts.push_back(groups.rest_of_part(p));
  for (std::size_t s = 0; s < model.segmented.size(); ++s) result.segmented.push_back(groups.rest_of_segmented(s));
  return result;
}

}  // namespace slew::multibody
