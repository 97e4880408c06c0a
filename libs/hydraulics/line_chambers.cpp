// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/line_chambers.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit.h"

namespace slew::hydraulics {
namespace {

constexpr int kOilIterations = 60;     // Newton on a concave function: monotonous from the second one on
constexpr double kSettled = 1e-14;     // share of a pressure
constexpr int kOilParts = 4;           // Runge-Kutta parts over a step's oil ...
constexpr int kMostOilParts = 64;      // ... more where it changes the pressure by more than
constexpr double kPartChange = 0.1;    // ... this share for each
constexpr double kBalanced = 1e-6;     // share of a step's oil by which the parts may miss it
constexpr double kRounding = 1e-13;    // of g(p)
constexpr double kMostChange = 2;      // of a capacity within a step, up to which (2) holds alone
constexpr double kMostMissed = 10;     // pressure scales that a step's waves may lack
constexpr double kSameVolume = 1e-12;  // share of a volume
constexpr int kWallParts = 32;         // Simpson parts

// int f dp by Simpson's rule, in parts of equal ratios of p; from, to > 0.
template <typename Function>
double integral(const Function& f, double from, double to) noexcept {
  const double ratio = std::pow(to / from, 1.0 / kWallParts);
  double sum = 0;
  for (int part = 0; part < kWallParts; ++part, from *= ratio) {
    const double end = from * ratio;
    sum += (end - from) / 6 * (f(from) + 4 * f(0.5 * (from + end)) + f(end));
  }
  return sum;
}

}  // namespace

double Circuit::line_volume(const LineChamber& line, double x) const noexcept {
  const Piece& piece = pieces_[line.piece];
  return (1 - kLumpedShare) * std::max(piece.volume + piece.slope * x, piece.smallest);
}

// g(p) of (3); pre-condition: p >= floor
double Circuit::line_content(const LineChamber& line, double p) const noexcept {
  return oil_.content(p) - oil_.content(floor_) + pieces_[line.piece].wall_compressibility * (p - floor_);
}

// p of g(p), starting at a guess
double Circuit::line_pressure(const LineChamber& line, double content, double p, double error) const noexcept {
  p = p > floor_ ? p : floor_;
  for (int i = 0; i < kOilIterations; ++i) {
    const double left = content - line_content(line, p);
    if (std::fabs(left) <= error) break;
    const double before = p;
    p = std::max(p + left / (oil_.at(p).value + pieces_[line.piece].wall_compressibility), floor_);
    if (std::fabs(p - before) <= kSettled * p) break;
  }
  return p;
}

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
    line.state.p = line.state.wave_pressure(floor_);
    pieces_[line.piece].lumped = kLumpedShare;
  }
}

void Circuit::lump_line(int actuator, double* y) noexcept {
  for (LineChamber& line : lines_of(actuator)) {
    if (!line.is_line) continue;
    const auto volume = static_cast<std::size_t>(line.volume);
    const double V = line_volume(line, y[line.position]);
    // the room to be filled with oil in both, then the pressures
    const double room = vapour_.void_volume(volume, y) + line.state.room;
    const double p_h = vapour_.is_in(volume, y) ? floor_ : y[volume];
    const double in_line = line_content(line, line.state.p), in_volume = volume_content(volume, p_h, y);
    // the oil of both above the floor, by Newton; linear below it
    double p = p_h;
    for (int i = 0; i < kOilIterations; ++i) {
      const double q = std::max(p, floor_);
      y[volume] = q;
      const double C = capacity_at(volume, y) + line_capacity(line, q, y[line.position]);
      const double oil = volume_content(volume, q, y) + V * line_content(line, q) + C * (p - q);
      const double step = (in_volume + V * in_line - room - oil) / C;
      p += step;
      if (std::fabs(step) <= kSettled * std::fabs(p)) break;
    }
    line.is_line = false;
    pieces_[line.piece].lumped = 1;
    y[volume] = p;
    if (vapour_.is_in(volume, y)) vapour_.capacity[volume] = capacity_at_floor(volume, y);
  }
}

// Oil of a volume without its lines above that at the floor [m3]; pre-condition: p >= floor
double Circuit::volume_content(std::size_t volume, double p, const double* y) const noexcept {
  const VolumeContent& contents = volumes_[volume];
  double lumped = contents.volume + contents.nominal, walls = contents.wall * (p - floor_);
  for (std::size_t k = contents.begin; k < contents.end; ++k) {
    const Piece& piece = pieces_[k];
    const double share = piece.lumped * piece.content_at(y);
    lumped += share;
    walls +=
        share * (piece.has_constant_wall ? piece.wall_compressibility * (p - floor_)
                                         : integral([&piece](double q) { return piece.wall_at(q).value; }, floor_, p));
  }
  return lumped * (oil_.content(p) - oil_.content(floor_)) + walls;
}

// What (2) misses of the line's pressure in this step, by the circuit's own piston [Pa]; 0 while the capacity hardly
// changes.
double Circuit::missed_pressure(const LineChamber& line, double c_m, const double* y) const noexcept {
  const LineState& state = line.state;
  const double dx = y[line.position] - state.x, displaced = line.slope * dx;
  LineChamber foreseen = line;
  fill(foreseen, 0.5 * line.delay * (c_m - state.c_h) / state.Z - displaced, dx);
  const double p = foreseen.state.p;
  const double ratio = line_capacity(line, p, state.x) / line_capacity(line, state.p, state.x);
  const bool has_room = state.room > 0 || foreseen.state.room > 0;
  if (!has_room && ratio < kMostChange && ratio > 1 / kMostChange) return 0;
  const double by_waves = 0.5 * (c_m + state.c_m) - state.Z * displaced / line.delay;
  return (foreseen.state.room > 0 ? vapour_pressure_of(floor_) : p) - by_waves;
}

// (2) and (6) at the piston's end, which the partner receives now, and the line of the next step
void Circuit::end_line_step(const double* y, std::span<const double> mean_pressure) noexcept {
  beyond_waves_ = -1;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    LineChamber& line = lines_[i];
    if (!line.is_line) continue;
    LineState& state = line.state;
    const double c_m = 2 * mean_pressure[i] - state.c_h;
    const double missed = missed_pressure(line, c_m, y);
    if (missed > kMostMissed * scale_[static_cast<std::size_t>(line.volume)]) beyond_waves_ = line.volume;
    state.c_m_next = std::max(c_m + missed, vapour_pressure_of(floor_));
    state.held = state.c_m_next - c_m;
    // room is as soft as vapour: it fills at the pressure of the floor
    const double C = line_capacity(line, state.p, y[line.position]) + state.room / floor_;
    state.Z_next = line.delay / C;
  }
}

// (3) to (5), from the piston's displacement
bool Circuit::move_lines(const double* x_new) noexcept {
  bool is_within = true;
  for (LineChamber& line : lines_) {
    if (!line.is_line) continue;
    LineState& state = line.state;
    const double dx = x_new[line.position - volume_count()] - state.x;
    // from mean(p_h) = (c_h + c_m+)/2
    const double inflow = 0.5 * line.delay * (state.c_m_next - state.held - state.c_h) / state.Z;
    is_within = is_within && state.room == 0;
    fill(line, inflow - line.slope * dx, dx);
    const double c_h = 2 * (state.room > 0 ? vapour_pressure_of(floor_) : state.p) - state.c_m_next;
    state.c_h = std::max(c_h, vapour_pressure_of(floor_));
    is_within = is_within && c_h == state.c_h;
    state.c_m = state.c_m_next;
    // free of the rounding of (5)
    if (c_h == state.c_h && state.room == 0) state.p = state.wave_pressure(floor_);
    state.Z = state.Z_next;
    state.x = x_new[line.position - volume_count()];
  }
  return is_within;
}

// (3), (4): the line takes in `oil`, its piston moves by dx.
void Circuit::fill(LineChamber& line, double oil, double dx) const noexcept {
  LineState& state = line.state;
  const double V_end = line_volume(line, state.x + dx);
  double V = line_volume(line, state.x);
  // int ds/V along a volume that is linear in s
  const auto inverse = [](double from, double to) {
    const double change = (to - from) / from;
    return (std::fabs(change) < kSameVolume ? 1 : std::log1p(change) / change) / from;
  };
  if (state.room > 0) {
    if (oil <= state.room) {
      state.room -= oil;
      return;
    }
    V += (V_end - V) * state.room / oil;
    state.p = line_pressure(line, (oil - state.room) * inverse(V, V_end), floor_, kRounding);
    state.room = 0;
    return;
  }
  const double before = line_content(line, state.p), content = before + oil * inverse(V, V_end);
  if (content >= 0) {
    const double error = kRounding + kBalanced * std::fabs(content - before);
    state.p = line_pressure(line, content, pressure_by_parts(line, oil, dx), error);
    return;
  }
  // empty at V_f, where oil ln(V_f/V)/(V_end - V) = -before
  const double change = (V_end - V) / V;
  const double share =
      std::fabs(change) < kSameVolume ? -before * V / oil : std::expm1(-before * (V_end - V) / oil) / change;
  state.p = floor_;
  state.room = std::max(-oil * (1 - share), 0.0);
}

// (3) by Runge-Kutta parts; inexact where air makes the oil soft.
double Circuit::pressure_by_parts(const LineChamber& line, double oil, double dx) const noexcept {
  double p = line.state.p;
  const double change = std::fabs(oil) / line_capacity(line, p, line.state.x) / p;
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
    if (line.state.is_apart(floor_)) hash.add(line.state.p);
    if (line.state.held != 0) hash.add(line.state.held);
  }
}

}  // namespace slew::hydraulics
