// What must hold of the elements in the poses that a scene starts from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "multibody/forces/frame_pair.h"
#include "multibody/forces/validate_elements.h"

namespace slew::multibody {
namespace {

using math::Vec3;

constexpr double kMostRotation = 170 * M_PI / 180;  // rad: the rotation vector jumps at half a turn
// a beam's frames farther off than this are a mistake and no load
constexpr double kMostBending = 0.2;    // of its length
constexpr double kMostBentAngle = 0.5;  // rad
constexpr double kSamePoint = 1e-6;     // m, as joint frames
constexpr double kFlatWheel = 0.1;      // sine of the angle between axle and normal

class StartValidator {
 public:
  StartValidator(const MechanicsDef& m, std::span<const Pose> poses, Problems& problems)
      : m_(m), poses_(poses), problems_(problems) {}

  void run() {
    for (const BushingDef& def : m_.bushings) check_bushing(def);
    for (const BeamDef& def : m_.beams) check_beam(def);
    for (const RopeDef& def : m_.ropes) check_rope(def);
    for (const TyreDummyDef& def : m_.tyre_dummies) check_tyre(def);
  }

 private:
  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }
  [[nodiscard]] const Pose& pose_of(const std::string& body) const {
    return poses_[static_cast<std::size_t>(number_of_(body))];
  }

  // deflection of the frames at the start, without rest length
  [[nodiscard]] Deflection deflection(const ConnectorFrames& def) const {
    LinkMotion link1, link2;
    link1.R = pose_of(def.body1).R;
    link1.p = pose_of(def.body1).p;
    link2.R = pose_of(def.body2).R;
    link2.p = pose_of(def.body2).p;
    FramePair pair;
    pair.R_L1 = math::rotation_xyz(def.orientation1);
    pair.R_L2 = math::rotation_xyz(def.orientation2);
    pair.p_L1 = Vec3(def.point1);
    pair.p_L2 = Vec3(def.point2);
    return deflection_of(pair, link1, link2);
  }

  void check_bushing(const BushingDef& def) {
    const double turn = norm(deflection(def.frames).theta);
    if (turn < kMostRotation) return;
    add(def.name + ".orientation2", fmt::format("the frames are turned by {:.4g} deg at the start", turn * 180 / M_PI),
        "frames turned by less than 170 deg");
  }

  void check_beam(const BeamDef& def) {
    const Deflection d = deflection(def.frames);
    const double off = std::hypot(d.x[0] - def.length, d.x[1], d.x[2]);
    if (off > kMostBending * def.length) {
      add(def.name + ".point2",
          fmt::format("frame 2 is at ({:.4g}, {:.4g}, {:.4g}) m in frame 1 at the start", d.x[0], d.x[1], d.x[2]),
          fmt::format("about ({:.4g}, 0, 0): the beam is {:.4g} m long along x", def.length, def.length));
    }
    if (norm(d.theta) > kMostBentAngle) {
      add(def.name + ".orientation2",
          fmt::format("the frames are turned by {:.4g} deg at the start", norm(d.theta) * 180 / M_PI),
          "frames that are parallel without load");
    }
  }

  void check_rope(const RopeDef& def) {
    for (std::size_t k = 1; k < def.points.size(); ++k) {
      if (norm(place(def, k) - place(def, k - 1)) > kSamePoint) continue;
      add(def.name + ".points", fmt::format("points {} and {} coincide at the start", k, k + 1),
          "neighbours that stay apart");
    }
  }
  [[nodiscard]] Vec3 place(const RopeDef& def, std::size_t k) const {
    const Pose& pose = pose_of(def.bodies[k]);
    return pose.p + pose.R * Vec3(def.points[k]);
  }

  void check_tyre(const TyreDummyDef& def) {
    const Vec3 axle = pose_of(def.relative_to).R * math::rotation_zxz(def.orientation).c[2];
    const Vec3 normal(def.ground_normal);
    if (norm(cross(axle, normal)) > kFlatWheel * norm(normal)) return;
    add(def.name + ".orientation", "the axle stands on the ground at the start",
        "an axle, z of the dummy's frame, along the ground");
  }

  const MechanicsDef& m_;
  BodyNumbers number_of_{m_};
  std::span<const Pose> poses_;
  Problems& problems_;
};

}  // namespace

void check_element_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems) {
  StartValidator(mechanics, poses, problems).run();
}

}  // namespace slew::multibody
