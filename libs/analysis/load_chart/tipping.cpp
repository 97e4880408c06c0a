// SPDX-License-Identifier: Apache-2.0
#include "analysis/load_chart/tipping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "core/display.h"
#include "core/failure.h"
#include "core/index.h"
#include "multibody/model/model.h"
#include "multibody/results/observe.h"

namespace slew::analysis {

using math::Vec3;

namespace {

// level distance from a line below which a point has no side
constexpr double kOnLine = 1e-6;  // m
// level part of a direction below which it is that of gravity
constexpr double kLeastLevel = 1e-6;

[[noreturn]] void refuse_line(const std::string& text) {
  throw Failure(ExitCode::bad_input,
                fmt::format("--tipping-line: '{}' is no line; expected two points of Ground in m that differ, such as "
                            "'1.4 0 -1.2, 1.4 0 1.2', and where its side is to be stated a third on the machine's side",
                            text));
}

Vec3 read_point(const std::string& point, const std::string& text) {
  std::istringstream words(point);
  double x = 0, y = 0, z = 0;
  std::string rest;
  if (!(words >> x >> y >> z) || (words >> rest) || !std::isfinite(x + y + z)) refuse_line(text);
  return {x, y, z};
}

// horizontal axes: the third one is up
struct LevelAxes {
  Vec3 right, ahead;
};

LevelAxes level_axes(Vec3 gravity) {
  const Vec3 up = gravity * (-1 / norm(gravity));
  const Vec3 across = std::fabs(up[0]) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
  const Vec3 ahead = cross(up, across);
  const Vec3 unit = ahead * (1 / norm(ahead));
  return {cross(unit, up), unit};
}

struct LevelPoint {
  double u = 0, v = 0;  // m
  Vec3 p;
};

double turn(const LevelPoint& a, const LevelPoint& b, const LevelPoint& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

// Andrew's monotone chain: corners in order around the polygon
std::vector<LevelPoint> hull_of(std::vector<LevelPoint> points) {
  std::sort(points.begin(), points.end(),
            [](const LevelPoint& a, const LevelPoint& b) { return a.u != b.u ? a.u < b.u : a.v < b.v; });
  std::vector<LevelPoint> hull;
  for (const bool is_upper : {false, true}) {
    const std::size_t begin = hull.size();
    for (const LevelPoint& point : points) {
      while (hull.size() >= begin + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    if (!is_upper) std::reverse(points.begin(), points.end());
  }
  return hull;
}

// Centre of mass of the parts that are fixed to Ground; none without mass.
std::optional<Vec3> fixed_center(std::span<const Weight> weights) {
  double mass = 0;
  Vec3 moment;
  for (const Weight& weight : weights) {
    if (!weight.is_fixed) continue;
    mass += weight.mass;
    moment += weight.c * weight.mass;
  }
  if (!(mass > 0)) return std::nullopt;
  return moment * (1 / mass);
}

// Sign of the side on which all points of the other lines lie; 0: they lie on both, or on the line.
double side_of_others(const std::vector<TippingLine>& lines, std::size_t line, Vec3 gravity) {
  bool is_left = false, is_right = false;
  for (const TippingLine& other : lines) {
    for (const Vec3& point : {other.P, other.Q}) {
      const double side = side_of(lines[line], point, gravity);
      is_left = is_left || side > kOnLine * norm(gravity);
      is_right = is_right || side < -kOnLine * norm(gravity);
    }
  }
  return is_left == is_right ? 0 : is_left ? 1 : -1;
}

}  // namespace

double side_of(const TippingLine& line, Vec3 point, Vec3 gravity) noexcept {
  const Vec3 along = line.Q - line.P;
  return dot(along, cross(point - line.P, gravity)) / norm(along);
}

TippingLine read_tipping_line(const std::string& text, Vec3 gravity) {
  std::vector<Vec3> points;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(',', begin);
    points.push_back(read_point(text.substr(begin, end == std::string::npos ? end : end - begin), text));
  }
  if (points.size() != 2 && points.size() != 3) refuse_line(text);
  TippingLine line{.P = points[0], .Q = points[1]};
  const Vec3 along = line.Q - line.P;
  if (!(norm(along) > 0)) refuse_line(text);
  if (norm(cross(along, gravity)) < kLeastLevel * norm(along) * norm(gravity)) {
    throw Failure(ExitCode::bad_input, fmt::format("--tipping-line: '{}' is vertical, and no weight has a moment about "
                                                   "it; nothing was computed; give two points that lie beside each "
                                                   "other, such as '1.4 0 -1.2, 1.4 0 1.2'",
                                                   text));
  }
  if (points.size() == 2) return line;
  line.side = side_of(line, points[2], gravity);
  if (!(std::fabs(line.side) > kOnLine * norm(gravity))) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("--tipping-line: the third point of '{}' lies on the line, seen along gravity; nothing was "
                    "computed; give one on the side where the machine stands",
                    text));
  }
  return line;
}

std::vector<TippingLine> lines_of_tyres(const multibody::Model& model, const multibody::Workspace& ws) {
  const LevelAxes axes = level_axes(model.gravity);
  std::vector<LevelPoint> places;
  Vec3 middle;
  for (const multibody::Tyre& tyre : model.elements.tyres) {
    const multibody::TyreState state = multibody::state_of(tyre, ws.motion[at(tyre.link)]);
    places.push_back({dot(state.Q, axes.right), dot(state.Q, axes.ahead), state.Q});
    middle += state.Q * (1.0 / static_cast<double>(model.elements.tyres.size()));
  }
  if (places.size() < 3) return {};
  const std::vector<LevelPoint> corners = hull_of(std::move(places));
  std::vector<TippingLine> lines;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    lines.push_back({corners[i].p, corners[(i + 1) % corners.size()].p});
    lines.back().side = side_of(lines.back(), middle, model.gravity);
  }
  return lines;
}

std::vector<Weight> weights_without(const multibody::Model& model, const multibody::Workspace& ws, int body) {
  std::vector<Weight> weights;
  const int own = model.bodies[at(body)].lumped;
  for (std::size_t i = 0; i < model.lumped.size(); ++i) {
    if (static_cast<int>(i) == own) continue;
    const multibody::LumpedMass& part = model.lumped[i];
    const multibody::LinkMotion& link = ws.motion[at(part.link)];
    weights.push_back({link.p + link.R * part.c_L, part.mass, part.link == 0});
  }
  // cylinder and piston on their line
  for (const multibody::CoupledMass& mass : model.coupled) {
    const multibody::LineMotion& line = ws.lines[at(mass.line)];
    weights.push_back({line.P1 + line.e * mass.c1, mass.m1});
    weights.push_back({line.P2 + line.e * mass.c2, mass.m2});
  }
  return weights;
}

TippingMoments tipping_moments(const TippingLine& line, std::span<const Weight> weights, Vec3 payload,
                               Vec3 gravity) noexcept {
  TippingMoments moments{.payload = side_of(line, payload, gravity)};
  for (const Weight& weight : weights) moments.rest += weight.mass * side_of(line, weight.c, gravity);
  return moments;
}

double tipping_load(const TippingMoments& moments, double side) noexcept {
  if (moments.rest * side <= 0) return 0;
  if (moments.payload * side >= 0) return std::numeric_limits<double>::infinity();
  return -moments.rest / moments.payload;
}

SideChoice choose_side(std::vector<TippingLine>& lines, std::size_t line, std::span<const Weight> weights,
                       std::span<const TippingMoments> moments, Vec3 gravity) {
  double& side = lines[line].side;
  if (const std::optional<Vec3> center = fixed_center(weights)) {
    side = side_of(lines[line], *center, gravity);
    if (std::fabs(side) > kOnLine * norm(gravity)) {
      return {.text =
                  fmt::format("the machine stands on the side of its parts that are fixed to Ground (centre of mass "
                              "at {} {} {} m)",
                              digits_text(center->x(), 4), digits_text(center->y(), 4), digits_text(center->z(), 4))};
    }
  }
  side = side_of_others(lines, line, gravity);
  if (side != 0) return {.text = "the machine stands on the side of the other lines"};
  constexpr const char* kRemedy =
      "where it stands on the other one, give the line a third point there, or fix its carrier with its mass to Ground";
  const auto count = [&](auto is_it) { return std::count_if(moments.begin(), moments.end(), is_it); };
  const auto beyond = count([](const TippingMoments& one) { return one.payload > 0; });
  const auto before = count([](const TippingMoments& one) { return one.payload < 0; });
  if ((beyond == 0) != (before == 0)) {
    side = beyond > 0 ? -1 : 1;
    return {.text = fmt::format("the machine is taken to stand on the side where the payload is not; {}", kRemedy),
            .is_sure = false};
  }
  const auto left = count([](const TippingMoments& one) { return one.rest > 0; });
  const auto right = count([](const TippingMoments& one) { return one.rest < 0; });
  side = left >= right ? 1 : -1;
  return {.text = fmt::format("the machine is taken to stand on the side on which it holds at most positions ({} of "
                              "{}); {}",
                              std::max(left, right), moments.size(), kRemedy),
          .is_sure = false};
}

}  // namespace slew::analysis
