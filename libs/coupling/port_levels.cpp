// SPDX-License-Identifier: Apache-2.0
#include "coupling/port_levels.h"

#include <algorithm>
#include <utility>

namespace slew::coupling {
namespace {

constexpr std::string_view kSessionPath = "session.coupling";
constexpr std::string_view kKey = ".coupling";

// The number of a choice; -1: the value is none.
int choice(double value, int choices) noexcept {
  for (int i = 0; i < choices; ++i) {
    if (value == i) return i;
  }
  return -1;
}

}  // namespace

PortLevels::PortLevels(Level session, std::vector<Port> ports)
    : session_(session), first_session_(session), ports_(std::move(ports)), levels_(ports_.size()) {
  for (const Port& port : ports_) first_.push_back(port.level);
  latch();
}

void PortLevels::latch() noexcept {
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const PortLevel own = ports_[i].level;
    levels_[i] = own == PortLevel::session ? session_ : level_of(own);
  }
}

Level PortLevels::lowest() const noexcept {
  return levels_.empty() ? session_ : *std::min_element(levels_.begin(), levels_.end());
}

bool PortLevels::change(std::string_view path, double value) noexcept {
  if (path == kSessionPath) {
    const int level = choice(value, kLevels);
    if (level < 0) return false;
    session_ = static_cast<Level>(level);
    latch();
    return true;
  }
  if (!path.ends_with(kKey)) return false;
  const std::string_view name = path.substr(0, path.size() - kKey.size());
  for (Port& port : ports_) {
    if (port.name != name) continue;
    const int level = choice(value, kLevels + 1);
    if (level < 0) return false;
    port.level = static_cast<PortLevel>(level);
    latch();
    return true;
  }
  return false;
}

void PortLevels::reset() noexcept {
  session_ = first_session_;
  for (std::size_t i = 0; i < ports_.size(); ++i) ports_[i].level = first_[i];
  latch();
}

void PortLevels::add_to(StateHash& hash) const noexcept {
  if (session_ != first_session_) hash.add(session_);
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    if (ports_[i].level == first_[i]) continue;
    hash.add(i);
    hash.add(ports_[i].level);
  }
}

void PortLevels::save(StateWriter& bytes) const {
  bytes.choice(session_, Level::tlm);
  for (const Port& port : ports_) bytes.choice(port.level, PortLevel::tlm);
}

void PortLevels::load(StateReader& bytes) noexcept {
  bytes.choice(session_, Level::tlm);
  for (Port& port : ports_) bytes.choice(port.level, PortLevel::tlm);
  latch();
}

}  // namespace slew::coupling
