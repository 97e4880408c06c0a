// SPDX-License-Identifier: Apache-2.0
// The shapes of sensors, in groups that are placed by the motions of their frames; searches between two groups by FCL.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "math/vector3.h"
#include "sensors/fcl_border.h"
#include "sensors/sensors.h"

namespace slew::sensors {

// Indices of the shapes that a list names; in the list's order, each once. A zone is no part of its body: it counts
// under its own name only.
[[nodiscard]] std::vector<std::size_t> shapes_of(const SensorsDef& def, const std::vector<std::string>& names);

[[nodiscard]] inline math::Vec3 velocity_of(const FrameMotion& frame, math::Vec3 point_W) {
  return frame.v_W + cross(frame.w_W, point_W - frame.p_W);
}

struct Sensors::Search {
  struct Shape {
    std::size_t geometry = 0, frame = 0;
    math::Vec3 p_FS;
    math::Mat3 R_FS;
    double extent = 0;  // m, of the farthest point from the frame's origin
  };
  struct Nearest {
    double distance = 0;
    math::Vec3 p_a_W, p_b_W, n_W;
    std::size_t frame_a = 0, frame_b = 0;

    // m/s, (2); motion_of: motion of a frame
    template <typename MotionOf>
    [[nodiscard]] double closing_speed(const MotionOf& motion_of) const {
      return -dot(velocity_of(motion_of(frame_a), p_a_W) - velocity_of(motion_of(frame_b), p_b_W), n_W);
    }
  };

  explicit Search(const SensorsDef& def);

  std::size_t add_group(const std::vector<std::size_t>& members);

  template <typename MotionOf>
  void place(std::size_t group, const MotionOf& motion_of) {
    for (std::size_t k = 0; k < group_shapes[group].size(); ++k) {
      const Shape& shape = shapes[group_shapes[group][k]];
      const FrameMotion motion = motion_of(shape.frame);
      const std::array<double, 3> p = (motion.p_W + motion.R_W * shape.p_FS).array();
      const math::Mat3 R = motion.R_W * shape.R_FS;
      double columns[9];
      for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) columns[3 * column + row] = R(row, column);
      }
      fcl_border::place(*groups, group, k, {p.data(), columns});
    }
  }

  // Nearest points of two placed groups. False: the search failed.
  bool find_nearest(std::size_t a, std::size_t b, Nearest& found);

  static void free_geometries(fcl_border::Geometries* p) noexcept { fcl_border::destroy(p); }
  static void free_groups(fcl_border::Groups* p) noexcept { fcl_border::destroy(p); }

  std::unique_ptr<fcl_border::Geometries, void (*)(fcl_border::Geometries*) noexcept> geometries;
  std::unique_ptr<fcl_border::Groups, void (*)(fcl_border::Groups*) noexcept> groups;
  std::vector<Shape> shapes;
  std::vector<std::vector<std::size_t>> group_shapes;
};

}  // namespace slew::sensors
