// SPDX-License-Identifier: Apache-2.0
// The machine as Foxglove shows it: frames that move, and shapes that stay in their frames.
//
// Frames: World, with z up against gravity; in it Ground; in Ground each body, and for each cylinder `El/tube` at its
// eye on body 1 and `El/rod` at its eye on body 2, whose z axes point at each other's eye. All motion is in the
// transforms (foxglove.FrameTransforms), so that the shapes are sent once (foxglove.SceneUpdate).
//
// A body has its meshes for the eye (scene/graphics.h), if their files are there; else its contact shapes; without any
// it is a star of lines from the joint that carries it to the points at which joints and forces act and to its centre
// of mass. Bending is not drawn.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/json.h"
#include "gateway/step_snapshot.h"
#include "math/rotation.h"
#include "math/vector3.h"
#include "observer/session_view.h"
#include "scene/scene.h"

namespace slew::gateway {

// Files for clients by name: binary glTF of the scene's graphics.
using Assets = std::map<std::string, std::shared_ptr<const std::string>, std::less<>>;

[[nodiscard]] std::string asset_name(const scene::GraphicDef& graphic);  // "Cab_View.glb"
// The name of an asset in the protocol, and the asset's name in such a one; empty: it is none.
inline constexpr std::string_view kAssetScheme = "package://slewring/";
[[nodiscard]] std::string_view asset_of_uri(std::string_view uri) noexcept;

class MachineFrames {
 public:
  // assets: names of the files that clients can fetch, asset_name() of each graphic whose mesh is there.
  MachineFrames(const scene::Scene& scene, const Assets& assets);

  // Finds the variables of the poses; bodies without them are not shown.
  void find_places(const observer::SessionView& view);
  [[nodiscard]] bool has_frames() const noexcept { return has_frames_; }

  // A foxglove.FrameTransforms as JSON, appended. Bodies whose pose is not finite are left out.
  void encode_transforms(const StepSnapshot& snapshot, std::uint64_t time_ns, std::string& message) const;

  // A foxglove.SceneUpdate as JSON with all shapes. snapshot: gives the length of cylinders whose shortest length the
  // scene does not state.
  [[nodiscard]] std::string scene_update(const StepSnapshot& snapshot, std::uint64_t time_ns) const;

 private:
  struct Pose {
    math::Vec3 p_WB;  // m, in Ground
    math::Quaternion q_WB;
  };
  struct Body {
    std::string name;
    std::array<observer::VariablePlace, 7> pose{};  // position x y z, orientation w x y z
    bool is_found = false;
    Json shapes = Json::object();  // lists of primitives by kind
  };
  struct Cylinder {
    std::string name;
    std::size_t body1 = 0, body2 = 0;  // in bodies_
    math::Vec3 point1, point2;         // m, in their frames
    double shortest = 0;               // m; 0: not stated
  };

  void add_graphics(const scene::Scene& scene, const Assets& assets);
  void add_cylinders(const scene::Scene& scene);
  [[nodiscard]] std::optional<Pose> pose(const Body& body, const StepSnapshot& snapshot) const noexcept;
  void put_cylinder(const Cylinder& cylinder, const StepSnapshot& snapshot, const std::string& time,
                    std::string& message) const;
  void add_cylinder_entities(const Cylinder& cylinder, const StepSnapshot& snapshot, std::uint64_t time_ns,
                             Json& entities) const;

  std::vector<Body> bodies_;  // Ground first
  std::vector<Cylinder> cylinders_;
  math::Quaternion q_WG_;  // orientation of Ground in World
  double size_ = 1;        // m, of the machine
  bool has_frames_ = false;
};

}  // namespace slew::gateway
