// SPDX-License-Identifier: Apache-2.0
#include "scene/solid_inertia.h"

#include <fmt/format.h>

#include <algorithm>

namespace slew::scene {
namespace {

// m, m3, kg/m3: limits beyond which the unit is wrong; a bucket-wheel excavator is 225 m long
constexpr double kLargestSize = 1000, kSmallestSize = 1e-5, kLargestVolume = 1e6;
constexpr double kLightest = 0.1, kDensest = 25000;
// m, kg: limits beyond which the unit may be wrong; single bodies of machines are smaller
constexpr double kLikelySize = 100, kLikelySmall = 1e-3, kLikelyMass = 1e6;

bool is_one_of(std::string_view key, std::span<const std::string_view> keys) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

}  // namespace

bool has_inertia_word(const Node& body, std::string_view word) {
  const Node::Entry* entry = body.find(kInertiaKey);
  return entry != nullptr && entry->value.kind == Node::Kind::scalar && entry->value.text == word;
}

std::vector<Field> fields_beside_solid(std::span<const Field> body_fields) {
  std::vector<Field> rows;
  for (const Field& row : body_fields) {
    if (row.key != kInertiaKey && row.key != kMassKey && !is_one_of(row.key, kDerivedKeys)) rows.push_back(row);
  }
  return rows;
}

void read_beside_solid(const Node::Entry& element, std::span<const Field> body_fields, multibody::BodyDef& body,
                       std::span<const Field> own, void* own_def, std::span<const std::string_view> more_keys,
                       const ReadContext& context) {
  Node of_solid;
  of_solid.kind = Node::Kind::map;
  of_solid.mark = element.value.mark;
  const auto is_own = [&](const Node::Entry& entry) {
    return std::any_of(own.begin(), own.end(), [&](const Field& row) { return row.key == entry.key; });
  };
  for (const Node::Entry& entry : element.value.entries) {
    if (is_own(entry)) of_solid.entries.push_back(entry);
  }
  std::vector<std::string_view> other_keys = {"type", kInertiaKey};
  other_keys.insert(other_keys.end(), std::begin(kDerivedKeys), std::end(kDerivedKeys));
  other_keys.insert(other_keys.end(), more_keys.begin(), more_keys.end());
  for (const Field& row : own) other_keys.push_back(row.key);
  read_fields(element.value, fields_beside_solid(body_fields), &body, element.key, element.mark, other_keys, context);
  read_fields(of_solid, own, own_def, element.key, element.mark, {}, context);
}

void refuse_derived_keys(const Node::Entry& element, std::string_view solid, std::string_view word,
                         const ReadContext& context) {
  for (const std::string_view key : kDerivedKeys) {
    if (const Node::Entry* entry = element.value.find(key)) {
      context.report.add(
          entry->mark, fmt::format("{}.{}", element.key, key),
          {fmt::format("follows from {}", solid), fmt::format("no such key beside inertia: {}", word), ""});
    }
  }
}

void check_density_or_mass(const Node& map, const std::string& path, const Mark& place, std::string_view of_what,
                           const ReadContext& context) {
  const Node::Entry* density = map.find(kDensityKey);
  const Node::Entry* mass = map.find(kMassKey);
  if (density != nullptr && mass != nullptr) {
    context.report.add(mass->mark, fmt::format("{}.{}", path, kMassKey),
                       {"density and mass are both given", "one of them", ""});
  } else if (density == nullptr && mass == nullptr) {
    context.report.add(place, path,
                       {"neither density nor mass is given", fmt::format("one of them, for {}", of_what), ""});
  }
}

Plausibility plausibility_of(double size, double volume, double density) noexcept {
  const bool has_size = size <= kLargestSize && size >= kSmallestSize && volume > 0 && volume <= kLargestVolume;
  if (!has_size || !(density <= kDensest && density >= kLightest)) return Plausibility::impossible;
  const bool is_likely = size <= kLikelySize && size >= kLikelySmall && volume * density <= kLikelyMass;
  return is_likely ? Plausibility::likely : Plausibility::unlikely;
}

void put_inertia(math::Vec3 centre_B, const math::Mat3& I_B, multibody::BodyDef& body) noexcept {
  body.center_of_mass = centre_B.array();
  body.inertia = {I_B(0, 0), I_B(1, 1), I_B(2, 2)};
  body.products = {I_B(0, 1), I_B(0, 2), I_B(1, 2)};
  body.inertia_about = multibody::InertiaPoint::center_of_mass;
}

}  // namespace slew::scene
