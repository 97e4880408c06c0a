#include "hydraulics/line_chambers.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit.h"

namespace slew::hydraulics {
namespace {

constexpr int kMergeIterations = 6;  // Newton on a monotonous function, from within: quadratic
constexpr int kOilParts = 4;         // of Runge-Kutta over a step's oil

}  // namespace

double Circuit::line_capacity(const LineChamber& line, double p, double x) const noexcept {
  const Piece& piece = pieces_[line.piece];
  const double V = std::max(piece.volume + piece.slope * x, piece.smallest);
  return (1 - kLumpedShare) * V * (oil_.at(p).value + piece.wall_at(p).value);
}

void Circuit::make_line(int actuator, double delay, const double* y) noexcept {
  for (LineChamber& line : lines_of(actuator)) {
    if (line.is_line || line.slope == 0 || is_fixed(line.volume)) continue;
    const double p = y[line.volume], x = y[line.position];
    const double Z = delay / line_capacity(line, p, x);
    // the flow of the piston runs through the line
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
    const double x = y[line.position], p_h = y[line.volume];
    const double p_line = std::max(0.5 * (line.state.c_h + line.state.c_m), lowest_pressure());
    // int_{p_h}^{p} C_volume dp + int_{p_line}^{p} C_line dp = 0, by Newton; integrals by Simpson's rule
    const auto capacity_of_volume = [&](double p) {
      y[line.volume] = p;
      return capacity_at(static_cast<std::size_t>(line.volume), y);
    };
    const auto capacity_of_line = [&](double p) { return line_capacity(line, p, x); };
    const auto content = [](const auto& C, double from, double to) {
      return (to - from) / 6 * (C(from) + 4 * C(0.5 * (from + to)) + C(to));
    };
    double p = p_h;
    for (int i = 0; i < kMergeIterations; ++i) {
      const double left = content(capacity_of_volume, p_h, p) + content(capacity_of_line, p_line, p);
      p -= left / (capacity_of_volume(p) + capacity_of_line(p));
      p = std::clamp(p, std::min(p_h, p_line), std::max(p_h, p_line));
    }
    y[line.volume] = p;
    line.is_line = false;
    pieces_[line.piece].lumped = 1;
  }
}

// (2) at the piston's end, which the partner is told now, and the line of the coming step
void Circuit::end_line_step(const double* y, std::span<const double> mean_pressure) noexcept {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    LineChamber& line = lines_[i];
    if (!line.is_line) continue;
    LineState& state = line.state;
    state.c_m_next = std::max(2 * mean_pressure[i] - state.c_h, lowest_pressure());
    const double p = std::max(0.5 * (state.c_h + state.c_m), lowest_pressure());
    state.Z_next = line.delay / line_capacity(line, p, y[line.position]);
  }
}

// (2) at the volume's end and (3), from the way that the piston went
bool Circuit::move_lines(const double* x_new) noexcept {
  bool is_within = true;
  for (LineChamber& line : lines_) {
    if (!line.is_line) continue;
    LineState& state = line.state;
    const double dx = x_new[line.position - volume_count()] - state.x;
    // oil that came in, from mean(p_h) = (c_h + c_m+)/2, less the room that the piston made
    const double oil = 0.5 * line.delay * (state.c_m_next - state.c_h) / state.Z - line.slope * dx;
    double p = std::max(0.5 * (state.c_h + state.c_m), lowest_pressure());
    const double p_before = p;
    for (int part = 0; part < kOilParts; ++part) {
      const double h = oil / kOilParts, way = dx / kOilParts, x = state.x + part * way;
      const auto rate = [&](double q, double share) {
        return 1 / line_capacity(line, std::max(q, lowest_pressure()), x + share * way);
      };
      const double k_1 = rate(p, 0), k_2 = rate(p + 0.5 * h * k_1, 0.5), k_3 = rate(p + 0.5 * h * k_2, 0.5);
      p += h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + rate(p + h * k_3, 1));
    }
    const double c_h = 2 * p - state.c_m_next;
    is_within = is_within && c_h >= lowest_pressure() && p_before > lowest_pressure();
    state.c_h = std::max(c_h, lowest_pressure());
    state.c_m = state.c_m_next;
    state.Z = state.Z_next;
    state.x = x_new[line.position - volume_count()];
  }
  return is_within;
}

LineThrust Circuit::line_thrust(int actuator, const double* y) const noexcept {
  LineThrust thrust;
  for (const LineChamber& line : lines_of(actuator)) {
    // a chamber on a fixed volume has its pressure and no line
    const double Z = line.is_line ? line.state.Z_next : 0;
    const double c = line.is_line ? line.state.c_m_next : y[line.volume];
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
  }
}

}  // namespace slew::hydraulics
