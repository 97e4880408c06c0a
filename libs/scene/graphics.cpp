// SPDX-License-Identifier: Apache-2.0
#include "scene/graphics.h"

#include <cmath>
#include <optional>
#include <string_view>

#include "contact/mesh_file/glb_file.h"
#include "scene/expand.h"
#include "scene/scene.h"

namespace slew::scene {
namespace {

using enum Dimension;

constexpr std::string_view kFileAxes[] = {"y", "z"};

constexpr Field kGraphicFields[] = {
    field<&GraphicDef::body>(
        "body",
        {.presence = Presence::required, .reference = "body", .doc = "body, which is then drawn without its shapes"}),
    field<&GraphicDef::file>(
        "file", {.presence = Presence::required,
                 .doc = "mesh in the scene's folder, also an open one: .stl, .obj, .dae, .3ds, .glb or .fbx"}),
    field<&GraphicDef::unit>("unit", {.dimension = length,
                                      .range = kPositive,
                                      .presence = Presence::required,
                                      .doc = "length of a unit of the file, as 1 mm"}),
    field<&GraphicDef::up>("up", {.presence = Presence::required,
                                  .choices = kFileAxes,
                                  .doc = "upward axis of the file, which becomes y of the mesh"}),
    field<&GraphicDef::position>("position", {.dimension = length, .doc = "mesh's origin in the body's frame"}),
    field<&GraphicDef::orientation>("orientation",
                                    {.dimension = angle, .doc = "mesh's axes in the body: Euler rotations z, x', z''"}),
    field<&GraphicDef::color>("color",
                              {.range = kFraction, .doc = "red, green, blue; without it the colours of the file"}),
};

}  // namespace

std::span<const Field> graphic_fields() noexcept {
  return kGraphicFields;
}

std::string graphic_as_glb(const GraphicDef& graphic, const std::string& path, Problems& problems) {
  const std::optional<contact::Rgb> color =
      std::isfinite(graphic.color[0]) ? std::optional(graphic.color) : std::nullopt;
  return contact::read_as_glb(graphic.name,
                              {.path = path, .unit = graphic.unit, .up_in_file = graphic.up, .up = contact::UpAxis::y},
                              color, problems);
}

void check_graphics(const LoadContext& load_context, const Scene& scene, Problems& problems) {
  for (const GraphicDef& graphic : scene.graphics) {
    if (graphic.body.find('.') != std::string::npos) {
      problems.push_back({graphic.name + ".body", "'" + graphic.body + "' is a node of a flexible body",
                          "a body: no mesh bends with its nodes", ""});
    }
    if (!load_context.has_folder) continue;
    if (const auto refusal = load_context.refusal_of(graphic.file)) {
      problems.push_back({graphic.name + ".file", refusal->what, refusal->expected, refusal->suggestion});
    } else if (const auto fault = contact::find_mesh_fault(load_context.path_of(graphic.file))) {
      problems.push_back({graphic.name + ".file", fault->what, fault->expected, ""});
    }
  }
}

}  // namespace slew::scene
