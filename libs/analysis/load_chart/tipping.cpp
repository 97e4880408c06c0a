// SPDX-License-Identifier: Apache-2.0
#include "analysis/load_chart/tipping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/failure.h"
#include "core/index.h"
#include "multibody/model/model.h"
#include "multibody/results/observe.h"

namespace slew::analysis {

using math::Vec3;

namespace {

[[noreturn]] void refuse_line(const std::string& text) {
  throw Failure(ExitCode::bad_input,
                fmt::format("--tipping-line: '{}' is no line; expected two points of Ground in m that differ, such as "
                            "'1.4 0 -1.2, 1.4 0 1.2'",
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

double moment(const TippingLine& line, Vec3 c, Vec3 force) noexcept {
  const Vec3 along = line.Q - line.P;
  return dot(along, cross(c - line.P, force)) / norm(along);
}

}  // namespace

TippingLine read_tipping_line(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) refuse_line(text);
  TippingLine line;
  line.P = read_point(text.substr(0, comma), text);
  line.Q = read_point(text.substr(comma + 1), text);
  if (!(norm(line.Q - line.P) > 0)) refuse_line(text);
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
    lines.push_back({corners[i].p, corners[(i + 1) % corners.size()].p, middle, true});
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
    weights.push_back({link.p + link.R * part.c_L, part.mass});
  }
  // cylinder and piston on their line
  for (const multibody::CoupledMass& mass : model.coupled) {
    const multibody::LineMotion& line = ws.lines[at(mass.line)];
    weights.push_back({line.P1 + line.e * mass.c1, mass.m1});
    weights.push_back({line.P2 + line.e * mass.c2, mass.m2});
  }
  return weights;
}

double tipping_load(const TippingLine& line, std::span<const Weight> weights, Vec3 payload, Vec3 gravity) noexcept {
  double rest = 0;
  for (const Weight& weight : weights) rest += moment(line, weight.c, gravity * weight.mass);
  const double of_payload = moment(line, payload, gravity);
  const double side = line.has_side ? moment(line, line.inside, gravity) : rest;
  if (rest * side <= 0) return 0;
  if (of_payload * side >= 0) return std::numeric_limits<double>::infinity();
  return -rest / of_payload;
}

}  // namespace slew::analysis
