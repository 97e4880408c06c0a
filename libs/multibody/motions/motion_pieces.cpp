// SPDX-License-Identifier: Apache-2.0
#include "multibody/motions/motion_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "multibody/motions/drive.h"

namespace slew::multibody {
namespace {

// largest error of p' after a jump of p''', as a share of the range of p' around it
constexpr double kLargestError = 0.01;
// Instants closer than this share of a sub-step are one.
constexpr double kOneInstant = 1e-6;
// An interval of a table shorter than this number of sub-steps is divided as a whole, a longer one next to its jumps.
constexpr double kShortInterval = 16;

// Need of a motion behind an instant: the next jump of p''' and the longest piece up to there.
struct Need {
  double until = kNever;    // s
  double longest = kNever;  // s
};

Need ramp_need(const MotionLaw& law, const MotionResolution& resolution, double time, double instant) noexcept {
  const double end = law.start + law.duration;
  if (law.from == law.to || time >= end - instant) return {};
  if (time < law.start - instant) return {law.start, kNever};
  return {end, law.duration / resolution.per_ramp};
}

Need table_need(const MotionLaw& law, const MotionResolution& resolution, double time, double instant,
                double h) noexcept {
  const auto& points = law.spline.points;
  const auto next = std::upper_bound(points.begin(), points.end(), time + instant,
                                     [](double at, const math::SplinePoint& p) { return at < p.x; });
  if (next == points.end()) return {};
  if (next == points.begin()) return {points.front().x, kNever};
  const auto before = next - 1;
  const double longest = law.resolution[static_cast<std::size_t>(before - points.begin())] / std::sqrt(resolution.kink);
  const double width = next->x - before->x, reach = h * (1 + kOneInstant);
  const bool is_near = width < kShortInterval * h || time - before->x < reach || next->x - time < reach;
  return {next->x, is_near ? longest : kNever};
}

// h: the sub-step
Need need_of(const MotionLaw& law, const MotionResolution& resolution, double time, double h) noexcept {
  switch (law.shape) {
    case MotionShape::ramp:
      return ramp_need(law, resolution, time, kOneInstant * h);
    case MotionShape::harmonic:
      if (law.amplitude == 0 || law.frequency == 0) return {};
      return {kNever, 1 / (std::fabs(law.frequency) * resolution.per_period)};
    case MotionShape::table:
    case MotionShape::speed:
      break;
  }
  return law.spline.empty() ? Need{} : table_need(law, resolution, time, kOneInstant * h, h);
}

double time_to_jump(const MotionLaw& law, double time, double rest) noexcept {
  for (const MotionJump& jump : law.jumps) {
    const bool is_within = jump.time > time && jump.time < time + rest;
    if (is_within && !jump.is_at(time) && !jump.is_at(time + rest)) return jump.time - time;
  }
  return rest;
}

}  // namespace

double time_to_jump(std::span<const Drive> drives, double time, double rest) noexcept {
  for (const Drive& drive : drives) rest = time_to_jump(drive.law, time, rest);
  return rest;
}

bool is_jump_at(std::span<const Drive> drives, double time) noexcept {
  return std::any_of(drives.begin(), drives.end(), [time](const Drive& drive) {
    const auto& jumps = drive.law.jumps;
    return std::any_of(jumps.begin(), jumps.end(), [time](const MotionJump& jump) { return jump.is_at(time); });
  });
}

bool is_motion_fast(const MotionLaw& law, const MotionResolution& resolution, double time, double h) noexcept {
  if (time_to_jump(law, time, h) < h) return true;
  double at = time;
  const double end = time + h * (1 - kOneInstant);
  // at most the points of a table within h
  while (at < end) {
    const Need need = need_of(law, resolution, at, h);
    if (need.longest < h * (1 - kOneInstant)) return true;
    at = need.until;
  }
  return false;
}

std::vector<double> table_resolution(const MotionLaw& law) {
  constexpr int kSamples = 8;
  constexpr double kRounding = 1e-9;
  // changes of speed below this share of the largest, as from the rounding of measured points, need less
  constexpr double kSmallPart = 0.02;
  const auto& points = law.spline.points;
  if (points.size() < 2) return {};
  const std::size_t count = points.size() - 1;
  const bool is_speed = law.shape == MotionShape::speed;
  // range of p' over every interval
  std::vector<std::array<double, 2>> range(count, {kNever, -kNever});
  std::array<double, 2> all{0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k <= kSamples; ++k) {
      const double x = points[i].x + (points[i + 1].x - points[i].x) * k / kSamples;
      const math::SplineValue value = math::value_at(law.spline, x);
      const double speed = is_speed ? value.y : value.slope;
      range[i] = {std::min(range[i][0], speed), std::max(range[i][1], speed)};
    }
    all = {std::min(all[0], range[i][0]), std::max(all[1], range[i][1])};
  }
  // p''' behind a point, constant in an interval of a table; of a speed the mean, as if it jumped at the points
  const auto third = [&](std::size_t i) {
    const auto &a = points[i], &b = points[i + 1];
    return is_speed ? 0.5 * (a.second + b.second) : (b.second - a.second) / (b.x - a.x);
  };
  std::vector<double> longest(count, kNever);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double jump = std::fabs((k < count ? third(k) : 0) - (k > 0 ? third(k - 1) : 0));
    const std::size_t first = k > 0 ? k - 1 : 0, last = std::min(k, count - 1);
    const double near = std::max(range[first][1], range[last][1]) - std::min(range[first][0], range[last][0]);
    const double R = std::max(near, kSmallPart * (all[1] - all[0]));
    const double width = std::max(points[first + 1].x - points[first].x, points[last + 1].x - points[last].x);
    // rounding of a straight table
    if (!(jump * width * width > kRounding * (all[1] - all[0]))) continue;
    const double resolved = std::sqrt(kLargestError * R / jump);
    longest[first] = std::min(longest[first], resolved);
    longest[last] = std::min(longest[last], resolved);
  }
  return longest;
}

bool is_motion_fast(std::span<const Drive> drives, const MotionResolution& resolution, double time, double h) noexcept {
  return std::any_of(drives.begin(), drives.end(),
                     [&](const Drive& drive) { return is_motion_fast(drive.law, resolution, time, h); });
}

double motion_piece(const MotionLaw& law, const MotionResolution& resolution, double time, double rest, double h,
                    double piece) noexcept {
  const Need need = need_of(law, resolution, time, h);
  // evenly up to the next jump
  const double left = std::min(need.until - time, rest);
  return std::min(piece, left / std::max(1.0, std::ceil(left / need.longest - kOneInstant)));
}

double motion_piece(std::span<const Drive> drives, const MotionResolution& resolution, double time, double rest,
                    double h) noexcept {
  double piece = rest;
  for (const Drive& drive : drives) piece = motion_piece(drive.law, resolution, time, rest, h, piece);
  if (piece > rest - kOneInstant * h) piece = rest;
  return time_to_jump(drives, time, piece);
}

FastMotion find_fast_motion(const MotionLaw& law, const MotionResolution& resolution, double h) {
  const auto pieces_from = [&](double time, double step) {
    int count = 0;
    for (double done = 0; done < step * (1 - kOneInstant) && count <= kMostMotionPieces; ++count) {
      done += motion_piece(law, resolution, time + done, step - done, step, step - done);
    }
    return count;
  };
  FastMotion found;
  const auto look = [&](double time) {
    double suits = h;
    while (is_motion_fast(law, resolution, time, suits) && pieces_from(time, suits) > kMostMotionPieces) suits *= 0.5;
    if (suits == h || (found.is_found && found.longest <= suits)) return;
    found = {true, time, suits};
  };
  if (law.shape == MotionShape::harmonic) look(0);
  // a sub-step may begin at any of the points or end there
  for (const math::SplinePoint& point : law.spline.points) {
    if (point.x + h > 0) look(point.x), look(point.x - h);
  }
  return found;
}

}  // namespace slew::multibody
