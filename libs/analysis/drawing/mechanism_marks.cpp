// SPDX-License-Identifier: Apache-2.0
#include "analysis/drawing/mechanism_marks.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace slew::analysis {
namespace {

using multibody::JointType;

constexpr double kAcross = 0.7;     // share of an axis that points to the viewer, from which it is a circle
constexpr double kAxisLength = 22;  // px, of a frame's axes

constexpr std::string_view kJointWords[] = {"revolute",
                                            "prismatic",
                                            "spherical",
                                            "fixed",
                                            "floating",
                                            "universal",
                                            "cylindrical",
                                            "in plane",
                                            "in line",
                                            "perpendicular",
                                            "link, ball and ball",
                                            "link, hinge and ball",
                                            "link, hinge and hinge",
                                            "node"};

// Sign in axes along (x) and across the joint's axis, turned into the picture.
std::string turned(Point at, math::Vec3 axis, const Camera& camera, std::string_view sign) {
  const Point origin = camera.at(math::Vec3()), end = camera.at(axis);
  const double angle = std::atan2(end.y - origin.y, end.x - origin.x) * 57.295779513;
  return fmt::format("<g transform=\"translate({:.1f} {:.1f})rotate({:.1f})\">{}</g>", at.x, at.y, angle, sign);
}

std::string placed(Point at, std::string_view sign) {
  return fmt::format("<g transform=\"translate({:.1f} {:.1f})\">{}</g>", at.x, at.y, sign);
}

}  // namespace

std::string_view joint_word(JointType type) noexcept {
  return kJointWords[static_cast<std::size_t>(type)];
}

std::string joint_sign(JointType type, math::Vec3 point, math::Vec3 axis, const Camera& camera) {
  const Point at = camera.at(point);
  const bool is_across = std::fabs(camera.facing(axis)) > kAcross;
  switch (type) {
    case JointType::revolute:
      // a pin seen from its end, or from its side
      if (is_across) return placed(at, "<circle r=\"6\"/><circle class=\"point\" r=\"1.6\"/>");
      return turned(at, axis, camera, "<rect x=\"-8\" y=\"-4\" width=\"16\" height=\"8\"/><path d=\"M-13 0H13\"/>");
    case JointType::prismatic:
      if (is_across) return placed(at, "<rect x=\"-6\" y=\"-6\" width=\"12\" height=\"12\"/><circle r=\"2.5\"/>");
      return turned(
          at, axis, camera,
          "<rect x=\"-9\" y=\"-5\" width=\"18\" height=\"10\"/><path d=\"M-16 0H16M-12 -3L-16 0L-12 3M12 -3L16 "
          "0L12 3\"/>");
    case JointType::cylindrical:
      if (is_across) return placed(at, "<circle r=\"6\"/><circle r=\"2.5\"/>");
      return turned(at, axis, camera,
                    "<rect x=\"-9\" y=\"-5\" width=\"18\" height=\"10\" rx=\"5\"/><path d=\"M-16 0H16M-12 -3L-16 0L-12 "
                    "3M12 -3L16 0L12 3\"/>");
    case JointType::spherical:
    case JointType::spherical_spherical:
      return placed(at, "<circle r=\"6\"/><path d=\"M-8 3A8.5 8.5 0 0 0 8 3\"/><circle class=\"point\" r=\"3\"/>");
    case JointType::fixed:
      return placed(at, "<rect x=\"-5\" y=\"-5\" width=\"10\" height=\"10\"/><path d=\"M-5 -5L5 5M-5 5L5 -5\"/>");
    case JointType::universal:
      return placed(at, "<circle r=\"6.5\"/><path d=\"M-6.5 0H6.5M0 -6.5V6.5\"/>");
    case JointType::floating:
      return placed(at, "<circle class=\"loose\" r=\"7\"/>");
    case JointType::in_plane:
      return turned(at, axis, camera, "<path d=\"M0 -12V12\"/><circle r=\"4\"/>");
    case JointType::in_line:
      return turned(at, axis, camera, "<path d=\"M-14 0H14\"/><circle r=\"4\"/>");
    case JointType::perpendicular:
      return placed(at, "<path d=\"M-6 6V-6M-6 6H6M-6 2H-2V6\"/>");
    case JointType::revolute_spherical:
    case JointType::revolute_revolute:
      return placed(at, "<circle r=\"6\"/><circle r=\"2.5\"/>");
    case JointType::node:
      break;
  }
  return "";
}

std::string cylinder_sign(Point a, Point b) {
  const Point c{a.x + 0.62 * (b.x - a.x), a.y + 0.62 * (b.y - a.y)};
  return fmt::format(
      "<path class=\"rod\" d=\"M{0:.1f} {1:.1f}L{2:.1f} {3:.1f}\"/><path class=\"tube\" d=\"M{0:.1f} {1:.1f}L{4:.1f} "
      "{5:.1f}\"/><path class=\"bore\" d=\"M{0:.1f} {1:.1f}L{4:.1f} {5:.1f}\"/>",
      a.x, a.y, b.x, b.y, c.x, c.y);
}

std::string spring_sign(Point a, Point b) {
  diagram::Pen pen;
  pen.spring(a, b, 5);
  return pen.take();
}

std::string support_sign(Point at) {
  return placed(at, "<path d=\"M0 0L-8 11H8ZM-12 11H12M-9 11l-4 5M-3 11l-4 5M3 11l-4 5M9 11l-4 5\"/>");
}

std::string mass_sign(Point at) {
  return placed(at,
                "<circle class=\"light\" r=\"5\"/><path class=\"point\" d=\"M0 0V-5A5 5 0 0 1 5 0ZM0 0V5A5 5 0 0 1 -5 "
                "0Z\"/>");
}

std::string frame_sign(const BodyAtStart& body, const Camera& camera) {
  constexpr std::string_view kAxes[] = {"axis-x", "axis-y", "axis-z"};
  const Point origin = camera.at(body.p_WB);
  std::string out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    math::Vec3 unit(axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0);
    const Point end = camera.at(body.p_WB + (kAxisLength / camera.scale()) * (body.R_WB * unit));
    if (std::hypot(end.x - origin.x, end.y - origin.y) < 2) continue;
    fmt::format_to(std::back_inserter(out), "<path class=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>", kAxes[axis],
                   origin.x, origin.y, end.x, end.y);
  }
  return out;
}

}  // namespace slew::analysis
