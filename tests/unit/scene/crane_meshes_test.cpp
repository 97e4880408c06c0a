// SPDX-License-Identifier: Apache-2.0
// The crane's meshes in scenes/meshes: closed, right side out, convex where they are for contact, and where the crane's
// joints and masses are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "build_paths.h"
#include "contact/mass_properties.h"
#include "contact/mesh_check.h"
#include "contact/mesh_file/mesh_file.h"
#include "scene/scene.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace crane_meshes_test {

namespace fs = std::filesystem;
using contact::MeshDef;
using math::Vec3;

const fs::path kFolder = fs::path(SLEWRING_SOURCE_DIR) / "scenes/meshes";

MeshDef read(const std::string& file) {
  Problems problems;
  MeshDef mesh = contact::read_mesh(
      file, {.path = kFolder / file, .unit = 1, .up_in_file = contact::UpAxis::y, .up = contact::UpAxis::y}, problems);
  EXPECT_TRUE(problems.empty()) << problems[0].what;
  return mesh;
}

std::vector<std::string> mesh_files() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    const std::string ending = entry.path().extension();
    if (ending == ".stl" || ending == ".obj") names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// the pieces that hang together by their vertices
std::vector<MeshDef> pieces_of(const MeshDef& mesh) {
  std::vector<std::uint32_t> first(mesh.vertices.size());
  std::iota(first.begin(), first.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (first[v] != v) v = first[v];
    return v;
  };
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) first[std::max(root(v), root(t[0]))] = std::min(root(v), root(t[0]));
  }
  std::vector<MeshDef> pieces;
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (root(v) != v) continue;
    MeshDef& piece = pieces.emplace_back();
    piece.vertices = mesh.vertices;
    for (const auto& t : mesh.triangles) {
      if (root(t[0]) == v) piece.triangles.push_back(t);
    }
  }
  return pieces;
}

TEST(CraneMeshes, AreClosedAndTheirPiecesRightSideOut) {
  const std::vector<std::string> files = mesh_files();
  EXPECT_GE(files.size(), 20u);
  for (const std::string& file : files) {
    const MeshDef mesh = read(file);
    const auto fault = contact::find_closed_fault(mesh);
    ASSERT_FALSE(fault.has_value()) << file << ": " << fault->what;
    for (const MeshDef& piece : pieces_of(mesh)) {
      const auto fault_of_piece = contact::find_closed_fault(piece);
      EXPECT_FALSE(fault_of_piece.has_value()) << file << ": " << fault_of_piece->what;
    }
  }
}

TEST(CraneMeshes, ForContactAreConvex) {
  int count = 0;
  for (const std::string& file : mesh_files()) {
    if (!file.starts_with("COLL_")) continue;
    ++count;
    const auto fault = contact::find_convex_fault(read(file));
    EXPECT_FALSE(fault.has_value()) << file << ": " << fault->what;
  }
  EXPECT_GE(count, 8);
}

TEST(CraneMeshes, AreSmallTogether) {
  std::uintmax_t bytes = 0;
  for (const std::string& file : mesh_files()) bytes += fs::file_size(kFolder / file);
  EXPECT_LT(bytes, 200'000u);
}

Scene crane() {
  return load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml");
}

std::string file_of(const std::string& body) {
  return body == "Bag" ? "Bag.obj" : body + ".stl";
}

// every point of a joint or cylinder on a body lies in the box around its mesh, or within 5 cm of it
TEST(CraneMeshes, ReachTheJointsOfTheirBodies) {
  const Scene scene = crane();
  int points = 0;
  const auto expect_near = [&](const std::string& element, const std::string& body, const Triple& point) {
    if (body == "Ground") return;
    ++points;
    const MeshDef mesh = read(file_of(body));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto by_axis = [k](const Triple& a, const Triple& b) { return a[k] < b[k]; };
      const auto [low, high] = std::minmax_element(mesh.vertices.begin(), mesh.vertices.end(), by_axis);
      EXPECT_GE(point[k], (*low)[k] - 0.05) << element << " on " << body << ", axis " << k;
      EXPECT_LE(point[k], (*high)[k] + 0.05) << element << " on " << body << ", axis " << k;
    }
  };
  for (const auto& joint : scene.mechanics.joints) {
    expect_near(joint.name, joint.body1, joint.point1);
    expect_near(joint.name, joint.body2, joint.point2);
  }
  for (const auto& force : scene.mechanics.translational_forces) {
    expect_near(force.name, force.body1, force.point1);
    expect_near(force.name, force.body2, force.point2);
  }
  EXPECT_EQ(points, 15);
}

TEST(CraneMeshes, ForContactLieAboutTheMassesOfTheirBodies) {
  const Scene scene = crane();
  for (const auto& body : scene.mechanics.bodies) {
    if (body.name != "Bag" && body.name != "Truck_Hook" && body.name != "Truck_JibBoom") continue;
    const contact::MassProperties solid = contact::mass_properties(read("COLL_" + body.name + ".stl"), 1);
    EXPECT_LT(norm(solid.centre - Vec3(body.center_of_mass)), 0.051) << body.name;
  }
  EXPECT_NEAR(contact::mass_properties(read("COLL_Bag.stl"), 1).volume, 0.8 * 1.0 * 0.8, 1e-6);
  EXPECT_NEAR(contact::mass_properties(read("COLL_Truck_Body.stl"), 1).volume, 7.5 * 0.9 * 2.5, 1e-5);
}

// A = a^2 - b^2, I = (a^4 - b^4)/12 of the hollow square section
TEST(CraneMeshes, OfTheJibBoomIsTheBeamItself) {
  const TemporaryFolder folder;
  fs::copy_file(kFolder / "Truck_JibBoom.stl", folder.path() + "/boom.stl");
  const Scene scene =
      load_file(folder.write("boom.yaml",
                             "bodies:\n  Boom: {inertia: from_mesh, mesh: boom.stl, mesh_unit: 1 m, mesh_up: y,"
                             " density: 7700 kg/m3}\njoints:\n  Free: {type: floating, body2: Boom}\n"));
  const multibody::BodyDef& boom = scene.mechanics.bodies[0];
  constexpr double a = 0.3, b = 0.3 - 2 * 0.002139, length = 6.5, density = 7700;
  const double m = density * length * (a * a - b * b);
  const double I = density * length * (a * a * a * a - b * b * b * b) / 12;
  EXPECT_NEAR(boom.mass, m, 1e-4 * m);
  EXPECT_NEAR(boom.mass, 127.5618, 0.02);  // thesis, appendix 1, fig. 2
  EXPECT_NEAR(boom.inertia[0], 2 * I, 1e-4 * 2 * I);
  EXPECT_NEAR(boom.inertia[1], I + m * length * length / 12, 1e-4 * 450);
  EXPECT_NEAR(boom.inertia[2], I + m * length * length / 12, 1e-4 * 450);
  EXPECT_LT(norm(Vec3(boom.center_of_mass) - Vec3(-3.25, 0.02904, 0.1507)), 1e-5);
}

}  // namespace crane_meshes_test
}  // namespace slew::scene
