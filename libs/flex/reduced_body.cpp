// SPDX-License-Identifier: Apache-2.0
#include "flex/reduced_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "flex/input_error.h"

namespace slew::flex {

using math::Vec3;

namespace {

template <typename T>
std::vector<T> picked(const std::vector<T>& from, const std::vector<std::size_t>& places) {
  std::vector<T> out;
  if (from.empty()) return out;
  for (const std::size_t place : places) out.push_back(from[place]);
  return out;
}

template <typename T>
std::vector<T> picked_pairs(const std::vector<T>& from, const std::vector<std::size_t>& places, std::size_t count) {
  std::vector<T> out;
  if (from.empty()) return out;
  for (const std::size_t k : places) {
    for (const std::size_t l : places) out.push_back(from[k * count + l]);
  }
  return out;
}

}  // namespace

std::vector<std::size_t> places_of(std::span<const int> ordinals, std::size_t count) {
  std::vector<std::size_t> places;
  for (const int ordinal : ordinals) {
    if (ordinal < 1 || static_cast<std::size_t>(ordinal) > count)
      throw InputError(
          fmt::format("there is no mode {}; expected 1 to {}; reduce with more fixed-interface modes to "
                      "have more",
                      ordinal, count));
    const auto place = static_cast<std::size_t>(ordinal) - 1;
    if (std::find(places.begin(), places.end(), place) != places.end())
      throw InputError(fmt::format("mode {} is given twice; expected each once", ordinal));
    places.push_back(place);
  }
  std::sort(places.begin(), places.end());
  return places;
}

ReducedBody select(const ReducedBody& body, std::span<const int> ordinals) {
  const std::size_t m = body.modes();
  const std::vector<std::size_t> places = places_of(ordinals, m);
  ReducedBody out;
  out.mass = body.mass;
  out.s0 = body.s0;
  out.W0 = body.W0;
  out.omega = picked(body.omega, places);
  out.C = picked(body.C, places);
  out.Z = picked(body.Z, places);
  out.Y = picked_pairs(body.Y, places, m);
  out.G = picked_pairs(body.G, places, m);
  out.H = picked_pairs(body.H, places, m);
  out.K = picked_pairs(body.K, places, m);
  for (const ReducedNode& node : body.nodes) {
    out.nodes.push_back(
        {node.id, node.position, picked(node.phi, places), picked(node.psi, places), picked_pairs(node.g, places, m)});
  }
  return out;
}

std::vector<int> modes_up_to(const ReducedBody& body, double highest) {
  std::vector<int> ordinals;
  for (std::size_t k = 0; k < body.modes() && body.omega[k] <= highest; ++k)
    ordinals.push_back(static_cast<int>(k) + 1);
  return ordinals;
}

std::vector<int> mode_list(std::string_view text) {
  std::vector<int> ordinals;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    std::string_view item = text.substr(at, end - at);
    while (!item.empty() && item.front() == ' ') item.remove_prefix(1);
    while (!item.empty() && item.back() == ' ') item.remove_suffix(1);
    int value = 0;
    const auto [stop, error] = std::from_chars(item.data(), item.data() + item.size(), value);
    if (item.empty() || error != std::errc() || stop != item.data() + item.size())
      throw InputError(
          fmt::format("'{}' in the list of modes '{}' is no whole number; expected ordinals counted from 1 "
                      "with ; between them, as in 1;2",
                      item, text));
    ordinals.push_back(value);
    at = end + 1;
  }
  return ordinals;
}

std::size_t find_node(const ReducedBody& body, int id) {
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    if (body.nodes[i].id == id) return i;
  }
  throw InputError(fmt::format("there is no node {}; expected one of the body's {} nodes", id, body.nodes.size()));
}

double strain_energy(const ReducedBody& body, std::span<const double> q) noexcept {
  double sum = 0;
  for (std::size_t k = 0; k < body.modes(); ++k) {
    double force = 0;
    for (std::size_t l = 0; l < body.modes(); ++l) force += body.K[body.pair(k, l)] * q[l];
    sum += q[k] * force;
  }
  return sum / 2;
}

Vec3 deflection(const ReducedNode& node, std::span<const double> q) noexcept {
  const std::size_t m = node.phi.size();
  Vec3 moved;
  for (std::size_t k = 0; k < m; ++k) moved += node.phi[k] * q[k];
  if (node.g.empty()) return moved;
  for (std::size_t k = 0; k < m; ++k) {
    for (std::size_t l = 0; l < m; ++l) moved += node.g[k * m + l] * (0.5 * q[k] * q[l]);
  }
  return moved;
}

Vec3 rotation(const ReducedNode& node, std::span<const double> q) noexcept {
  Vec3 turned;
  for (std::size_t k = 0; k < node.psi.size(); ++k) turned += node.psi[k] * q[k];
  return turned;
}

}  // namespace slew::flex
