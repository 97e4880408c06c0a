// SPDX-License-Identifier: Apache-2.0
// Descriptions of flexible bodies: one body in a YAML file of its own, read as strictly as a scene.
//
//   model: truck_crane
//   prefix: beam_hard
//   materials: {Steel: {youngs_modulus: 200 GPa, density: 7700 kg/m3}}
//   sections: {Box: {shape: hollow_rectangle, width: 300 mm, height: 300 mm, wall: 2 mm}}
//   line: {start: [0, 0, 0], end: [-6.5 m, 0, 0], nodes: 20}
// `include` merges the file over others, as in a scene. All keys: docs/howto/flexible-model.md.
#pragma once

#include <string>

#include "flex/fe_model.h"
#include "flex/flexible_body.h"
#include "scene/scene.h"

namespace slew::scene {

struct FlexibleModel {
  flex::FlexibleBodyDef def;
  flex::FeModel model;
  flex::ReductionDef reduction;
};

// Reads the file, its included files and named matrices, and builds the model. overrides:
// "line.nodes=40", "materials.Steel.youngs_modulus=20 GPa". Throws LoadError, nothing else.
[[nodiscard]] FlexibleModel load_flexible_file(const std::string& path, const Overrides& overrides = {});

// The same from memory; `name` replaces the file in messages, and no other file is allowed.
[[nodiscard]] FlexibleModel load_flexible_text(std::string text, const std::string& name,
                                               const Overrides& overrides = {});

}  // namespace slew::scene
