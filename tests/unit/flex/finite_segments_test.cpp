// SPDX-License-Identifier: Apache-2.0
// Lumps and connectors of finite segments against the finite element model that they are made of.
#include "flex/finite_segments.h"

#include <gtest/gtest.h>

#include "flex/decompositions.h"
#include "tests/support/flex_beams.h"
#include "tests/support/reference_algebra.h"

namespace slew::flex {
namespace finite_segments_test {

using namespace testing;
using math::Mat3;
using math::Vec3;

// three sections, elements of different lengths, along no axis
BeamDef tapered() {
  BeamDef def;
  def.sections = {{.shape = SectionShape::solid_rectangle, .width = 0.06, .height = 0.1},
                  {.shape = SectionShape::solid_rectangle, .width = 0.05, .height = 0.08},
                  {.shape = SectionShape::solid_rectangle, .width = 0.03, .height = 0.06}};
  def.materials = {steel()};
  const auto at = [](double s) { return Triple{1 + 0.6 * s, 0.1, 0.8 * s}; };
  def.nodes = {{7, at(0)}, {3, at(0.4)}, {9, at(0.9)}, {1, at(1.3)}, {2, at(2)}};
  def.elements = {{7, 3, 0, 0, {}}, {9, 3, 1, 0, {}}, {9, 1, 1, 0, {}}, {1, 2, 2, 0, {}}};
  return def;
}

FiniteSegments cut(const BeamDef& def, int segments) {
  return finite_segments(reduce(build_beam(def), with_modes(2)), segments);
}

TEST(FiniteSegments, HaveTheMassOfTheBeam) {
  const RigidMass exact = rigid_mass(build_beam(tapered()));
  for (const int segments : {1, 3, 20}) {
    double mass = 0;
    Vec3 first;
    Mat3 second;
    for (const SegmentLump& lump : cut(tapered(), segments).lumps) {
      mass += lump.mass;
      first += lump.centre * lump.mass;
      second = second + second_moment_of(lump.inertia) + outer(lump.centre, lump.centre) * lump.mass;
    }
    EXPECT_NEAR(mass, exact.mass, 1e-12 * exact.mass);
    EXPECT_LT(norm(first - exact.first), 1e-12 * norm(exact.first));
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(second(i, j), exact.second(i, j), 1e-9 * exact.second(0, 0));
    }
  }
}

// eq. 29 with the signs of the errata
TEST(FiniteSegments, ConnectorsOfAUniformBeamHaveItsStiffness) {
  const BeamDef def = cantilever_b01(3);
  const BeamElement e = build_beam(cantilever_b01(5)).elements[0];
  const double l = 0.4, E = e.youngs_modulus, EI = E * e.section.second_moment_z;
  for (const SegmentConnector& c : cut(def, 5).connectors) {
    EXPECT_NEAR(c.length, l, 1e-15);
    const auto expect = [](double found, double wanted) { EXPECT_NEAR(found, wanted, 1e-11 * std::fabs(wanted)); };
    expect(c.K.k11, E * e.section.area / l);
    expect(c.K.k44, e.shear_modulus * e.section.torsion_constant / l);
    expect(c.K.k22, 12 * EI / (l * l * l * (1 + e.phi_y)));
    expect(c.K.k26, -6 * EI / (l * l * (1 + e.phi_y)));
    expect(c.K.k66, (4 + e.phi_y) * EI / (l * (1 + e.phi_y)));
    expect(c.K.k33, c.K.k22);
    expect(c.K.k35, -c.K.k26);
    expect(c.K.k55, c.K.k66);
  }
}

// one connector over all of a tapered beam: the stiffness that the finite elements have between their ends
TEST(FiniteSegments, OneConnectorIsTheBeamBetweenItsEnds) {
  const FeModel model = at_nodes(build_beam(tapered()));
  const FiniteSegments segments = cut(tapered(), 1);
  ASSERT_EQ(segments.connectors.size(), 1U);
  const SegmentConnector& c = segments.connectors[0];
  // node 7, the first, held: compliance of the last
  const Eigen::Index n = model.K.rows();
  const SparseMatrix free = model.K.bottomRightCorner(n - 6, n - 6);
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(n - 6, 6);
  unit.bottomRows(6).setIdentity();
  const Eigen::MatrixXd moved = solve_positive(free, unit, "beam held at its first node");
  using Matrix = slew::testing::Dense<double>;
  Matrix compliance(6, 6), T(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) compliance(i, j) = moved(n - 12 + i, j);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T(i, j) = T(3 + i, 3 + j) = c.axes(i, j);
  }
  const Matrix K = slew::testing::inverse(T.transposed() * compliance * T);
  Matrix found = Matrix::diagonal(Matrix::column({c.K.k11, c.K.k22, c.K.k33, c.K.k44, c.K.k55, c.K.k66}));
  found(1, 5) = found(5, 1) = c.K.k26;
  found(2, 4) = found(4, 2) = c.K.k35;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) EXPECT_NEAR(found(i, j), K(i, j), 1e-9 * std::sqrt(K(i, i) * K(j, j))) << i << j;
  }
}

TEST(FiniteSegments, LeaveTheRootInTheOrderOfTheBeam) {
  ReductionDef middle = with_modes(2);
  middle.modes.clamped_nodes = {9};
  middle.modes.interface_nodes = {7, 2};
  const FiniteSegments segments = finite_segments(reduce(build_beam(tapered()), middle), 4);
  EXPECT_EQ(segments.root, 2U);
  std::vector<bool> is_carried(5);
  is_carried[segments.root] = true;
  for (const SegmentConnector& c : segments.connectors) {
    EXPECT_TRUE(is_carried[c.near]);
    is_carried[c.far] = true;
    const Vec3 along = segments.lumps[c.far].station - segments.lumps[c.near].station;
    EXPECT_NEAR(dot(along, c.axes.c[0]), c.length, 1e-12);
    EXPECT_LT(norm(cross(c.axes.c[0], c.axes.c[1]) - c.axes.c[2]), 1e-12);
  }
  EXPECT_EQ(segments.lump_of, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(FiniteSegments, RefuseWhatTheyAreNotMadeFor) {
  BeamDef bent = tapered();
  bent.nodes[2].position[1] += 0.01;
  EXPECT_NE(error_of([&] { (void)cut(bent, 3); }).find("is off the line"), std::string::npos);
  BeamDef turned = tapered();
  turned.elements[2].y_axis = {0, 1, 0.2};
  EXPECT_NE(error_of([&] { (void)cut(turned, 3); }).find("is turned about the beam"), std::string::npos);
  BeamDef branched = tapered();
  branched.nodes.push_back({20, {3, 3, 3}});
  branched.elements.push_back({9, 20, 0, 0, {}});
  EXPECT_NE(error_of([&] { (void)cut(branched, 3); }).find("branches"), std::string::npos);
  Reduction imported = reduce(build_beam(tapered()), with_modes(2));
  imported.elements.clear();
  EXPECT_NE(error_of([&] { (void)finite_segments(imported, 3); }).find("not of imported matrices"), std::string::npos);
}

}  // namespace finite_segments_test
}  // namespace slew::flex
