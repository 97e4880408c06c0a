// SPDX-License-Identifier: Apache-2.0
#include "contact/shape_properties.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/check.h"

namespace slew::contact {

using math::Mat3;
using math::Vec3;

namespace {

constexpr double kPi = std::numbers::pi;
// points in a part, and the most that are tried for them: a thin tube fills little of its box
constexpr int kPoints = 4096, kTriedPoints = 64 * kPoints;
// rounding of poses and sizes, relative to the part: surfaces that coincide are no gap
constexpr double kSurfaceMargin = 1e-9;
constexpr double kDensityMargin = 1e-9;

MassProperties of_volume(double volume, double Ixx, double Iyy, double Izz) {
  MassProperties out;
  out.volume = out.mass = volume;
  out.inertia = Mat3::diagonal(Ixx, Iyy, Izz);
  return out;
}

// (1)
MassProperties box(double a, double b, double c) {
  const double V = a * b * c;
  return of_volume(V, V * (b * b + c * c) / 12, V * (a * a + c * c) / 12, V * (a * a + b * b) / 12);
}

MassProperties hollow_box(const SolidDef& def) {
  const MassProperties outside = box(def.length, def.width, def.height);
  const MassProperties inside = box(def.length, def.width - 2 * def.wall, def.height - 2 * def.flange);
  MassProperties out = outside;
  out.volume = out.mass = outside.volume - inside.volume;
  out.inertia = outside.inertia - inside.inertia;
  return out;
}

// (3)
MassProperties tube(double R, double r, double L) {
  const double V = kPi * (R - r) * (R + r) * L, squares = R * R + r * r;
  const double across = V * (3 * squares + L * L) / 12;
  return of_volume(V, across, across, V * squares / 2);
}

// (4)
MassProperties capsule(double R, double L) {
  const double V1 = kPi * R * R * L, V2 = 4.0 / 3 * kPi * R * R * R;
  const double across = V1 * (R * R / 4 + L * L / 12) + V2 * (0.4 * R * R + L * L / 4 + 0.375 * L * R);
  return of_volume(V1 + V2, across, across, V1 * R * R / 2 + V2 * 0.4 * R * R);
}

// (5)
MassProperties cone(double a, double b, double L) {
  const double sum = a * a + a * b + b * b, V = kPi * L / 3 * sum;
  const double h = L / 4 * (a * a + 2 * a * b + 3 * b * b) / sum;
  const double Izz = kPi * L / 10 * (a * a * a * a + a * a * a * b + a * a * b * b + a * b * b * b + b * b * b * b);
  const double across = Izz / 2 + kPi * L * L * L / 30 * (a * a + 3 * a * b + 6 * b * b) - V * h * h;
  MassProperties out = of_volume(V, across, across, Izz);
  out.centre = Vec3(0, 0, h - L / 2);
  return out;
}

bool is_in_box(Vec3 p, double a, double b, double c) {
  return std::abs(p.x()) <= a && std::abs(p.y()) <= b && std::abs(p.z()) <= c;
}

bool holds(const PlacedSolid& part, Vec3 p_B, double margin) noexcept {
  return is_inside(part.def, transpose_multiply(part.R_BS, p_B - part.p_BS), margin);
}

// element of the sequence of van der Corput, 0 .. 1
double radical_inverse(int index, int base) {
  double value = 0, digit = 1.0 / base;
  for (int rest = index; rest > 0; rest /= base, digit /= base) value += rest % base * digit;
  return value;
}

// Share of a part's points for which a condition on the point, and on the parts near to this one, holds.
template <typename Condition>
double share_of(std::span<const PlacedSolid> parts, std::size_t part, const Condition& condition) {
  SLEW_ASSERT(part < parts.size());
  const PlacedSolid& own = parts[part];
  const Vec3 half = half_extent(own.def);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double reach = norm(half) + norm(half_extent(parts[i].def));
    if (i != part && norm(parts[i].p_BS - own.p_BS) <= reach) near.push_back(i);
  }
  const double margin = kSurfaceMargin * (norm(half) + norm(own.p_BS));
  int inside = 0, found = 0;
  for (int i = 1; i <= kTriedPoints && inside < kPoints; ++i) {
    const Vec3 p_S(half.x() * (2 * radical_inverse(i, 2) - 1), half.y() * (2 * radical_inverse(i, 3) - 1),
                   half.z() * (2 * radical_inverse(i, 5) - 1));
    if (!is_inside(own.def, p_S, 0)) continue;
    ++inside;
    if (condition(near, own.p_BS + own.R_BS * p_S, margin)) ++found;
  }
  return inside == 0 ? 0 : static_cast<double>(found) / inside;
}

}  // namespace

MassProperties shape_properties(const SolidDef& def) noexcept {
  switch (def.type) {
    case SolidType::box:
      return box(def.size[0], def.size[1], def.size[2]);
    case SolidType::hollow_box:
      return hollow_box(def);
    case SolidType::sphere: {  // (2)
      const double V = 4.0 / 3 * kPi * def.radius * def.radius * def.radius, I = 0.4 * V * def.radius * def.radius;
      return of_volume(V, I, I, I);
    }
    case SolidType::cylinder:
      return tube(def.radius, 0, def.length);
    case SolidType::tube:
      return tube(def.diameter / 2, def.inner_diameter / 2, def.length);
    case SolidType::cone:
      return cone(def.radius, def.top_radius, def.length);
    case SolidType::capsule:
      return capsule(def.radius, def.length);
  }
  return {};
}

Vec3 half_extent(const SolidDef& def) noexcept {
  switch (def.type) {
    case SolidType::box:
      return Vec3(def.size[0], def.size[1], def.size[2]) * 0.5;
    case SolidType::hollow_box:
      return Vec3(def.length, def.width, def.height) * 0.5;
    case SolidType::sphere:
      return Vec3(def.radius, def.radius, def.radius);
    case SolidType::cylinder:
      return {def.radius, def.radius, def.length / 2};
    case SolidType::tube:
      return Vec3(def.diameter, def.diameter, def.length) * 0.5;
    case SolidType::cone: {
      const double widest = std::max(def.radius, def.top_radius);
      return {widest, widest, def.length / 2};
    }
    case SolidType::capsule:
      return {def.radius, def.radius, def.length / 2 + def.radius};
  }
  return {};
}

bool is_inside(const SolidDef& def, Vec3 p, double margin) noexcept {
  const Vec3 half = half_extent(def);
  if (!is_in_box(p, half.x() + margin, half.y() + margin, half.z() + margin)) return false;
  const double r = std::hypot(p.x(), p.y());
  switch (def.type) {
    case SolidType::box:
      return true;
    case SolidType::hollow_box:
      return std::abs(p.y()) >= def.width / 2 - def.wall - margin ||
             std::abs(p.z()) >= def.height / 2 - def.flange - margin;
    case SolidType::sphere:
      return norm(p) <= def.radius + margin;
    case SolidType::cylinder:
      return r <= def.radius + margin;
    case SolidType::tube:
      return r <= def.diameter / 2 + margin && r >= def.inner_diameter / 2 - margin;
    case SolidType::cone:
      return r <= def.radius + (def.top_radius - def.radius) * (p.z() / def.length + 0.5) + margin;
    case SolidType::capsule:
      return std::hypot(r, std::max(0.0, std::abs(p.z()) - def.length / 2)) <= def.radius + margin;
  }
  return false;
}

MassProperties sum_of(std::span<const PlacedSolid> parts) noexcept {
  MassProperties sum;
  Vec3 moment;
  for (const PlacedSolid& part : parts) {
    const MassProperties own = shape_properties(part.def);
    sum.volume += part.density < 0 ? -own.volume : own.volume;
    sum.mass += own.volume * part.density;
    moment = moment + (part.p_BS + part.R_BS * own.centre) * (own.volume * part.density);
  }
  if (!(sum.mass > 0) || !(sum.volume > 0)) return sum;
  sum.centre = moment * (1 / sum.mass);
  for (const PlacedSolid& part : parts) {
    const MassProperties own = shape_properties(part.def);
    const Vec3 d = part.p_BS + part.R_BS * own.centre - sum.centre;
    const double square = dot(d, d);
    sum.inertia += part.R_BS * (own.inertia * part.density) * transpose(part.R_BS);
    sum.inertia += (Mat3::diagonal(square, square, square) - outer(d, d)) * (own.volume * part.density);
  }
  return sum;
}

double share_without_material(std::span<const PlacedSolid> parts, std::size_t hole) {
  return share_of(parts, hole, [&](const std::vector<std::size_t>& near, Vec3 p_B, double margin) {
    double density = parts[hole].density;
    for (const std::size_t i : near) {
      // a margin in favour of material
      const double own_margin = parts[i].density < 0 ? -margin : margin;
      if (holds(parts[i], p_B, own_margin)) density += parts[i].density;
    }
    return density < kDensityMargin * parts[hole].density;
  });
}

double share_counted_twice(std::span<const PlacedSolid> parts, std::size_t part) {
  return share_of(parts, part, [&](const std::vector<std::size_t>& near, Vec3 p_B, double margin) {
    int count = 1;
    bool is_in_earlier = false;
    for (const std::size_t i : near) {
      // a margin in favour of one
      const bool is_hole = parts[i].density < 0;
      if (!holds(parts[i], p_B, is_hole ? margin : -margin)) continue;
      count += is_hole ? -1 : 1;
      is_in_earlier = is_in_earlier || (!is_hole && i < part);
    }
    return is_in_earlier && count > 1;
  });
}

}  // namespace slew::contact
