// SPDX-License-Identifier: Apache-2.0
#include "session/curves.h"

#include <algorithm>
#include <numeric>

#include "core/display.h"
#include "scene/name_pattern.h"

namespace slew::session {
namespace {

// blocks that overtake their names; more than these are no curve
constexpr std::size_t kMostEarlyBlocks = 64;

}  // namespace

void Curves::take(const wire::VariableDirectory& directory) {
  Writer& writer = writers_[directory.header.role];
  writer.has_directory = true;
  writer.total = directory.total;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < directory.entries.size(); ++i) {
    const Place place(directory.header.role, directory.first + static_cast<std::uint32_t>(i));
    const wire::VariableEntry& entry = directory.entries[i];
    if (known_.emplace(entry.name, Variable{place, entry.unit}).second) ++writer.named;
    names.push_back(entry.name);
  }
  for (const std::uint32_t wanted : scene::matching(patterns_, names)) {
    const Variable& variable = known_.at(names[wanted]);
    plotting::Series& curve = curves_[variable.place];
    curve.name = names[wanted];
    curve.unit = variable.unit;
  }
  if (writer.named < writer.total) return;
  for (const auto& [block, time] : std::exchange(writer.early, {})) keep(block, time);
}

void Curves::take(const wire::VariableBlock& block, double time) {
  if (block.header.phase != wire::Phase::running) return;
  Writer& writer = writers_[block.header.role];
  if (has_all_names_ || (writer.has_directory && writer.named >= writer.total)) return keep(block, time);
  if (writer.early.size() < kMostEarlyBlocks) {
    writer.early.emplace_back(block, time);
  } else {
    is_sound_ = false;
  }
}

void Curves::keep(const wire::VariableBlock& block, double time) {
  Writer& writer = writers_[block.header.role];
  if (writer.has_block && (block.header.epoch != writer.epoch || block.header.step < writer.newest)) is_sound_ = false;
  writer.has_block = true;
  writer.epoch = block.header.epoch;
  writer.newest = block.header.step;
  writer.between = std::gcd(writer.between, block.header.step);
  for (auto curve = curves_.lower_bound({block.header.role, block.first}); curve != curves_.end(); ++curve) {
    const auto& [role, index] = curve->first;
    if (role != block.header.role || index >= block.first + block.values.size()) break;
    curve->second.time.push_back(time);
    curve->second.values.push_back(block.values[index - block.first]);
  }
}

std::vector<std::string> Curves::names() const {
  std::vector<std::string> names;
  for (const auto& entry : known_) names.push_back(entry.first);
  std::sort(names.begin(), names.end(),
            [&](const std::string& a, const std::string& b) { return known_.at(a).place < known_.at(b).place; });
  return names;
}

std::vector<plotting::Series> Curves::select(std::span<const std::string> patterns, Units units) const {
  std::vector<plotting::Series> selected;
  for (const std::string& name : scene::choose(patterns, names())) {
    const Variable& variable = known_.at(name);
    const auto kept = curves_.find(variable.place);
    plotting::Series curve = kept == curves_.end() ? plotting::Series{} : kept->second;
    curve.name = name;
    const DisplayUnit shown = display_unit(variable.unit, name);
    curve.unit = units == Units::display ? std::string(shown.unit) : variable.unit;
    if (curve.unit == "1") curve.unit.clear();
    const auto writer = writers_.find(variable.place.first);
    const StepIndex between = writer == writers_.end() ? 0 : writer->second.between;
    curve.spacing = static_cast<double>(between) * step_.seconds();
    if (units == Units::display) {
      for (double& value : curve.values) value *= shown.factor;
    }
    selected.push_back(std::move(curve));
  }
  return selected;
}

}  // namespace slew::session
