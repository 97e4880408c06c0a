// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/start_pose.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

// R with its z turned the shortest way onto a unit vector
Mat3 with_axis(const Mat3& R, Vec3 z) noexcept {
  const Vec3 axis = cross(R.c[2], z);
  const double sine = norm(axis), cosine = dot(R.c[2], z);
  if (sine == 0) return R;
  const Mat3 K = math::skew(axis * (1 / sine));
  return (Mat3::identity() + K * sine + K * K * (1 - cosine)) * R;
}

}  // namespace

UniversalStart universal_start(const JointFrames& frames) noexcept {
  const Mat3 &R1 = frames.frame1.R, &R2 = frames.frame2.R;
  UniversalStart start;
  start.q1 = std::atan2(dot(R2.c[2], R1.c[1]), dot(R2.c[2], R1.c[0]));
  const Mat3 between = R1 * math::rotation_z(start.q1);
  start.q2 = std::atan2(dot(R2.c[0], between.c[2]), dot(R2.c[0], between.c[1]));
  start.R = Mat3{between.c[1], between.c[2], between.c[0]} * math::rotation_z(start.q2);
  return start;
}

std::array<double, 2> start_coordinates(JointType type, const JointFrames& frames) noexcept {
  switch (type) {
    case JointType::revolute:
    case JointType::prismatic:
      return {start_coordinate(type, frames), 0};
    case JointType::cylindrical:
      return {start_coordinate(JointType::revolute, frames), start_coordinate(JointType::prismatic, frames)};
    case JointType::universal: {
      const UniversalStart start = universal_start(frames);
      return {start.q1, start.q2};
    }
    default:
      return {};
  }
}

std::array<double, 2> start_coordinates(const JointDef& joint, const JointFrames& frames) noexcept {
  std::array<double, 2> q = start_coordinates(joint.type, frames);
  const std::int64_t turns[] = {joint.first.start_turns, joint.second.start_turns};
  for (std::size_t k = 0; k < 2; ++k) {
    if (turns[k] != 0) q[k] += 2 * std::numbers::pi * static_cast<double>(turns[k]);
  }
  return q;
}

Pose frame_at(JointType type, const Pose& frame1, const std::array<double, 2>& q) noexcept {
  switch (type) {
    case JointType::revolute:
      return {frame1.R * math::rotation_z(q[0]), frame1.p};
    case JointType::prismatic:
      return {frame1.R, frame1.p + frame1.R.c[2] * q[0]};
    case JointType::cylindrical:
      return {frame1.R * math::rotation_z(q[0]), frame1.p + frame1.R.c[2] * q[1]};
    case JointType::universal: {
      const Mat3 between = frame1.R * math::rotation_z(q[0]);
      return {Mat3{between.c[1], between.c[2], between.c[0]} * math::rotation_z(q[1]), frame1.p};
    }
    default:
      return frame1;
  }
}

Pose nearest_frame(JointType type, const JointFrames& frames) noexcept {
  const auto& [frame1, frame2] = frames;
  const Vec3 z = frame1.R.c[2];
  const Vec3 on_axis = frame1.p + z * dot(z, frame2.p - frame1.p);
  switch (type) {
    case JointType::revolute:
      return {with_axis(frame2.R, z), frame1.p};
    case JointType::cylindrical:
      return {with_axis(frame2.R, z), on_axis};
    case JointType::prismatic:
      return {frame1.R, on_axis};
    case JointType::fixed:
    case JointType::node:
      return frame1;
    case JointType::spherical:
      return {frame2.R, frame1.p};
    case JointType::universal:
      return {universal_start(frames).R, frame1.p};
    default:
      return frame2;
  }
}

}  // namespace slew::multibody
