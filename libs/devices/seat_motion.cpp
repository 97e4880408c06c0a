// SPDX-License-Identifier: Apache-2.0
#include "devices/seat_motion.h"

#include <fmt/format.h>

#include <cmath>

#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr double kSquare = 1e-3;  // largest cosine between forward and up: written with three digits

constexpr Field kSeatFields[] = {
    field<&SeatDef::point>("point", {.dimension = Dimension::length, .doc = "the driver's head, in axes of the body"}),
    field<&SeatDef::forward>("forward",
                             {.presence = Presence::required, .doc = "direction of view, in axes of the body"}),
    field<&SeatDef::up>("up", {.presence = Presence::required, .doc = "square to forward, in axes of the body"}),
};

}  // namespace

std::span<const Field> seat_fields() noexcept {
  return kSeatFields;
}

void validate(std::string_view path, const SeatDef& def, Problems& problems) {
  check_fields(path, &def, kSeatFields, problems);
  const math::Vec3 forward(def.forward), up(def.up);
  const double lengths = norm(forward) * norm(up);
  if (!(lengths > 0)) {
    problems.push_back({fmt::format("{}.forward", path), "forward or up has no direction", "two vectors, not 0", ""});
  } else if (std::abs(dot(forward, up)) > kSquare * lengths) {
    problems.push_back({fmt::format("{}.up", path),
                        fmt::format("the angle between forward and up is {:.4g} deg",
                                    std::acos(dot(forward, up) / lengths) * 180 / M_PI),
                        "90 deg", ""});
  }
}

Seat build_seat(const SeatDef& def, const Triple& gravity_W) noexcept {
  const math::Vec3 forward(def.forward), up(def.up);
  const math::Vec3 x = forward * (1 / norm(forward));
  const math::Vec3 sideways = cross(up, x);
  const math::Vec3 y = sideways * (1 / norm(sideways));
  return {math::Vec3(def.point), math::Mat3{x, y, cross(x, y)}, math::Vec3(gravity_W)};
}

std::optional<SeatMotion> seat_motion(const Seat& seat, const BodyMotion& body, SeatState& state) noexcept {
  const math::Mat3 R_WB = rotation_of(body.q_WB);
  const math::Vec3 v_WP = body.v_WB + cross(body.w_WB, R_WB * seat.point_B);
  const SeatState before = state;
  state = {true, body.time, v_WP};
  if (!before.has_sample || !(body.time > before.time)) return std::nullopt;
  const math::Vec3 f_W = (v_WP - before.v_WP) * (1 / (body.time - before.time)) - seat.gravity_W;
  const auto in_seat = [&](math::Vec3 a_W) {
    return transpose_multiply(seat.R_BP, transpose_multiply(R_WB, a_W)).array();
  };
  return SeatMotion{in_seat(f_W), in_seat(body.w_WB), body.time};
}

}  // namespace slew::devices
