// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/line_chambers.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit.h"

namespace slew::hydraulics {
namespace {

constexpr int kMergeIterations = 6;  // Newton on a monotonous function, from within: quadratic
constexpr int kOilParts = 4;         // Runge-Kutta parts over a step's oil ...
constexpr int kMostOilParts = 64;    // ... more where it changes the pressure by more than
constexpr double kPartChange = 0.1;  // ... this share for each

// int C dp by Simpson's rule; C is constant below the floor.
template <typename Capacity>
double content(const Capacity& C, double floor, double from, double to) noexcept {
  const auto above = [&](double p) {
    const double q = std::max(p, floor);
    return (q - floor) / 6 * (C(floor) + 4 * C(0.5 * (floor + q)) + C(q)) + C(floor) * (p - q);
  };
  if (std::min(from, to) < floor) return above(to) - above(from);
  return (to - from) / 6 * (C(from) + 4 * C(0.5 * (from + to)) + C(to));
}

}  // namespace

double Circuit::line_capacity(const LineChamber& line, double p, double x) const noexcept {
  const Piece& piece = pieces_[line.piece];
  const double V = std::max(piece.volume + piece.slope * x, piece.smallest);
  return (1 - kLumpedShare) * V * (oil_.at(p).value + piece.wall_at(p).value);
}

void Circuit::make_line(int actuator, double delay, const double* y) noexcept {
  for (LineChamber& line : lines_of(actuator)) {
    if (line.is_line || line.slope == 0 || is_fixed(line.volume)) continue;
    const double p = pressure(line.volume, y).value, x = y[line.position];
    const double Z = delay / line_capacity(line, p, x);
    // the flow of the piston passes through the line
    const double rise = Z * line.slope * y[line.speed];
    line.is_line = true;
    line.delay = delay;
    line.state = {.c_h = p - rise, .c_m = p + rise, .c_m_next = p + rise, .Z = Z, .Z_next = Z, .x = x};
    pieces_[line.piece].lumped = kLumpedShare;
  }
}

void Circuit::lump_line(int actuator, double* y) noexcept {
  for (LineChamber& line : lines_of(actuator)) {
    if (!line.is_line) continue;
    const auto volume = static_cast<std::size_t>(line.volume);
    const double x = y[line.position];
    // the room to be filled with oil in both, then the pressures
    const double room = vapour_.void_volume(volume, y) + line.state.room;
    const double p_h = vapour_.is_in(volume, y) ? floor_ : y[volume];
    const double p_line = std::max(0.5 * (line.state.c_h + line.state.c_m), vapour_pressure_of(floor_));
    // int_{p_h}^{p} C_volume dp + int_{p_line}^{p} C_line dp + room = 0, by Newton; integrals by Simpson's rule
    const auto capacity_of_volume = [&](double p) {
      y[volume] = std::max(p, floor_);
      return capacity_at(volume, y);
    };
    const auto capacity_of_line = [&](double p) { return line_capacity(line, std::max(p, floor_), x); };
    double p = p_h;
    for (int i = 0; i < kMergeIterations; ++i) {
      const double left =
          content(capacity_of_volume, floor_, p_h, p) + content(capacity_of_line, floor_, p_line, p) + room;
      p -= left / (capacity_of_volume(p) + capacity_of_line(p));
      if (room == 0) p = std::clamp(p, std::min(p_h, p_line), std::max(p_h, p_line));
    }
    line.is_line = false;
    pieces_[line.piece].lumped = 1;
    y[volume] = p;
    if (vapour_.is_in(volume, y)) vapour_.capacity[volume] = capacity_at_floor(volume, y);
  }
}

// (2) at the piston's end, which the partner receives now, and the line of the next step
void Circuit::end_line_step(const double* y, std::span<const double> mean_pressure) noexcept {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    LineChamber& line = lines_[i];
    if (!line.is_line) continue;
    LineState& state = line.state;
    const double c_m = 2 * mean_pressure[i] - state.c_h;
    state.c_m_next = std::max(c_m, vapour_pressure_of(floor_));
    state.held = state.c_m_next - c_m;
    const double p = std::max(0.5 * (state.c_h + state.c_m), vapour_pressure_of(floor_));
    // room is as soft as vapour: it fills at the pressure of the floor
    const double C = line_capacity(line, std::max(p, floor_), y[line.position]) + state.room / floor_;
    state.Z_next = line.delay / C;
  }
}

// (2) at the volume's end and (3), from the piston's displacement
bool Circuit::move_lines(const double* x_new) noexcept {
  bool is_within = true;
  for (LineChamber& line : lines_) {
    if (!line.is_line) continue;
    LineState& state = line.state;
    const double dx = x_new[line.position - volume_count()] - state.x;
    // inflow of oil, from mean(p_h) = (c_h + c_m+)/2, less the room present and the room made by the piston
    const double inflow = 0.5 * line.delay * (state.c_m_next - state.held - state.c_h) / state.Z;
    const double oil = inflow - line.slope * dx - state.room;
    const double p_before = std::max(0.5 * (state.c_h + state.c_m), vapour_pressure_of(floor_));
    const double x = state.x + dx;
    const auto capacity_now = [&](double q) { return line_capacity(line, std::max(q, floor_), x); };
    const double reserve = oil + content(capacity_now, floor_, floor_, p_before);
    const double p = reserve > 0 ? filled_pressure(line, oil, dx, p_before) : vapour_pressure_of(floor_);
    const double c_h = 2 * p - state.c_m_next;
    is_within = is_within && c_h >= vapour_pressure_of(floor_) && p_before > vapour_pressure_of(floor_);
    state.c_h = std::max(c_h, vapour_pressure_of(floor_));
    // (4)
    const double p_now = 0.5 * (state.c_h + state.c_m_next);
    const double held = c_h < state.c_h ? content(capacity_now, floor_, p, p_now) : 0;
    state.room = reserve > 0 ? held : content(capacity_now, floor_, floor_, p_now) - reserve;
    state.c_m = state.c_m_next;
    state.Z = state.Z_next;
    state.x = x_new[line.position - volume_count()];
  }
  return is_within;
}

// (3): the line's pressure after an inflow `oil`, starting at p.
double Circuit::filled_pressure(const LineChamber& line, double oil, double dx, double p) const noexcept {
  const double change = std::fabs(oil) / line_capacity(line, std::max(p, floor_), line.state.x) / std::max(p, floor_);
  const double wanted = std::ceil(change / kPartChange);
  const int parts = static_cast<int>(std::clamp(wanted, double{kOilParts}, double{kMostOilParts}));
  for (int part = 0; part < parts; ++part) {
    const double h = oil / parts, part_dx = dx / parts, x = line.state.x + part * part_dx;
    const auto rate = [&](double q, double share) {
      return 1 / line_capacity(line, std::max(q, floor_), x + share * part_dx);
    };
    const double k_1 = rate(p, 0), k_2 = rate(p + 0.5 * h * k_1, 0.5), k_3 = rate(p + 0.5 * h * k_2, 0.5);
    p += h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + rate(p + h * k_3, 1));
  }
  return p;
}

LineThrust Circuit::line_thrust(int actuator, const double* y) const noexcept {
  LineThrust thrust;
  for (const LineChamber& line : lines_of(actuator)) {
    // a chamber on a fixed volume takes its pressure and has no line
    const double Z = line.is_line ? line.state.Z_next : 0;
    const double c = line.is_line ? line.state.c_m_next : pressure(line.volume, y).value;
    thrust.damping += line.slope * line.slope * Z;
    thrust.force += line.slope * c;
  }
  return thrust;
}

bool Circuit::is_line(int actuator) const noexcept {
  const std::span<const LineChamber> lines = lines_of(actuator);
  return std::any_of(lines.begin(), lines.end(), [](const LineChamber& line) { return line.is_line; });
}

void Circuit::add_lines_to(StateHash& hash) const noexcept {
  for (const LineChamber& line : lines_) {
    if (!line.is_line) continue;
    for (const double value :
         {line.state.c_h, line.state.c_m, line.state.c_m_next, line.state.Z, line.state.Z_next, line.state.x}) {
      hash.add(value);
    }
    if (line.state.room != 0) hash.add(line.state.room);
    if (line.state.held != 0) hash.add(line.state.held);
  }
}

}  // namespace slew::hydraulics
