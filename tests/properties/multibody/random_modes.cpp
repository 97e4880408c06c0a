// SPDX-License-Identifier: Apache-2.0
#include "tests/properties/multibody/random_modes.h"

namespace slew::multibody::testing {

using math::Mat3;
using math::Vec3;

ModalBody modal_body(const std::vector<MassPoint>& points) {
  const std::size_t n = points.front().phi.size();
  ModalBody body;
  body.C.resize(n);
  body.Z.resize(n);
  body.Y.resize(n * n);
  body.mass_matrix.resize(n * n);
  body.stiffness.resize(n * n);
  for (const MassPoint& point : points) {
    body.mass += point.mass;
    body.first_moment += point.x * point.mass;
    body.second_moment += outer(point.x * point.mass, point.x);
    for (std::size_t k = 0; k < n; ++k) {
      body.C[k] += point.phi[k] * point.mass;
      body.Z[k] += outer(point.x * point.mass, point.phi[k]);
      for (std::size_t l = 0; l < n; ++l) {
        body.Y[k * n + l] += outer(point.phi[k] * point.mass, point.phi[l]);
        body.mass_matrix[k * n + l] += point.mass * dot(point.phi[k], point.phi[l]);
      }
    }
  }
  return body;
}

ModalBody random_modes(std::mt19937& random, Vec3 root, std::vector<MassPoint>& points) {
  const auto number = [&random](double size) { return std::uniform_real_distribution<double>(-size, size)(random); };
  // braces: g++ evaluates arguments in parentheses from the right, clang from the left
  const auto vector = [&number](double size) { return Vec3{number(size), number(size), number(size)}; };
  const std::size_t n = 1 + random() % 3;
  const auto vectors = [&](double size) {
    std::vector<Vec3> list(n);
    for (Vec3& v : list) v = vector(size);
    return list;
  };
  points.resize(6);
  for (MassPoint& point : points) point = {0.3 + std::abs(number(1)), root + vector(1), vectors(0.5)};
  ModalBody body = modal_body(points);
  // symmetric, positive definite
  std::vector<double> root_of(n * n);
  for (double& x : root_of) x = number(8);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l < n; ++l) {
      for (std::size_t j = 0; j < n; ++j) body.stiffness[k * n + l] += root_of[k * n + j] * root_of[l * n + j];
    }
  }
  body.root = 0;
  body.nodes.push_back({1, root, std::vector<Vec3>(n), std::vector<Vec3>(n), {}});
  for (std::int64_t id : {7, 3, 12}) body.nodes.push_back({id, root + vector(1), vectors(0.4), vectors(0.4), {}});
  return body;
}

void shorten(std::mt19937& random, const std::vector<MassPoint>& points, ModalBody& body) {
  const auto number = [&random] { return std::uniform_real_distribution<double>(-0.03, 0.03)(random); };
  const std::size_t n = body.modes();
  body.G.resize(n * n);
  body.H.resize(n * n);
  for (ModalNode& node : body.nodes) node.shortening.resize(n * n);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l <= k; ++l) {
      for (const MassPoint& point : points) {
        const Vec3 g = Vec3{number(), number(), number()} * point.mass;
        body.G[k * n + l] += g;
        body.H[k * n + l] += outer(point.x, g);
      }
      body.G[l * n + k] = body.G[k * n + l];
      body.H[l * n + k] = body.H[k * n + l];
      for (std::size_t i = 1; i < body.nodes.size(); ++i) {
        body.nodes[i].shortening[k * n + l] = body.nodes[i].shortening[l * n + k] = Vec3{number(), number(), number()};
      }
    }
  }
}

}  // namespace slew::multibody::testing
