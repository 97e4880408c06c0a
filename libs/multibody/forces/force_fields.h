// SPDX-License-Identifier: Apache-2.0
// Rows that the field tables of several kinds of forces and dummies share. Internal to the library.
#pragma once

#include "core/field.h"

namespace slew::multibody {

template <auto Member>
constexpr Field required_body(std::string_view key, std::string_view doc) {
  return field<Member>(key, {.presence = Presence::required, .reference = "body", .doc = doc});
}

template <auto Frames, auto Member>
constexpr Field connector_body(std::string_view key, std::string_view doc) {
  return field<Frames, Member>(key, {.presence = Presence::required, .reference = "body", .doc = doc});
}
template <auto Frames, auto Member>
constexpr Field connector_point(std::string_view key, std::string_view doc) {
  return field<Frames, Member>(key, {.dimension = Dimension::length, .doc = doc});
}
template <auto Frames, auto Member>
constexpr Field connector_axes(std::string_view key, std::string_view doc) {
  return field<Frames, Member>(key, {.dimension = Dimension::angle, .doc = doc});
}

template <auto Member>
constexpr Field dummy_mass(std::string_view doc) {
  return field<Member>("mass", {.dimension = Dimension::mass, .range = kNotNegative, .doc = doc});
}

}  // namespace slew::multibody
