// SPDX-License-Identifier: Apache-2.0
#include "multibody/motions/drive.h"

#include <algorithm>
#include <cstddef>

#include "multibody/model/state.h"

namespace slew::multibody {
namespace {

template <typename Value>
void impose(const Model& model, const Workspace& ws, int Drive::*place, Value value, std::span<double> to) noexcept {
  for (std::size_t k = 0; k < model.drives.size(); ++k) {
    const int index = model.drives[k].*place;
    if (index >= 0) to[static_cast<std::size_t>(index)] = ws.drives[k].*value;
  }
}

}  // namespace

void set_time(const Model& model, double time, Workspace& ws) noexcept {
  ws.time = time;
  for (std::size_t k = 0; k < model.drives.size(); ++k) {
    const MotionLaw& law = model.drives[k].law;
    MotionValue& value = ws.drives[k];
    value = law.jumps.empty() ? evaluate(law, time) : evaluate(law, time, ws.until);
    if (ws.mean_over > 0) value.acceleration = (evaluate(law, time + ws.mean_over).speed - value.speed) / ws.mean_over;
  }
}

void impose_positions(const Model& model, const Workspace& ws, std::span<double> q) noexcept {
  impose(model, ws, &Drive::q, &MotionValue::position, q);
}

void impose_speeds(const Model& model, const Workspace& ws, std::span<double> u) noexcept {
  impose(model, ws, &Drive::u, &MotionValue::speed, u);
}

void impose_accelerations(const Model& model, const Workspace& ws, std::span<double> udot) noexcept {
  impose(model, ws, &Drive::u, &MotionValue::acceleration, udot);
}

void clear_prescribed(const Model& model, std::span<double> by_u) noexcept {
  for (const Drive& drive : model.drives) {
    if (drive.u >= 0) by_u[static_cast<std::size_t>(drive.u)] = 0;
  }
}

bool are_drives_defined(const Model& model, double time) noexcept {
  return std::all_of(model.drives.begin(), model.drives.end(),
                     [time](const Drive& drive) { return holds_at(drive.law, time); });
}

}  // namespace slew::multibody
