// SPDX-License-Identifier: Apache-2.0
// Bodies whose inertia comes from a mesh, against the formulas of the solids; what encloses no solid is refused.
#include "scene/mesh_inertia.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

#include "math/rotation.h"
#include "scene_text.h"
#include "support/contact_shapes.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace mesh_inertia_test {

using contact::MeshDef;
using contact::testing::append;
using contact::testing::prism;
using math::Mat3;
using math::Vec3;

// positions pass single precision inside assimp, which limits the accuracy of a size
constexpr double kSingle = 1e-6;

std::string stl_text(const MeshDef& mesh) {
  std::string out = "solid part\n";
  for (const auto& t : mesh.triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const auto v : t) {
      const Triple& p = mesh.vertices[v];
      out += fmt::format("vertex {:.9g} {:.9g} {:.9g}\n", p[0], p[1], p[2]);
    }
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid part\n";
}

MeshDef box(double x, double y, double z) {
  return contact::testing::box_mesh(x, y, z).mesh;
}

void turn_inside_out(MeshDef& mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
}

// octahedron refined `levels` times on a sphere about the origin
MeshDef ball(double r, int levels) {
  MeshDef mesh;
  mesh.vertices = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> halves;
    const auto half = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] =
          halves.insert({{std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(mesh.vertices.size())});
      if (is_new) {
        const Vec3 sum = Vec3(mesh.vertices[a]) + Vec3(mesh.vertices[b]);
        mesh.vertices.push_back((sum * (r / norm(sum))).array());
      }
      return at->second;
    };
    MeshDef finer;
    for (const auto& t : mesh.triangles) {
      const std::uint32_t a = half(t[0], t[1]), b = half(t[1], t[2]), c = half(t[2], t[0]);
      for (const auto& part : {std::array{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}}) {
        finer.triangles.push_back(part);
      }
    }
    mesh.triangles = finer.triangles;
  }
  return mesh;
}

struct Solid {
  double mass = 0;  // kg
  Vec3 centre;      // m, body frame
  Mat3 inertia;     // kg m2 about the centre, body frame
};

Solid box_solid(double m, double x, double y, double z) {
  return {m, {}, Mat3::diagonal(m / 12 * (y * y + z * z), m / 12 * (x * x + z * z), m / 12 * (x * x + y * y))};
}

class FromMesh : public ::testing::Test {
 protected:
  std::string write(const MeshDef& mesh, const std::string& name = "part.stl") const {
    return folder_.write(name, stl_text(mesh));
  }
  // A scene of one body on a hinge, with these keys beside `inertia: from_mesh`.
  [[nodiscard]] Scene load(const std::string& keys) const {
    return load_file(folder_.write("scene.yaml", "bodies:\n  Part: {inertia: from_mesh, " + keys +
                                                     "}\njoints:\n  Free: {type: floating, body2: Part}\n"));
  }
  [[nodiscard]] std::string refusal(const std::string& keys) const {
    try {
      (void)load(keys);
    } catch (const LoadError& error) {
      std::string text = error.what();
      const std::string prefix = folder_.path() + "/";
      for (std::size_t at = 0; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
      return text;
    }
    return "accepted";
  }
  static void expect_solid(const Scene& scene, const Solid& solid, double tolerance = kSingle) {
    const multibody::BodyDef& body = scene.mechanics.bodies.at(0);
    EXPECT_NEAR(body.mass, solid.mass, tolerance * solid.mass);
    const double trace = solid.inertia(0, 0) + solid.inertia(1, 1) + solid.inertia(2, 2);
    EXPECT_LT(norm(Vec3(body.center_of_mass) - solid.centre), tolerance * (norm(solid.centre) + 1));
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(body.inertia[static_cast<std::size_t>(i)], solid.inertia(i, i), tolerance * trace) << i;
    }
    EXPECT_NEAR(body.products[0], solid.inertia(0, 1), tolerance * trace);
    EXPECT_NEAR(body.products[1], solid.inertia(0, 2), tolerance * trace);
    EXPECT_NEAR(body.products[2], solid.inertia(1, 2), tolerance * trace);
    EXPECT_EQ(body.inertia_about, multibody::InertiaPoint::center_of_mass);
  }
  TemporaryFolder folder_;
};

TEST_F(FromMesh, ABoxHasItsFormulas) {
  write(box(1, 2, 3));
  const Solid solid = box_solid(6 * 7850, 1, 2, 3);
  const Scene scene = load("mesh: part.stl, mesh_unit: 1 m, mesh_up: y, density: 7850 kg/m3");
  expect_solid(scene, solid);
  ASSERT_EQ(scene.solid_inertias.size(), 1u);
  EXPECT_EQ(scene.solid_inertias[0].body, "Part");
  EXPECT_NEAR(scene.solid_inertias[0].volume, 6, 6 * kSingle);
  EXPECT_EQ(scene.solid_inertias[0].density, 7850);
}

TEST_F(FromMesh, AMassInThePlaceOfTheDensityIsSpreadEvenly) {
  write(box(1, 2, 3));
  const Scene scene = load("mesh: part.stl, mesh_unit: 1 m, mesh_up: y, mass: 500 kg");
  EXPECT_EQ(scene.mechanics.bodies[0].mass, 500);
  expect_solid(scene, box_solid(500, 1, 2, 3));
  EXPECT_NEAR(scene.solid_inertias[0].density, 500 / 6.0, 1e-4);
}

TEST_F(FromMesh, TheUnitScalesLengthsAndTheUpAxisTurns) {
  write(box(1000, 2000, 3000));
  expect_solid(load("mesh: part.stl, mesh_unit: 1 mm, mesh_up: y, density: 7850"), box_solid(6 * 7850, 1, 2, 3));
  // z of the file becomes y of the body, y of the file -z
  expect_solid(load("mesh: part.stl, mesh_unit: 1 mm, mesh_up: z, density: 7850"), box_solid(6 * 7850, 1, 3, 2));
  expect_solid(load("mesh: part.stl, mesh_unit: 1 mm, mesh_up: z, body_up: z, density: 7850"),
               box_solid(6 * 7850, 1, 2, 3));
  expect_solid(load("mesh: part.stl, mesh_unit: 2 inch, mesh_up: y, density: 1"),
               {6e9 * std::pow(0.0508, 3), {}, box_solid(6e9 * std::pow(0.0508, 3), 50.8, 101.6, 152.4).inertia});
}

// regular n-gon: A = n/2 r^2 sin(2 pi/n), J/A = r^2 (2 + cos(2 pi/n))/6
TEST_F(FromMesh, AFineCylinderHasTheNumbersOfItsPrism) {
  const std::uint32_t n = 96;
  const double r = 0.4, h = 1.5, density = 2700;
  write(prism(n, r, h));
  const double m = density * h * n / 2 * r * r * std::sin(2 * M_PI / n);
  const double J = m * r * r / 6 * (2 + std::cos(2 * M_PI / n)), across = J / 2 + m * h * h / 12;
  const Scene scene = load("mesh: part.stl, mesh_unit: 1 m, mesh_up: y, density: 2700");
  expect_solid(scene, {m, {}, Mat3::diagonal(across, across, J)});
  // and within the prism's gap of (2 pi/n)^2/6 those of the cylinder
  EXPECT_NEAR(scene.mechanics.bodies[0].mass, density * M_PI * r * r * h, 1e-3 * m);
}

// the polyhedron inside of the sphere lacks its share of volume and, twice as much of it, of inertia
TEST_F(FromMesh, AFineBallComesCloseToTheFormulasFromBelow) {
  const double r = 0.3, density = 1000;
  write(ball(r, 5));
  const double m = density * 4 / 3 * M_PI * r * r * r, J = 0.4 * m * r * r;
  const multibody::BodyDef body = load("mesh: part.stl, mesh_unit: 1 m, mesh_up: y, density: 1000").mechanics.bodies[0];
  EXPECT_LT(body.mass, m);
  EXPECT_NEAR(body.mass, m, 2e-3 * m);
  for (const double moment : body.inertia) {
    EXPECT_LT(moment, J);
    EXPECT_NEAR(moment, J, 4e-3 * J);
  }
  for (const double product : body.products) EXPECT_NEAR(product, 0, kSingle * J);
  EXPECT_LT(norm(Vec3(body.center_of_mass)), kSingle * r);
}

TEST_F(FromMesh, AHollowBoxLacksItsHole) {
  MeshDef mesh = box(2, 2, 2), hole = box(1, 1.5, 1);
  turn_inside_out(hole);
  append(mesh, hole);
  write(mesh);
  const Solid outside = box_solid(8000, 2, 2, 2), inside = box_solid(1500, 1, 1.5, 1);
  expect_solid(load("mesh: part.stl, mesh_unit: 1 m, mesh_up: y, density: 1000"),
               {6500, {}, outside.inertia - inside.inertia});
}

// c = p + R c_M, I = R I_M R^T, about the centre of mass wherever it is
TEST_F(FromMesh, AMeshThatIsMovedAndTurnedTakesItsSolidAlong) {
  write(box(1, 2, 3));
  const Mat3 R = math::rotation_zxz({0.3, 0.7, -1.1});
  const Solid at_origin = box_solid(6000, 1, 2, 3);
  const Scene scene = load(
      "mesh: part.stl, mesh_unit: 1 m, mesh_up: y, density: 1000, mesh_position: [0.5, -0.25, 2],"
      " mesh_orientation: [0.3 rad, 0.7 rad, -1.1 rad]");
  expect_solid(scene, {6000, {0.5, -0.25, 2}, R * at_origin.inertia * transpose(R)});
}

// the centre is at (0.5, 1, 1.5) then; the moments about the body's origin are those of the corner, m (y^2 + z^2)/3
TEST_F(FromMesh, OfABoxInItsCornerFollowTheParallelAxes) {
  write(box(1, 2, 3));
  const multibody::BodyDef body =
      load("mesh: part.stl, mesh_unit: 1 m, mesh_up: y, density: 1000, mesh_position: [0.5, 1, 1.5]")
          .mechanics.bodies[0];
  const Vec3 c(body.center_of_mass);
  const double m = 6000;
  EXPECT_NEAR(body.inertia[0] + body.mass * (c.y() * c.y() + c.z() * c.z()), m / 3 * (4 + 9), kSingle * m);
  EXPECT_NEAR(body.inertia[1] + body.mass * (c.x() * c.x() + c.z() * c.z()), m / 3 * (1 + 9), kSingle * m);
  EXPECT_NEAR(body.inertia[2] + body.mass * (c.x() * c.x() + c.y() * c.y()), m / 3 * (1 + 4), kSingle * m);
  // products about the corner: -m/4 of the edges' products
  EXPECT_NEAR(body.products[0] - body.mass * c.x() * c.y(), -m / 4 * 2, kSingle * m);
  EXPECT_NEAR(body.products[1] - body.mass * c.x() * c.z(), -m / 4 * 3, kSingle * m);
  EXPECT_NEAR(body.products[2] - body.mass * c.y() * c.z(), -m / 4 * 6, kSingle * m);
}

// nodes and recordings get numbers: they need no mesh
TEST_F(FromMesh, TheExpandedTextHoldsTheNumbersToTheLastBit) {
  write(prism(24, 0.4, 1.5));
  const Scene scene = load("mesh: part.stl, mesh_unit: 1 m, mesh_up: z, density: 2700, mesh_orientation: [1, 1, 1]");
  const Scene again = load_text(scene.expanded_text, "test");
  const multibody::BodyDef &body = scene.mechanics.bodies[0], &other = again.mechanics.bodies[0];
  EXPECT_EQ(other.mass, body.mass);
  EXPECT_EQ(other.center_of_mass, body.center_of_mass);
  EXPECT_EQ(other.inertia, body.inertia);
  EXPECT_EQ(other.products, body.products);
  EXPECT_EQ(again.expanded_text, scene.expanded_text);
  EXPECT_EQ(scene.expanded_text.find("part.stl"), std::string::npos);
}

TEST_F(FromMesh, AnOverrideChangesTheDensity) {
  write(box(1, 2, 3));
  const std::string path =
      folder_.write("scene.yaml",
                    "bodies:\n  Part: {inertia: from_mesh, mesh: part.stl, mesh_unit: 1 m, mesh_up: y, density: 7850}\n"
                    "joints:\n  Free: {type: floating, body2: Part}\n");
  expect_solid(load_file(path, {"Part.density=1 g/cm3"}), box_solid(6000, 1, 2, 3));
}

TEST_F(FromMesh, WhatEnclosesNoSolidIsRefusedWithTheReason) {
  const std::string keys = "mesh_unit: 1 m, mesh_up: y, density: 7850, mesh: part.stl";
  MeshDef open = box(1, 2, 3);
  open.triangles.pop_back();
  write(open);
  EXPECT_NE(refusal(keys).find("Part.mesh: 'part.stl' encloses no solid: it is not closed: triangle "),
            std::string::npos)
      << refusal(keys);
  MeshDef inside_out = box(1, 2, 3);
  turn_inside_out(inside_out);
  write(inside_out);
  EXPECT_NE(refusal(keys).find("encloses no solid: it is inside out; expected triangles"), std::string::npos);
  MeshDef not_finite = box(1, 2, 3);
  not_finite.vertices[3][1] = std::nan("");
  write(not_finite);
  EXPECT_NE(refusal(keys).find("encloses no solid: vertex "), std::string::npos) << refusal(keys);
  EXPECT_NE(refusal(keys).find("is not finite"), std::string::npos) << refusal(keys);
}

TEST_F(FromMesh, AnOpenMeshIsTakenAsASheetOfAStatedThickness) {
  MeshDef open = box(1, 2, 3);
  open.triangles.resize(10);  // without the last face
  write(open);
  const std::string keys = "mesh_unit: 1 m, mesh_up: y, density: 7850, mesh: part.stl";
  EXPECT_NE(refusal(keys).find("; shell_thickness takes the surface as a sheet"), std::string::npos) << refusal(keys);
  double area = 0;
  for (const auto& t : open.triangles) {
    const Vec3 a(open.vertices[t[0]]), b(open.vertices[t[1]]), c(open.vertices[t[2]]);
    area += norm(cross(b - a, c - a)) / 2;
  }
  EXPECT_NEAR(load(keys + ", shell_thickness: 4 mm").mechanics.bodies.at(0).mass, area * 0.004 * 7850, kSingle * 1000);
}

TEST_F(FromMesh, AFileInAnotherUnitIsRefusedOrNamed) {
  const auto keys = [](const char* unit, const char* weight) {
    return std::string("mesh: part.stl, mesh_up: y, mesh_unit: ") + unit + ", " + weight;
  };
  // a bracket of 126 mm in millimetres, read in metres: 2e6 m3
  write(box(126, 126, 126));
  EXPECT_NE(refusal(keys("1 m", "density: 7850")).find("Part.mesh_unit: the mesh is 126 x 126 x 126 m, 2e+06 m3, "),
            std::string::npos)
      << refusal(keys("1 m", "density: 7850"));
  EXPECT_EQ(refusal(keys("1 mm", "density: 7850")), "accepted");
  // by the mass that is given: 15.7 kg in 2000 m3
  write(box(10, 10, 20));
  EXPECT_NE(refusal(keys("1 m", "mass: 15.7")).find("at 0.00785 kg/m3"), std::string::npos);
  // by size and mass: a pin of 50 mm
  EXPECT_EQ(load(keys("1 m", "density: 7850")).warnings.size(), 1U);
  EXPECT_TRUE(load(keys("1 mm", "density: 7850")).warnings.empty());
  // metres read in millimetres
  write(box(0.5, 0.5, 0.9));
  EXPECT_EQ(load(keys("1 mm", "density: 7850")).warnings.size(), 1U);
  EXPECT_TRUE(load(keys("1 m", "density: 7850")).warnings.empty());
}

TEST_F(FromMesh, TheMeshIsAFileInTheScenesFolder) {
  const std::string keys = "mesh_unit: 1 m, mesh_up: y, density: 7850, mesh: ";
  EXPECT_NE(refusal(keys + "none.stl").find("scene.yaml:2:79: Part.mesh: 'none.stl' cannot be read"), std::string::npos)
      << refusal(keys + "none.stl");
  EXPECT_NE(refusal(keys + "../part.stl").find("Part.mesh: '../part.stl' lies outside of the scene's folder"),
            std::string::npos);
  EXPECT_NE(refusal(keys + "/etc/passwd").find("lies outside of the scene's folder"), std::string::npos);
  EXPECT_NE(refusal(keys + "scene.yaml").find("unknown ending"), std::string::npos);
  EXPECT_NE(refusal(keys + ".").find("is not a regular file"), std::string::npos);
  EXPECT_NE(problems_of("bodies:\n  Part: {inertia: from_mesh, " + keys + "part.stl}\n")
                .find("test:2:79: Part.mesh: a scene without a folder cannot name a file; expected mass, "
                      "center_of_mass and inertia"),
            std::string::npos);
}

TEST_F(FromMesh, ValuesFromTheMeshAreNotRequired) {
  write(box(1, 2, 3));
  const std::string keys = "mesh: part.stl, mesh_unit: 1 m, mesh_up: y";
  EXPECT_EQ(refusal(keys),
            "scene.yaml:2:3: Part: neither density nor mass is given; expected one of them, for the "
            "solid in the mesh");
  EXPECT_EQ(refusal(keys + ", density: 1, mass: 2"),
            "scene.yaml:2:86: Part.mass: density and mass are both given; expected one of them");
  for (const char* key : {"center_of_mass: [0, 0, 0]", "products: [0, 0, 0]", "inertia_about: body_origin"}) {
    EXPECT_NE(refusal(keys + ", density: 1, " + key)
                  .find("follows from the mesh; expected no such key beside inertia: from_mesh"),
              std::string::npos);
  }
  EXPECT_EQ(refusal(keys + ", denisty: 1, mass: 2"),
            "scene.yaml:2:74: Part.denisty: unknown key; did you mean 'density'?");
  EXPECT_EQ(refusal("mesh: part.stl, mesh_up: y, mass: 1"),
            "scene.yaml:2:3: Part: the key 'mesh_unit' is missing; expected a length such as '1.5 m', or a bare "
            "number in m");
  EXPECT_EQ(refusal("mesh: part.stl, mesh_unit: 1 m, mass: 1"),
            "scene.yaml:2:3: Part: the key 'mesh_up' is missing; expected y or z");
}

// a mesh without `inertia: from_mesh` is a slip that must not pass
TEST_F(FromMesh, AMeshBesideGivenInertiaIsAnUnknownKey) {
  EXPECT_EQ(
      problems_of("bodies:\n  Part: {mass: 1, inertia: [1, 1, 1], mesh: part.stl}\n"
                  "joints:\n  Free: {type: floating, body2: Part}\n"),
      "test:2:39: Part.mesh: unknown key; expected type, relative_to, position, orientation, mass, center_of_mass, "
      "inertia, products or inertia_about");
}

}  // namespace mesh_inertia_test
}  // namespace slew::scene
