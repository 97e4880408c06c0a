// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh_inertia.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "contact/mass_properties.h"
#include "contact/mesh_check.h"
#include "math/rotation.h"
#include "scene/assets.h"
#include "scene/solid_inertia.h"

namespace slew::scene {
namespace {

using enum Dimension;
using math::Mat3;
using math::Vec3;

constexpr std::string_view kUpAxes[] = {"y", "z"};

constexpr Field kFields[] = {
    field<&MeshInertiaDef::mesh>(
        "mesh",
        {.presence = Presence::required,
         .doc = "closed mesh in the scene's folder, of one or several solids: .stl, .obj, .dae, .3ds, .glb or .fbx"}),
    field<&MeshInertiaDef::mesh_unit>("mesh_unit", {.dimension = length,
                                                    .range = kPositive,
                                                    .presence = Presence::required,
                                                    .doc = "length of a unit of the file, as 1 mm"}),
    field<&MeshInertiaDef::mesh_up>(
        "mesh_up",
        {.presence = Presence::required, .choices = kUpAxes, .doc = "upward axis of the file, which becomes body_up"}),
    field<&MeshInertiaDef::body_up>(
        "body_up",
        {.choices = kUpAxes, .doc = "upward axis of the body; if not mesh_up, the mesh is turned about x by 90 deg"}),
    field<&MeshInertiaDef::mesh_position>("mesh_position",
                                          {.dimension = length, .doc = "the mesh's origin, body frame"}),
    field<&MeshInertiaDef::mesh_orientation>(
        "mesh_orientation", {.dimension = angle, .doc = "the mesh's axes: Euler rotations z, x', z''"}),
    field<&MeshInertiaDef::density>("density",
                                    {.dimension = density, .range = kPositive, .doc = "density; either this or mass"}),
    field<&MeshInertiaDef::mass>("mass", {.dimension = mass,
                                          .range = kPositive,
                                          .change = Change::live,
                                          .doc = "mass, spread evenly; either this or density"}),
    field<&MeshInertiaDef::shell_thickness>(
        "shell_thickness",
        {.dimension = length,
         .range = kNotNegative,
         .doc = "thickness of a sheet on the surface, which may be open, instead of the solid; 0: the solid"}),
};

class MeshBodyReader {
 public:
  MeshBodyReader(const Node::Entry& element, const LoadContext& load_context, const ReadContext& context)
      : element_(element), load_context_(load_context), context_(context) {}

  void read(std::span<const Field> body_fields, multibody::BodyDef& body, Scene& scene) {
    const std::size_t problems = context_.report.size();
    read_beside_solid(element_, body_fields, body, kFields, &def_, {}, context_);
    refuse_derived_keys(element_, "the mesh", kFromMesh, context_);
    check_density_or_mass(element_.value, element_.key, element_.mark, "the solid in the mesh", context_);
    if (context_.report.size() > problems) return;
    const std::optional<contact::MeshDef> mesh = read_solid();
    if (!mesh) return;
    const contact::MassProperties solid = def_.shell_thickness > 0
                                              ? contact::shell_properties(*mesh, def_.shell_thickness, 1)
                                              : contact::mass_properties(*mesh, 1);
    const double density_of_solid = std::isfinite(def_.density) ? def_.density : def_.mass / solid.volume;
    if (!is_plausible(*mesh, solid, density_of_solid, scene)) return;
    put(solid, density_of_solid, body);
    scene.solid_inertias.push_back({element_.key, def_.mesh, "", solid.volume, density_of_solid});
  }

 private:
  // The mesh in the body's unit and up axis; nothing after a reported problem.
  std::optional<contact::MeshDef> read_solid() {
    const Mark mark = element_.value.find("mesh")->value.mark;
    if (!load_context_.has_folder) {
      report_problem(mark, "mesh",
                     {"a scene without a folder cannot name a file", "mass, center_of_mass and inertia", ""});
      return std::nullopt;
    }
    if (auto refusal = load_context_.refusal_of(def_.mesh)) {
      report_problem(mark, "mesh", std::move(*refusal));
      return std::nullopt;
    }
    const std::filesystem::path path = load_context_.path_of(def_.mesh);
    std::error_code error;
    if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
      report_problem(mark, "mesh", {"'" + path.string() + "' is not a regular file", "a mesh file", ""});
      return std::nullopt;
    }
    Problems problems;
    contact::MeshDef mesh = contact::read_mesh(
        element_.key, {.path = path, .unit = def_.mesh_unit, .up_in_file = def_.mesh_up, .up = def_.body_up}, problems);
    for (const Problem& problem : problems) report_problem(mark, "mesh", {problem.what, problem.expected, ""});
    if (!problems.empty()) return std::nullopt;
    if (const auto fault =
            def_.shell_thickness > 0 ? contact::find_number_fault(mesh) : contact::find_solid_fault(mesh)) {
      report_problem(mark, "mesh",
                     {fmt::format("'{}' encloses no solid: {}", def_.mesh, fault->what),
                      fault->expected + "; shell_thickness takes the surface as a sheet", ""});
      return std::nullopt;
    }
    return mesh;
  }

  // Detects a wrong unit of the file: refuses sizes and masses that no machine has.
  bool is_plausible(const contact::MeshDef& mesh, const contact::MassProperties& solid, double density_of_solid,
                    Scene& scene) {
    const auto [low, high] = contact::extent_of(mesh);
    const double size = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    const double mass = solid.volume * density_of_solid;
    const std::string found =
        fmt::format("the mesh is {:.3g} x {:.3g} x {:.3g} m, {:.4g} m3, {:.4g} kg at {:.4g} kg/m3", high[0] - low[0],
                    high[1] - low[1], high[2] - low[2], solid.volume, mass, density_of_solid);
    const Mark mark = element_.value.find("mesh_unit")->value.mark;
    const Plausibility plausibility = plausibility_of(size, solid.volume, density_of_solid);
    if (plausibility == Plausibility::likely) return true;
    if (plausibility == Plausibility::impossible) {
      report_problem(mark, "mesh_unit", {found, "the length of one unit of the file, such as 1 mm or 1 m", ""});
      return false;
    }
    scene.warnings.push_back(context_.report
                                 .at(mark, element_.key + ".mesh_unit",
                                     {found, "the length of one unit of the file, such as 1 mm or 1 m", ""})
                                 .text());
    return true;
  }

  // (1)
  void put(const contact::MassProperties& solid, double density_of_solid, multibody::BodyDef& body) const {
    const Mat3 R_BM = math::rotation_zxz(def_.mesh_orientation);
    const Mat3 I_B = R_BM * (solid.inertia * density_of_solid) * transpose(R_BM);
    body.mass = std::isfinite(def_.mass) ? def_.mass : solid.volume * density_of_solid;
    put_inertia(Vec3(def_.mesh_position) + R_BM * solid.centre, I_B, body);
  }

  void report_problem(const Mark& mark, std::string_view key, ValueProblem problem) {
    context_.report.add(mark, fmt::format("{}.{}", element_.key, key), std::move(problem));
  }

  const Node::Entry& element_;
  const LoadContext& load_context_;
  const ReadContext& context_;
  MeshInertiaDef def_;
};

}  // namespace

std::span<const Field> mesh_inertia_fields() noexcept {
  return kFields;
}

bool takes_from_mesh(const Node& body) {
  return has_inertia_word(body, kFromMesh);
}

void read_mesh_body(const Node::Entry& element, std::span<const Field> body_fields, const LoadContext& load_context,
                    multibody::BodyDef& body, Scene& scene, const ReadContext& context) {
  MeshBodyReader(element, load_context, context).read(body_fields, body, scene);
}

}  // namespace slew::scene
