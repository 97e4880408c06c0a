// SPDX-License-Identifier: Apache-2.0
// Definitions are checked, contacts come in the order of the pairs.
#include <gtest/gtest.h>

#include <limits>

#include "support/contact_shapes.h"

namespace slew::contact {
namespace model_test {

using namespace testing;

Problems problems_of(const ContactDef& def) {
  Problems problems;
  validate(def, problems);
  return problems;
}

void expect_problem(const ContactDef& def, const std::string& path, const std::string& part) {
  const Problems problems = problems_of(def);
  ASSERT_FALSE(problems.empty()) << path;
  EXPECT_EQ(problems[0].path, path);
  EXPECT_NE(problems[0].what.find(part), std::string::npos) << problems[0].what;
  EXPECT_FALSE(problems[0].expected.empty());
}

TEST(ContactDefValidation, TakesASoundDefinition) {
  EXPECT_TRUE(problems_of(two_shapes(sphere(1), plane())).empty());
  EXPECT_TRUE(problems_of(two_shapes(box_mesh(1, 2, 3), box(1, 2, 3))).empty());
}

TEST(ContactDefValidation, NamesWrongSizes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double value : {0.0, -1.0, nan}) {
    expect_problem(two_shapes(sphere(value), plane()), "A.radius", "out of range");
    expect_problem(two_shapes(box(1, value, 1), plane()), "A.size", "out of range");
    expect_problem(two_shapes(rounded(ShapeType::cylinder, value, 1), plane()), "A.radius", "out of range");
    expect_problem(two_shapes(rounded(ShapeType::cylinder, 1, value), plane()), "A.length", "out of range");
    expect_problem(two_shapes(rounded(ShapeType::capsule, 1, value), plane()), "A.length", "out of range");
  }
  ShapeDef moved = sphere(1);
  moved.position[1] = nan;
  expect_problem(two_shapes(moved, plane()), "A.position", "not finite");
  moved = sphere(1);
  moved.orientation[2] = nan;
  expect_problem(two_shapes(moved, plane()), "A.orientation", "not finite");
}

TEST(ContactDefValidation, NamesWrongNames) {
  ContactDef def = two_shapes(sphere(1), plane());
  def.shapes[0].frame = "Boddy";
  expect_problem(def, "A.frame", "no frame 'Boddy'");
  def = two_shapes(sphere(1), plane());
  def.pairs[0].shape_b = "C";
  expect_problem(def, "Pair.shape_b", "no shape 'C'");
  def = two_shapes(sphere(1), plane());
  def.shapes[1].name = "A";
  expect_problem(def, "A.name", "second shape");
  def = two_shapes(sphere(1), plane());
  def.pairs[0].name = "";
  expect_problem(def, ".name", "no name");
}

TEST(ContactDefValidation, NamesPairsThatCannotBe) {
  ContactDef def = two_shapes(plane(), sphere(1));
  expect_problem(def, "A.frame", "cannot move");
  def = two_shapes(sphere(1), sphere(1));
  def.shapes[1].frame = "Body";
  expect_problem(def, "Pair.shape_b", "both shapes are fixed to 'Body'");
  def = two_shapes(sphere(1), sphere(1));
  def.frames.push_back({"Rock", true});
  def.shapes[0].frame = "Rock";
  expect_problem(def, "Pair.shape_b", "neither shape can move");
  def = two_shapes(sphere(1), plane());
  def.pairs[0].normal.stiffness = -1;
  expect_problem(def, "Pair.spring_constant", "out of range");
  def = two_shapes(sphere(1), plane());
  def.pairs[0].friction = FrictionLawDef{.stiffness = 0};
  expect_problem(def, "Pair.surface_stiffness", "out of range");
}

TEST(ContactDefValidation, NamesWhatIsWrongWithAGround) {
  ShapeDef mesh = box_mesh(1, 2, 3);
  mesh.type = ShapeType::triangle_mesh;
  EXPECT_TRUE(problems_of(two_shapes(sphere(1), mesh)).empty());
  expect_problem(two_shapes(mesh, sphere(1)), "A.frame", "cannot move");
  ContactDef without_pair = two_shapes(mesh, sphere(1));
  without_pair.pairs.clear();  // for sensors
  EXPECT_TRUE(problems_of(without_pair).empty());
  mesh.mesh.triangles.pop_back();  // open ones are surfaces as well
  EXPECT_TRUE(problems_of(two_shapes(sphere(1), mesh)).empty());
  std::swap(mesh.mesh.triangles[0][0], mesh.mesh.triangles[0][1]);
  expect_problem(two_shapes(sphere(1), mesh), "B.mesh", "turn differently");
  mesh.mesh = {};
  expect_problem(two_shapes(sphere(1), mesh), "B.mesh", "no surface");

  ShapeDef field = flat_field(3, 4, 1);
  EXPECT_TRUE(problems_of(two_shapes(sphere(1), field)).empty());
  const auto refused = [&](auto change, const std::string& part) {
    ShapeDef wrong = field;
    change(wrong.height_field);
    expect_problem(two_shapes(sphere(1), wrong), "B.height_field", part);
  };
  refused([](HeightFieldDef& f) { f.columns = 1; }, "no surface");
  refused([](HeightFieldDef& f) { f.heights.pop_back(); }, "it has 11 heights");
  refused([](HeightFieldDef& f) { f.spacing_x = 0; }, "spacing of 0 m");
  refused([](HeightFieldDef& f) { f.spacing_y = -1; }, "spacing of -1 m");
  refused([](HeightFieldDef& f) { f.heights[5] = std::numeric_limits<double>::quiet_NaN(); }, "height 5 is not finite");
}

TEST(ContactDefValidation, NamesWhatIsWrongWithAConvexMesh) {
  const ShapeDef sound = box_mesh(1, 2, 3);
  const auto refused = [](const ShapeDef& shape, const std::string& part) {
    expect_problem(two_shapes(shape, box(1, 1, 1)), "A.mesh", part);
  };
  ShapeDef mesh = sound;
  mesh.mesh.triangles.clear();
  refused(mesh, "no surface");
  mesh = sound;
  mesh.mesh.vertices[3][1] = std::numeric_limits<double>::infinity();
  refused(mesh, "vertex 3 is not finite");
  mesh = sound;
  mesh.mesh.triangles[5][2] = 8;
  refused(mesh, "triangle 5 has a vertex that does not exist");
  mesh = sound;
  mesh.mesh.triangles.pop_back();
  refused(mesh, "not closed: triangle");
  mesh = sound;
  std::swap(mesh.mesh.triangles[4][0], mesh.mesh.triangles[4][1]);
  refused(mesh, "turn differently");
  mesh = sound;
  for (auto& triangle : mesh.mesh.triangles) std::swap(triangle[0], triangle[1]);
  refused(mesh, "inside out");
  mesh = sound;
  mesh.mesh.vertices[7] = {0.1, 0.1, 0.1};  // a corner pushed in
  refused(mesh, "not convex");
  mesh = sound;
  mesh.mesh.vertices[1] = mesh.mesh.vertices[0];
  refused(mesh, "no area");
}

TEST(ContactDefValidation, RefusesATriangleMeshThatIsInsideOut) {
  const auto turn = [](MeshDef& mesh) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  };
  const auto add = [](MeshDef mesh, const MeshDef& other, double shift) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Triple& v : other.vertices) mesh.vertices.push_back({v[0] + shift, v[1], v[2]});
    for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return mesh;
  };
  const MeshDef block = box_mesh(1, 2, 3).mesh;
  MeshDef inverted = block, room = box_mesh(0.5, 1, 1).mesh, sheet = block;
  turn(inverted);
  turn(room);
  sheet.triangles.pop_back();
  EXPECT_FALSE(find_touched_fault(block));
  EXPECT_FALSE(find_touched_fault(sheet));
  turn(sheet);
  EXPECT_FALSE(find_touched_fault(sheet));  // an open sheet has no inside
  EXPECT_FALSE(find_touched_fault(add(block, block, 5)));
  EXPECT_FALSE(find_touched_fault(add(block, room, 0)));  // a hollow block
  ShapeDef shape = box_mesh(1, 2, 3);
  shape.type = ShapeType::triangle_mesh;
  shape.mesh = inverted;
  expect_problem(two_shapes(shape, box(1, 1, 1)), "A.mesh", "it is inside out");
  shape.mesh = add(block, inverted, 5);
  expect_problem(two_shapes(shape, box(1, 1, 1)), "A.mesh", "its part with triangle 12 is inside out");
}

TEST(FindContacts, ComeInTheOrderOfThePairsWithTheShapesInTheirPlaces) {
  ContactDef def;
  def.frames = {{"Ground", true}, {"First", false}, {"Second", false}};
  ShapeDef floor = plane(), first = sphere(0.5), second = sphere(0.5);
  floor.name = "Floor";
  floor.frame = "Ground";
  floor.position = {0, 0, -1};
  first.name = "Ball";
  first.frame = "First";
  first.position = {0, 0, 0.25};
  second.name = "OtherBall";
  second.frame = "Second";
  def.shapes = {floor, first, second};
  const NormalLawDef law{.stiffness = 1e6};
  def.pairs = {{"Second_Floor", "OtherBall", "Floor", law, {}},
               {"First_Second", "Ball", "OtherBall", law, FrictionLawDef{}},
               {"First_Floor", "Ball", "Floor", law, {}}};
  ASSERT_TRUE(problems_of(def).empty());
  const ContactModel model = build(def);
  ContactSet set(model);
  const Pose poses[] = {{}, {.p_WF = {0, 0, -0.85}}, {.p_WF = {0.9, 0, -0.6}}};
  find_contacts(model, poses, set);
  ASSERT_EQ(set.points().size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(set.points()[i].pair, i);
    EXPECT_NEAR(set.points()[i].depth, 0.1, 1e-12);
  }
  EXPECT_FALSE(model.pairs()[0].has_friction);
  EXPECT_TRUE(model.pairs()[1].has_friction);
  EXPECT_EQ(model.frame_of(model.pairs()[1].shape_b), 2u);
  // the next search forgets this one
  const Pose apart[] = {{}, {.p_WF = {0, 0, 5}}, {.p_WF = {9, 0, 5}}};
  find_contacts(model, apart, set);
  EXPECT_TRUE(set.points().empty());
}

}  // namespace model_test
}  // namespace slew::contact
