// SPDX-License-Identifier: Apache-2.0
// Shapes and poses at random, for the property tests of contact.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "math/rotation.h"
#include "support/contact_shapes.h"

namespace slew::contact::testing {

class RandomShapes : public ::testing::Test {
 protected:
  explicit RandomShapes(std::uint64_t seed) : random_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  math::Vec3 place(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  math::Mat3 rotation(double size = 3) {
    return math::rotation_zxz({uniform(-size, size), uniform(-size, size), uniform(-size, size)});
  }
  // about 1 m large
  ShapeDef shape(ShapeType type) {
    switch (type) {
      case ShapeType::sphere:
        return sphere(uniform(0.2, 1));
      case ShapeType::box:
        return box(uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2));
      case ShapeType::plane:
        return plane();
      case ShapeType::height_field:
        return flat_field(4, 4, 0.5);
      case ShapeType::convex_mesh:
        return box_mesh(uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2));
      default:
        return rounded(type, uniform(0.1, 0.8), uniform(0.2, 2));
    }
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace slew::contact::testing
