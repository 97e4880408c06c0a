// SPDX-License-Identifier: Apache-2.0
// Descriptions of flexible bodies: every key reaches its place, and every fault is reported with line and column.
#include "scene/flexible_model.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "build_paths.h"
#include "flex/field_tables.h"
#include "flex/flexible_files.h"
#include "flex/imported_model.h"
#include "scene/field_reader.h"
#include "temporary_folder.h"
#include "tests/support/flex_beams.h"

namespace slew::scene {
namespace flexible_model_test {

const std::string kNames = "model: crane\nprefix: boom_1\n";
const std::string kSteel = "materials: {Steel: {youngs_modulus: 200 GPa, density: 7700 kg/m3}}\n";
const std::string kBox = "sections: {Box: {shape: hollow_rectangle, width: 0.3, height: 0.3, wall: 3 mm}}\n";
const std::string kLine = "line: {start: [0, 0, 0], end: [2 m, 0, 0], nodes: 4}\n";
const std::string kBeam = kNames + kSteel + kBox + kLine;

std::string problems_of(const std::string& text, const Overrides& overrides = {}) {
  try {
    (void)load_flexible_text(text, "f", overrides);
  } catch (const LoadError& error) {
    return error.what();
  }
  return {};
}

flex::FlexibleBodyDef read(const std::string& text, const Overrides& overrides = {}) {
  EXPECT_EQ(problems_of(text, overrides), "");
  return load_flexible_text(text, "f", overrides).def;
}

void expect_same(const flex::SparseMatrix& a, const flex::SparseMatrix& b) {
  ASSERT_EQ(a.rows(), b.rows());
  EXPECT_EQ((a - b).norm(), 0);
}

TEST(FlexibleModel, ALineOfNodesIsTheBeamOfItsDefs) {
  const FlexibleModel read = load_flexible_file(SLEWRING_SOURCE_DIR "/scenes/beams/jib_boom.yaml");
  flex::BeamDef def = flex::testing::jib_boom();
  def.sections[0].shear_factor_y = def.sections[0].shear_factor_z = 0.44;
  const flex::FeModel model = flex::build_beam(def);
  expect_same(read.model.K, model.K);
  expect_same(read.model.M, model.M);
  EXPECT_EQ(read.model.name, "truck_crane");
  EXPECT_EQ(read.def.prefix, "beam_hard");
  EXPECT_EQ(read.reduction.modes.attachment, flex::Attachment::clamped);
  EXPECT_EQ(read.reduction.modes.fixed_interface_modes, 6);
}

TEST(FlexibleModel, AnIncludedDescriptionIsLaidUnder) {
  const FlexibleModel hard = load_flexible_file(SLEWRING_SOURCE_DIR "/scenes/beams/jib_boom.yaml");
  const FlexibleModel soft = load_flexible_file(SLEWRING_SOURCE_DIR "/scenes/beams/jib_boom_soft.yaml");
  EXPECT_EQ(soft.def.prefix, "beam_soft");
  EXPECT_LT((soft.model.M - hard.model.M).norm(), 1e-14 * hard.model.M.norm());
  EXPECT_LT((10 * soft.model.K - hard.model.K).norm(), 1e-12 * hard.model.K.norm());
}

TEST(FlexibleModel, MaterialsAndRootValuesAreRead) {
  const flex::FlexibleBodyDef def =
      read(kNames + "description: a beam\nmaterials:\n  Steel: {youngs_modulus: 200 GPa, density: 7.7 t/m3}\n" +
           "  Odd: {youngs_modulus: 1e9, poisson_ratio: 0.4, shear_modulus: 300 MPa, density: 1000}\n" + kBox + kLine +
           "material: Odd\nsection: Box\ny_axis: [0, 0, 1]\nmass_matrix: lumped\nrotary_inertia: with\n");
  EXPECT_EQ(def.description, "a beam");
  ASSERT_EQ(def.materials.size(), 2u);
  EXPECT_EQ(def.materials[0].material.youngs_modulus, 2e11);
  EXPECT_EQ(def.materials[0].material.poisson_ratio, 0.3);
  EXPECT_EQ(def.materials[0].material.density, 7700);
  EXPECT_EQ(def.materials[1].material.poisson_ratio, 0.4);
  EXPECT_EQ(def.materials[1].material.shear_modulus, 3e8);
  EXPECT_EQ(def.material, "Odd");
  EXPECT_EQ(def.section, "Box");
  EXPECT_EQ(def.y_axis, (Triple{0, 0, 1}));
  EXPECT_EQ(def.mass_matrix, flex::MassKind::lumped);
  EXPECT_EQ(read(kBeam + "rotary_inertia: none\n").rotary_inertia, flex::RotaryInertia::none);
}

TEST(FlexibleModel, EveryShapeOfSectionIsRead) {
  const flex::FlexibleBodyDef def = read(
      kNames + kSteel + kLine + "section: Box\nsections:\n" +
      "  Box: {shape: hollow_rectangle, width: 200 mm, height: 300 mm, wall: 4 mm, flange: 6 mm, shear_factor: "
      "0.44}\n" +
      "  I: {shape: i_section, width: 150 mm, height: 300 mm, wall: 7 mm, flange: 10 mm, shear: none}\n" +
      "  Pipe: {shape: tube, diameter: 100 mm, wall: 5 mm, shear_factor_y: 0.5, shear_factor_z: 0.6}\n" +
      "  Bar: {shape: solid_rectangle, width: 20 mm, height: 30 mm}\n  Rod: {shape: solid_circle, diameter: 1 cm}\n" +
      "  Rail: {shape: given, area: 50 cm2, second_moment_y: 1e-5, second_moment_z: 2000 cm4, torsion_constant: 1e-7,\n"
      "         stress_points: [{y: 10 mm, z: -20 mm}, {y: 0, z: 5 mm, torsion_modulus: 3 cm3}]}\n");
  ASSERT_EQ(def.sections.size(), 6u);
  const flex::SectionDef& box = def.sections[0].section;
  EXPECT_EQ(box.shape, flex::SectionShape::hollow_rectangle);
  EXPECT_EQ(box.width, 0.2);
  EXPECT_EQ(box.height, 0.3);
  EXPECT_EQ(box.wall, 0.004);
  EXPECT_EQ(box.flange, 0.006);
  EXPECT_EQ(def.sections[0].shear_factor, 0.44);
  EXPECT_EQ(def.sections[1].section.shape, flex::SectionShape::i_section);
  EXPECT_EQ(def.sections[1].section.flange, 0.01);
  EXPECT_EQ(def.sections[1].section.shear, flex::Shear::none);
  EXPECT_EQ(def.sections[2].section.shape, flex::SectionShape::tube);
  EXPECT_EQ(def.sections[2].section.diameter, 0.1);
  EXPECT_EQ(def.sections[2].shear_factor_y, 0.5);
  EXPECT_EQ(def.sections[2].shear_factor_z, 0.6);
  EXPECT_EQ(def.sections[3].section.shape, flex::SectionShape::solid_rectangle);
  EXPECT_EQ(def.sections[4].section.shape, flex::SectionShape::solid_circle);
  const flex::NamedSection& rail = def.sections[5];
  EXPECT_EQ(rail.section.shape, flex::SectionShape::given);
  EXPECT_NEAR(rail.section.area, 5e-3, 1e-18);
  EXPECT_EQ(rail.section.second_moment_y, 1e-5);
  EXPECT_NEAR(rail.section.second_moment_z, 2e-5, 1e-20);
  EXPECT_EQ(rail.section.torsion_constant, 1e-7);
  ASSERT_EQ(rail.stress_points.size(), 2u);
  EXPECT_EQ(rail.stress_points[0].z, -0.02);
  EXPECT_EQ(rail.stress_points[0].torsion_modulus, 0);
  EXPECT_NEAR(rail.stress_points[1].torsion_modulus, 3e-6, 1e-20);
}

TEST(FlexibleModel, ShearFactorsOfASectionReachTheBeam) {
  const auto factor = [](const std::string& keys) {
    const FlexibleModel read = load_flexible_text(
        kNames + kSteel + kLine + "sections: {Box: {shape: tube, diameter: 0.1, wall: 0.01" + keys + "}}\n", "f");
    return std::pair(read.model.elements[0].section.shear_factor_y, read.model.elements[0].section.shear_factor_z);
  };
  EXPECT_EQ(factor(", shear_factor: 0.44"), std::pair(0.44, 0.44));
  EXPECT_EQ(factor(", shear_factor_y: 0.3").first, 0.3);
  EXPECT_EQ(factor(", shear_factor_y: 0.3").second, factor("").second) << "the other is Cowper's";
  EXPECT_EQ(factor(", shear: none"), std::pair(0.0, 0.0));
}

TEST(FlexibleModel, NodesAndElementsAreRead) {
  const FlexibleModel read = load_flexible_text(
      kNames +
          "materials: {Steel: {youngs_modulus: 2e11, density: 7700}, Light: {youngs_modulus: 7e10, density: 2700}}\n"
          "sections: {Root: {shape: solid_circle, diameter: 0.2}, Tip: {shape: solid_circle, diameter: 0.1}}\n"
          "material: Steel\nnodes:\n  10: [0, 29 mm, 0]\n  20: [1 m, 29 mm, 0]\n  5: [2 m, 29 mm, 0]\n"
          "  7: [2 m, 29 mm, 1 m]\nelements:\n"
          "  - {through: [10, 20, 5], section: Root}\n"
          "  - {through: [5, 7], section: Tip, material: Light, y_axis: [1, 0, 0]}\n",
      "f");
  ASSERT_EQ(read.model.nodes.size(), 4u);
  EXPECT_EQ(read.model.nodes[0].id, 10);
  EXPECT_EQ(read.model.nodes[3].id, 7);
  EXPECT_EQ(read.model.nodes[2].position.y(), 0.029);
  ASSERT_EQ(read.model.elements.size(), 3u);
  EXPECT_EQ(read.model.elements[1].density, 7700);
  EXPECT_EQ(read.model.elements[2].density, 2700);
  EXPECT_NEAR(read.model.elements[2].section.area, M_PI * 0.01 / 4, 1e-12);
  EXPECT_EQ(read.model.elements[2].axes(0, 1), 1) << "y axis along x";
}

TEST(FlexibleModel, TheReductionIsRead) {
  const FlexibleModel read = load_flexible_text(
      kBeam +
          "reduction: {attachment: clamped, clamped_nodes: [2], interface_nodes: [1, 4], fixed_interface_modes: 3,"
          " stiffening: straight_beam, eigen_method: dense}\n",
      "f");
  EXPECT_EQ(read.reduction.modes.clamped_nodes, std::vector<int>{2});
  EXPECT_EQ(read.reduction.modes.interface_nodes, (std::vector<int>{1, 4}));
  EXPECT_EQ(read.reduction.modes.fixed_interface_modes, 3);
  EXPECT_EQ(read.reduction.modes.method, flex::EigenMethod::dense);
  EXPECT_EQ(read.reduction.stiffening, flex::GeometricStiffening::straight_beam);
  const FlexibleModel free = load_flexible_text(kBeam + "reduction: {attachment: free}\n", "f");
  EXPECT_EQ(free.reduction.modes.attachment, flex::Attachment::free);
  EXPECT_EQ(free.reduction.modes.fixed_interface_modes, 10);
}

TEST(FlexibleModel, MatricesAreImportedFromTheFolderOfTheDescription) {
  const TemporaryFolder folder;
  const flex::FeModel model = flex::testing::at_nodes(flex::build_beam(flex::testing::jib_boom(5)));
  flex::export_model(model, {"boom", folder.path() + "/M.mtx", folder.path() + "/K.mtx", folder.path() + "/nodes.txt"});
  const std::string path = folder.write(
      "boom.yaml", kNames +
                       "matrices: {mass: M.mtx, stiffness: K.mtx, nodes: nodes.txt}\n"
                       "reduction: {clamped_nodes: [1], interface_nodes: [5], fixed_interface_modes: 4}\n");
  const FlexibleModel read = load_flexible_file(path);
  expect_same(read.model.M, model.M);
  EXPECT_EQ(read.model.name, "crane");
  EXPECT_FALSE(read.model.is_beam());
  // faults of the files are reported at the key, those of the nodes at their own
  (void)folder.write("M.mtx", "nothing\n");
  try {
    (void)load_flexible_file(path);
    ADD_FAILURE();
  } catch (const LoadError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(path + ":3:11: matrices: " + folder.path() + "/M.mtx:1: ")) << text;
  }
}

TEST(FlexibleModel, SettingsReachEveryValue) {
  const flex::FlexibleBodyDef def = read(kBeam, {"prefix=soft", "materials.Steel.youngs_modulus=20 GPa", "line.nodes=7",
                                                 "line.start=[0, 1 mm, 0]", "reduction.fixed_interface_modes=2"});
  EXPECT_EQ(def.prefix, "soft");
  EXPECT_EQ(def.materials[0].material.youngs_modulus, 2e10);
  EXPECT_EQ(def.line.nodes, 7);
  EXPECT_EQ(def.line.start[1], 0.001);
  EXPECT_EQ(def.reduction.fixed_interface_modes, 2);
}

struct Refused {
  std::string text;
  const char* problem;
};

TEST(FlexibleModel, FaultsAreReportedWithPlaceExpectationAndSuggestion) {
  const std::string root = kNames + kSteel + kBox;  // four lines
  const Refused refused[] = {
      {"prefix: b\n" + kSteel + kBox + kLine, "f:1:1: the key 'model' is missing; expected a text"},
      {kBeam + "prefx: b\n", "f:6:1: prefx: unknown key; did you mean 'prefix'?"},
      {kBeam + "prefix: b\n", "f:6:1: prefix: is there twice (first in line 2); expected one of them"},
      {kNames + "materials: {Steel: {youngs_modulus: 200 mm, density: 1}}\n" + kBox + kLine,
       "f:3:37: materials.Steel.youngs_modulus: '200 mm' is a length; expected a pressure such as '250 bar', or a bare "
       "number in Pa"},
      {kNames + "materials: {Steel: {youngs_modulus: 1, poisson_ratio: 0.5, density: 1}}\n" + kBox + kLine,
       "f:3:55: materials.Steel.poisson_ratio: '0.5' is out of range; expected more than -1 and less than 0.5"},
      {kNames + "materials: [Steel]\n" + kBox + kLine,
       "f:3:12: materials: is a list; expected a map of materials by name"},
      {kNames + "materials: {St.2: {youngs_modulus: 1, density: 1}}\n" + kBox + kLine,
       "f:3:13: materials.St.2: is not a name; expected letters, digits, _ and -"},
      {kNames + kSteel + "sections: {Box: {width: 1}}\n" + kLine,
       "f:4:12: sections.Box: the key 'shape' is missing; expected given, hollow_rectangle, i_section, tube, "
       "solid_rectangle, solid_circle"},
      {kNames + kSteel + "sections: {Box: {shape: tubes}}\n" + kLine,
       "f:4:25: sections.Box.shape: is 'tubes'; expected given, hollow_rectangle, i_section, tube, solid_rectangle, "
       "solid_circle; did you mean 'tube'?"},
      {kNames + kSteel + "sections: {Box: {shape: tube, diameter: 1, wall: 0.1, width: 1}}\n" + kLine,
       "f:4:55: sections.Box.width: unknown key; expected shape, diameter, wall, shear, shear_factor, shear_factor_y "
       "or "
       "shear_factor_z"},
      {kNames + kSteel + "sections: {Box: {shape: tube, diameter: 1, wall: 0.6}}\n" + kLine,
       "f:4:50: sections.Box.wall: 0.6 m fills the inside; expected less than 0.5 m, half of the diameter"},
      {kNames + kSteel +
           "sections: {Box: {shape: solid_circle, diameter: 1, shear_factor: 0.9, shear_factor_z: 0.8}}\n" + kLine,
       "f:4:66: sections.Box.shear_factor: it is given beside one of y or z; expected shear_factor, or shear_factor_y "
       "and _z"},
      {kNames + kSteel + "sections: {Box: {shape: solid_circle, diameter: 1, shear: none, shear_factor: 0.9}}\n" +
           kLine,
       "f:4:59: sections.Box.shear: none has no shear factors; expected timoshenko, or no shear factors"},
      {root + "line: {start: [0, 0, 0], end: [0, 0, 0], nodes: 3}\n",
       "f:5:31: line.end: it is at the start; expected another place"},
      {root + "line: {start: [0, 0, 0], end: [1, 0, 0], nodes: 1}\n",
       "f:5:49: line.nodes: '1' is out of range; expected 2 to 10000"},
      {root + "line: {start: [0, 0, 0], end: [1, 0, 0]}\n",
       "f:5:1: line: the key 'nodes' is missing; expected an integer"},
      {root, "f:1:1: the geometry of the body is missing; expected one of line, nodes and matrices"},
      {kBeam + "nodes: {1: [0, 0, 0], 2: [1, 0, 0]}\n",
       "f:1:1: the body is described more than once; expected one of line, nodes and matrices"},
      {root + "nodes: {1: [0, 0, 0]}\n", "f:5:8: nodes: 1 nodes are too few; expected two or more"},
      {root + "nodes: {a: [0, 0, 0], 2: [1, 0, 0]}\n",
       "f:5:9: nodes.a: is not a node's number; expected a whole number of at least 0"},
      {root + "nodes: {1: [0, 0, 0], 1: [1, 0, 0]}\n",
       "f:5:23: nodes.1: is there twice (first in line 5); expected one of them"},
      {root + "nodes: {1: [0, 0, 0], 2: [1, 0]}\n",
       "f:5:26: nodes.2: is a list of 2; expected a list of three, [x, y, z]"},
      {kBeam + "elements: [{through: [1]}]\n", "f:6:22: elements[0].through: 1 ids are too few; expected two or more"},
      {kBeam + "elements: [{through: [1, 2.5]}]\n",
       "f:6:22: elements[0].through: 2.5 is no node's number; expected whole numbers"},
      {kBeam + "elements: [{through: [1, 2, 3, 4, 9]}]\n",
       "f:6:12: elements[0]: there is no node 9; expected a node of the list"},
      {kBeam + "elements: [{through: [1, 2, 3]}]\n",
       "f:6:11: elements: nothing joins node 4 to node 1; expected elements that make one piece"},
      {kBeam + "elements: [{through: [1, 2, 3, 4], section: Bax}]\n",
       "f:6:45: elements[0].section: no section 'Bax'; did you mean 'Box'?"},
      {kBeam + "elements: [through]\n", "f:6:12: elements[0]: is 'through'; expected a map such as {through: [1, 2]}"},
      {kBeam + "elements: [{through: [1, 2, 3, 4], y_axis: [1, 0, 0]}]\n",
       "f:6:44: elements[0].y_axis: it lies along the element; expected a vector across it"},
      {kBeam + "y_axis: [0, 0, 0]\n", "f:6:9: y_axis: it has no direction; expected a vector"},
      {kBeam + "material: Stel\n", "f:6:11: material: no material 'Stel'; did you mean 'Steel'?"},
      {kNames + kBox + kLine + "materials: {A: {youngs_modulus: 1, density: 1}, B: {youngs_modulus: 1, density: 1}}\n",
       "f:1:1: material: there are 2 materials, and elements that name none; expected the name of one here, "
       "or "
       "one for every element"},
      {kNames + kBox + kLine, "f:1:1: materials: there is none; expected one or more"},
      {kBeam + "mass_matrix: lump\n", "f:6:14: mass_matrix: is 'lump'; expected consistent or lumped"},
      {kBeam + "mass_matrix: lumped\nrotary_inertia: none\n",
       "f:7:17: rotary_inertia: lumped mass without rotary inertia leaves rotations without mass; expected rotary "
       "inertia, or consistent mass"},
      {kBeam + "reduction: {attachment: free, clamped_nodes: [1]}\n",
       "f:6:46: reduction.clamped_nodes: a free body has none; expected no such key, or attachment: clamped"},
      {kBeam + "reduction: {clamped_nodes: [5]}\n",
       "f:6:28: reduction.clamped_nodes: there is no node 5; expected one of the body's 4 nodes, 1 to 4"},
      {kBeam + "reduction: {interface_nodes: [3, 3]}\n",
       "f:6:30: reduction.interface_nodes: node 3 is named twice; expected each once"},
      {kBeam + "reduction: {clamped_nodes: [4]}\n",
       "f:6:28: reduction.clamped_nodes: node 4 is clamped and an interface; expected interfaces that move"},
      {kBeam + "reduction: {fixed_interface_modes: 31}\n",
       "f:6:36: reduction.fixed_interface_modes: 31 is out of range; expected 0 to 30, the freedoms inside"},
      {kBeam + "reduction: {clamped_nodes: [1, 2], fixed_interface_modes: 1, stiffening: straight_beam}\n",
       "f:6:74: reduction.stiffening: it is clamped at several nodes, which keep their distance and cause tension "
       "instead of "
       "shortening; expected one straight chain of beam elements, or none"},
      {kBeam + "reduction: {modes: 3}\n",
       "f:6:13: reduction.modes: unknown key; expected attachment, clamped_nodes, interface_nodes, "
       "fixed_interface_modes, stiffening or eigen_method"},
      {"model: a/b\n" + kBeam.substr(kBeam.find('\n') + 1),
       "f:1:8: model: 'a/b' cannot be part of a file's name; expected letters, digits, _ - ."},
      {kNames + "matrices: {mass: a, stiffness: b}\n",
       "f:3:1: matrices: the key 'nodes' is missing; expected a text\n"
       "f:3:1: matrices: a description without a folder cannot name files"},
  };
  for (const Refused& one : refused) EXPECT_EQ(problems_of(one.text), one.problem) << one.text;
}

TEST(FlexibleModel, FaultsAreReportedAtOnce) {
  const std::string problems = problems_of(
      "model: m\nprefix: p\nmaterials: {S: {youngs_modulus: -1, density: 2 m}}\nsections: {B: {shape: tube, wall: 1}}\n"
      "lines: {nodes: 3}\nreduction: {attachment: glued}\n");
  for (const char* part : {"f:3:33: materials.S.youngs_modulus: '-1' is out of range",
                           "f:3:46: materials.S.density: ", "f:4:12: sections.B: the key 'diameter' is missing",
                           "f:5:1: lines: unknown key; did you mean 'line'?",
                           "f:6:25: reduction.attachment: is 'glued'; expected clamped or free"})
    EXPECT_NE(problems.find(part), std::string::npos) << part << "\nis not in\n" << problems;
}

TEST(FlexibleModel, ABeamBesideMatricesIsRefused) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("b.yaml", kBeam + "matrices: {mass: M, stiffness: K, nodes: N}\nreduction: {stiffening: none}\n");
  try {
    (void)load_flexible_file(path);
    ADD_FAILURE();
  } catch (const LoadError& error) {
    const std::string text = error.what();
    for (const char* part : {":3:1: materials: has no effect beside matrices", ":4:1: sections: ", ":5:1: line: "})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

TEST(FlexibleModel, SettingsThatLeadNowhereAreRefused) {
  EXPECT_EQ(problems_of(kBeam, {"line.nodes"}),
            "--set line.nodes: is not a setting; expected key=value, such as 'line.nodes=40' or "
            "'materials.Steel.youngs_modulus=20GPa'");
  EXPECT_EQ(problems_of(kBeam, {"materials.Stel.density=1"}),
            "--set materials.Stel.density=1: no 'Stel'; did you mean 'Steel'?");
  EXPECT_EQ(problems_of(kBeam, {"lin.nodes=4"}), "--set lin.nodes=4: no 'lin'; did you mean 'line'?");
  EXPECT_EQ(problems_of(kBeam, {"model.name=a"}), "--set model.name=a: 'model' holds no keys");
  EXPECT_EQ(problems_of(kBeam, {"line.nods=4"}), "--set line.nods=4: unknown key; did you mean 'nodes'?");
  EXPECT_EQ(problems_of(kBeam, {"line.nodes=1"}), "--set line.nodes=1: '1' is out of range; expected 2 to 10000");
}

// one description a table, with a hole for a key
struct TableCase {
  std::string before, after, owner;
  std::span<const Field> fields;
};

std::string outside(const Field& field) {
  switch (field.type) {
    case FieldType::number:
      return field.range.min_is_open ? fmt::format("{}", field.range.min) : fmt::format("{}", field.range.min - 1);
    case FieldType::integer:
      return fmt::format("{}", field.range.min - 1);
    case FieldType::choice:
      return "no_such_choice";
    case FieldType::triple:
      return "[1, 2]";
    case FieldType::numbers:
      return "{a: 1}";
    default:
      return "[a]";
  }
}

TEST(FlexibleModel, EveryFieldRefusesWhatItDoesNotTake) {
  std::vector<TableCase> cases = {{"", "", "", flex::body_fields()},
                                  {"materials: {S: {", "}}", "materials.S.", flex::material_fields()},
                                  {"line: {", "}", "line.", flex::line_fields()},
                                  {"elements: [{", "}]", "elements[0].", flex::element_fields()},
                                  {"matrices: {", "}", "matrices.", flex::matrix_file_fields()},
                                  {"reduction: {", "}", "reduction.", flex::reduction_fields()},
                                  {"sections: {S: {shape: given, stress_points: [{", "}]}}",
                                   "sections.S.stress_points[0].", flex::stress_point_fields()}};
  for (const flex::SectionType& type : flex::section_types())
    cases.push_back({fmt::format("sections: {{S: {{shape: {}, ", type.name), "}}", "sections.S.", type.fields});
  for (const TableCase& one : cases) {
    for (const Field& field : one.fields) {
      const bool is_open = field.type == FieldType::number && std::isinf(field.range.min);
      const std::string text =
          fmt::format("{}{}: {}{}\n", one.before, field.key, is_open ? ".nan" : outside(field), one.after);
      const std::string problems = problems_of(text);
      EXPECT_NE(problems.find(fmt::format(": {}{}: ", one.owner, field.key)), std::string::npos) << text << problems;
    }
  }
}

}  // namespace flexible_model_test
}  // namespace slew::scene
