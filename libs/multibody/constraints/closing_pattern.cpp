// SPDX-License-Identifier: Apache-2.0
#include "multibody/constraints/closing_pattern.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>

#include "core/index.h"

namespace slew::multibody {

namespace {

// Sets of links that grow together; Ground is in none.
class Machines {
 public:
  explicit Machines(const Model& model) : owner_(model.links.size()) {
    std::iota(owner_.begin(), owner_.end(), 0);
    for (std::size_t i = 1; i < model.links.size(); ++i) join(static_cast<int>(i), model.links[i].parent);
    join_nodes(model);
    for (const CoupledMass& mass : model.coupled)
      join(model.lines[at(mass.line)].link1, model.lines[at(mass.line)].link2);
    for (const Cut& cut : model.cuts) join(cut.link1, cut.link2);
    for (const Gear& gear : model.gears) join(gear.ends[0].link, gear.ends[1].link);
  }

  [[nodiscard]] int of(int link) const noexcept {
    while (owner_[at(link)] != link) link = owner_[at(link)];
    return link;
  }

 private:
  void join(int link, int other) noexcept {
    if (link <= 0 || other <= 0) return;
    const int a = of(link), b = of(other);
    owner_[at(std::max(a, b))] = std::min(a, b);
  }

  // links on the modes of one part, and masses of cylinders between such nodes
  void join_nodes(const Model& model) noexcept {
    std::vector<int> rider(model.parts.size(), 0);
    int any = 0;
    for (std::size_t i = 1; i < model.links.size(); ++i) {
      const Link& link = model.links[i];
      for (int k = link.first_part; k < link.part_end; ++k) ride(static_cast<int>(i), rider[at(k)]);
      if (link.joint == LinkJoint::node) ride(static_cast<int>(i), rider[at(model.nodes[at(link.node)].part)]);
      if (!model.node_dummies.empty()) ride(static_cast<int>(i), any);
    }
  }
  void ride(int link, int& first) noexcept {
    if (first == 0) first = link;
    join(link, first);
  }

  std::vector<int> owner_;  // by link: itself, or a smaller one of its set
};

// speeds to which the links pass a force
std::vector<std::size_t> speeds_of(const Model& model, std::span<const int> supports) {
  std::vector<char> is_pushed(model.start_u.size(), model.node_dummies.empty() ? 0 : 1);
  const auto push = [&](int first, std::size_t count) { std::fill_n(is_pushed.begin() + first, count, 1); };
  const auto push_part = [&](int part) { push(model.parts[at(part)].u, model.parts[at(part)].modes); };
  for (const int i : supports) {
    const Link& link = model.links[at(i)];
    if (link.joint == LinkJoint::node) {
      push_part(model.nodes[at(link.node)].part);
    } else {
      push(link.u, at(speed_count(link.joint)));
    }
    for (int k = link.first_part; k < link.part_end; ++k) push_part(k);
  }
  std::vector<std::size_t> speeds;
  for (std::size_t j = 0; j < is_pushed.size(); ++j) {
    if (is_pushed[j] != 0) speeds.push_back(j);
  }
  return speeds;
}

std::span<const int> supports_of(const Model& model, int first, int end) {
  return {model.supports.data() + first, model.supports.data() + end};
}

}  // namespace

ClosingPattern::ClosingPattern(const Model& model) {
  if (!model.has_closing_rows()) return;
  const Machines machines(model);
  const auto add = [&](int first_row, std::size_t rows, int first_support, int support_end) {
    const std::span<const int> supports = supports_of(model, first_support, support_end);
    const int machine = supports.empty() ? 0 : machines.of(supports.front());
    groups.push_back({first_row, static_cast<int>(rows), machine, speeds_of(model, supports)});
  };
  for (const Cut& cut : model.cuts) add(cut.first_row, cut.rows.size(), cut.first_support, cut.support_end);
  int row = model.cut_row_count();
  for (const Gear& gear : model.gears) add(row++, 1, gear.first_support, gear.support_end);
  find_blocks();
  find_ports(model, [&](int link) { return machines.of(link); });
}

void ClosingPattern::find_blocks() {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (int k = 0; k < groups[g].row_count; ++k) coupled.emplace_back();
    for (std::size_t o = 0; o <= g; ++o) {
      if (groups[o].machine != groups[g].machine) continue;
      std::vector<std::size_t> both;
      const std::vector<std::size_t>&one = groups[g].speeds, &two = groups[o].speeds;
      std::set_intersection(one.begin(), one.end(), two.begin(), two.end(), std::back_inserter(both));
      if (both.empty() && o != g) continue;
      blocks.push_back({static_cast<int>(g), static_cast<int>(o), std::move(both), {}});
      for (int k = groups[g].first_row; k < groups[g].first_row + groups[g].row_count; ++k) {
        const int end = std::min(k, groups[o].first_row + groups[o].row_count);
        for (int l = groups[o].first_row; l < end; ++l) coupled[at(k)].push_back(l);
      }
    }
  }
}

template <typename MachineOf>
void ClosingPattern::find_ports(const Model& model, MachineOf machine_of) {
  for (const Row& port : model.rows) {
    Port reached;
    for (const int link : supports_of(model, port.first_support, port.support_end)) {
      const int machine = machine_of(link);
      if (std::find(reached.machines.begin(), reached.machines.end(), machine) == reached.machines.end()) {
        reached.machines.push_back(machine);
      }
    }
    std::sort(reached.machines.begin(), reached.machines.end());
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (!std::binary_search(reached.machines.begin(), reached.machines.end(), groups[g].machine)) continue;
      reached.groups.push_back(static_cast<int>(g));
      for (int k = 0; k < groups[g].row_count; ++k) reached.rows.push_back(groups[g].first_row + k);
    }
    ports.push_back(std::move(reached));
  }
}

bool ClosingPattern::are_coupled(std::size_t port, std::size_t other) const noexcept {
  for (const int machine : ports[port].machines) {
    for (const int same : ports[other].machines) {
      if (machine == same) return true;
    }
  }
  return false;
}

}  // namespace slew::multibody
