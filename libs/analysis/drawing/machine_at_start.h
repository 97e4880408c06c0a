// SPDX-License-Identifier: Apache-2.0
// Poses of a machine where its scene begins.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "math/rotation.h"
#include "math/vector3.h"
#include "scene/scene.h"

namespace slew::analysis {

struct BodyAtStart {
  math::Vec3 p_WB;  // m, origin in Ground
  math::Mat3 R_WB;
};

class MachineAtStart {
 public:
  // Ground first, then the bodies of the scene.
  explicit MachineAtStart(const scene::Scene& scene);

  // A point of a body in Ground [m]; none: it is no body of the scene, but a node of a flexible one.
  [[nodiscard]] std::optional<math::Vec3> point(const std::string& body, const Triple& position) const;
  [[nodiscard]] std::optional<std::size_t> index(const std::string& body) const;
  [[nodiscard]] const BodyAtStart& body(std::size_t index) const noexcept { return bodies_[index]; }

 private:
  std::vector<BodyAtStart> bodies_;
  std::map<std::string, std::size_t> index_;
};

}  // namespace slew::analysis
