// SPDX-License-Identifier: Apache-2.0
// Elements and assembly against the equations of their headers.
#include "flex/beam.h"

#include <gtest/gtest.h>

#include "tests/support/flex_beams.h"

namespace slew::flex {
namespace beam_test {

using namespace testing;
using math::Mat3;
using math::Vec3;

BeamDef oblique() {
  SectionDef section{.shape = SectionShape::hollow_rectangle, .width = 0.1, .height = 0.2, .wall = 0.01};
  BeamDef def = straight(section, steel(), {1.2, 0.9, -0.4}, 2, {0.2, -0.1, 0.3});
  def.y_axis = {0.3, 1, 0.2};
  return def;
}

// thesis eq. 29 as corrected: the far end of a clamped element along x
TEST(BeamElement, FarEndHasTheStiffnessOfEquation29) {
  SectionDef section{.shape = SectionShape::hollow_rectangle, .width = 0.1, .height = 0.2, .wall = 0.01};
  const FeModel model = build_beam(straight(section, steel(), {0.7, 0, 0}, 2));
  const ElementMatrix K = stiffness_of(model.elements[0]);
  const BeamElement& e = model.elements[0];
  const double E = 2.1e11, G = E / 2.6, l = 0.7, EIz = E * e.section.second_moment_z,
               EIy = E * e.section.second_moment_y;
  const double phi_y = 12 * EIz / (e.section.shear_factor_y * G * e.section.area * l * l);
  const double phi_z = 12 * EIy / (e.section.shear_factor_z * G * e.section.area * l * l);
  EXPECT_GT(std::abs(phi_y - phi_z), 0.1 * phi_y);
  const auto expect = [&](int i, int j, double value) { EXPECT_NEAR(K(6 + i, 6 + j), value, 1e-12 * std::abs(value)); };
  expect(0, 0, E * e.section.area / l);
  expect(1, 1, 12 * EIz / (l * l * l * (1 + phi_y)));
  expect(2, 2, 12 * EIy / (l * l * l * (1 + phi_z)));
  expect(3, 3, G * e.section.torsion_constant / l);
  expect(4, 4, (4 + phi_z) * EIy / (l * (1 + phi_z)));
  expect(5, 5, (4 + phi_y) * EIz / (l * (1 + phi_y)));
  expect(1, 5, -6 * EIz / (l * l * (1 + phi_y)));
  expect(2, 4, 6 * EIy / (l * l * (1 + phi_z)));
}

// K is the integral of its strains, those of the internal freedoms included; shear: slope less turn
TEST(BeamElement, StiffnessIsTheEnergyOfTheStrains) {
  const FeModel model = build_beam(oblique());
  const BeamElement& e = model.elements[0];
  const Section& s = e.section;
  const double E = e.youngs_modulus, G = e.shear_modulus;
  ElementMatrix sum = ElementMatrix::Zero();
  for (const double xi : {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)}) {
    const double weight = e.length * (xi == 0.5 ? 8.0 : 5.0) / 18;
    const ElementStrain strain = strain_at(e, xi);
    const ElementField field = field_at(e, xi);
    // local components of slope and turn: per_y moves along -x by rz, per_z along x by ry
    const Matrix3xElement slope = slope_at(e, xi);
    ElementRow gamma_y, gamma_z;
    for (int j = 0; j < kElementFreedoms; ++j) {
      const Vec3 t(slope(0, j), slope(1, j), slope(2, j));
      const Vec3 y(field.per_y(0, j), field.per_y(1, j), field.per_y(2, j));
      const Vec3 z(field.per_z(0, j), field.per_z(1, j), field.per_z(2, j));
      gamma_y(j) = dot(t, e.axes.c[1]) + dot(y, e.axes.c[0]);
      gamma_z(j) = dot(t, e.axes.c[2]) + dot(z, e.axes.c[0]);
    }
    sum += weight * (E * s.area * strain.stretch.transpose() * strain.stretch +
                     G * s.torsion_constant * strain.twist.transpose() * strain.twist +
                     E * s.second_moment_z * strain.bend_z.transpose() * strain.bend_z +
                     E * s.second_moment_y * strain.bend_y.transpose() * strain.bend_y +
                     s.shear_factor_y * G * s.area * gamma_y.transpose() * gamma_y +
                     s.shear_factor_z * G * s.area * gamma_z.transpose() * gamma_z);
  }
  EXPECT_LT((sum - stiffness_of(e)).cwiseAbs().maxCoeff(), 1e-12 * sum.cwiseAbs().maxCoeff());
}

TEST(BeamElement, RigidMotionNeedsNoForceAndMovesEveryPointRigidly) {
  const FeModel model = build_beam(oblique());
  const auto R = rigid_motions(model);
  const Eigen::MatrixXd force = model.K * R;
  EXPECT_LT(force.cwiseAbs().maxCoeff(), 1e-12 * stiffness_of(model.elements[0]).cwiseAbs().maxCoeff());
  const BeamElement& e = model.elements[0];
  for (const double xi : {0.0, 0.3, 1.0}) {
    const ElementField field = field_at(e, xi);
    const double y = 0.04, z = -0.07;
    const Vec3 place = e.start + e.axes * Vec3(xi * e.length, y, z);
    const Eigen::Matrix<double, 3, 6> moved = (field.axis + y * field.per_y + z * field.per_z) * R;
    const Mat3 turning = math::skew(-place);
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        EXPECT_NEAR(moved(a, b), a == b ? 1 : 0, 1e-14);
        EXPECT_NEAR(moved(a, 3 + b), turning(a, b), 1e-14);
      }
    }
  }
}

TEST(BeamElement, SlopeIsTheDerivativeOfTheAxis) {
  const FeModel model = build_beam(oblique());
  const BeamElement& e = model.elements[0];
  const double h = 1e-5;
  for (const double xi : {0.1, 0.5, 0.8}) {
    const Matrix3xElement difference = (field_at(e, xi + h).axis - field_at(e, xi - h).axis) / (2 * h * e.length);
    // without its part along the axis
    const Eigen::Vector3d x(e.axes.c[0].x(), e.axes.c[0].y(), e.axes.c[0].z());
    const Matrix3xElement across = difference - x * (x.transpose() * difference);
    EXPECT_LT((across - slope_at(e, xi)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// closed form for shear-rigid beams: rho A l/420 [156 22l 54 -13l; ...] and rotary rho I/(30 l) [36 3l -36 3l; ...]
TEST(BeamElement, ConsistentMassIsThatOfTheTextbook) {
  SectionDef section{.area = 0.02, .second_moment_y = 3e-5, .second_moment_z = 5e-5, .torsion_constant = 1e-5};
  const FeModel model = build_beam(straight(section, steel(), {0.7, 0, 0}, 2));
  const Eigen::MatrixXd M = model.M;
  const double l = 0.7, m = 7850 * 0.02 * l, r = 7850 * 5e-5 / (30 * l);
  EXPECT_NEAR(M(0, 0), m / 3, 1e-12 * m);
  EXPECT_NEAR(M(0, 6), m / 6, 1e-12 * m);
  EXPECT_NEAR(M(3, 3), 7850 * 8e-5 * l / 3, 1e-14);
  EXPECT_NEAR(M(1, 1), m * 156 / 420 + 36 * r, 1e-12 * m);
  EXPECT_NEAR(M(1, 5), m * 22 * l / 420 + 3 * l * r, 1e-12 * m);
  EXPECT_NEAR(M(1, 7), m * 54 / 420 - 36 * r, 1e-12 * m);
  EXPECT_NEAR(M(1, 11), -m * 13 * l / 420 + 3 * l * r, 1e-12 * m);
  EXPECT_NEAR(M(5, 5), m * 4 * l * l / 420 + 4 * l * l * r, 1e-12 * m);
  EXPECT_NEAR(M(5, 11), -m * 3 * l * l / 420 - l * l * r, 1e-12 * m);
  EXPECT_NEAR(M(2, 4), -(m * 22 * l / 420 + 3 * l * r * 3 / 5), 1e-12 * m);
}

TEST(Beam, LumpedMassCouplesNoNodes) {
  BeamDef def = oblique();
  def.nodes = line_of_nodes({0, 0, 0}, {1.2, 0.9, -0.4}, 5);
  def.mass = MassKind::lumped;
  const FeModel model = build_beam(def);
  for (int j = 0; j < model.M.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(model.M, j); it; ++it) {
      if (it.row() / 3 != j / 3) {
        EXPECT_EQ(it.value(), 0);
      }
    }
  }
  const double area = model.elements[0].section.area, length = std::sqrt(1.2 * 1.2 + 0.81 + 0.16);
  EXPECT_NEAR(rigid_mass(model).mass, 7850 * area * length, 1e-10);
}

TEST(Beam, MixedSectionsAndMaterialsKeepTheirOwn) {
  BeamDef def;
  def.sections = {square(0.1), square(0.05)};
  def.materials = {steel(), {.youngs_modulus = 7e10, .poisson_ratio = 0.33, .density = 2700}};
  def.nodes = {{10, {0, 0, 0}}, {4, {1, 0, 0}}, {7, {1, 2, 0}}};
  def.elements = {{10, 4, 0, 0, {}}, {4, 7, 1, 1, {}}};
  const FeModel model = build_beam(def);
  EXPECT_NEAR(rigid_mass(model).mass, 7850 * 0.01 + 2700 * 0.0025 * 2, 1e-10);
  // along y the default direction y gives nothing: z is taken
  EXPECT_NEAR(dot(model.elements[1].axes.c[1], Vec3(0, 0, 1)), 1, 1e-15);
  EXPECT_EQ(model.elements[1].youngs_modulus, 7e10);
}

TEST(Beam, WrongDefinitionsAreAllNamed) {
  BeamDef def = oblique();
  def.materials[0].youngs_modulus = -1;
  def.materials[0].poisson_ratio = 0.5;
  def.sections[0].wall = 0;
  const std::string text = error_of([&] { (void)build_beam(def); });
  EXPECT_NE(text.find("Beam.materials[0].youngs_modulus: -1 Pa is out of range; expected a number > 0 Pa"), text.npos);
  EXPECT_NE(text.find("Beam.materials[0].poisson_ratio: 0.5 is out of range"), text.npos);
  EXPECT_NE(text.find("Beam.sections[0].wall: 0 m is out of range"), text.npos);
}

TEST(Beam, WrongConnectionsAreNamed) {
  const auto text_with = [](auto change) {
    BeamDef def = oblique();
    def.nodes = line_of_nodes({0, 0, 0}, {2, 0, 0}, 4);
    change(def);
    return error_of([&] { (void)build_beam(def); });
  };
  EXPECT_NE(text_with([](BeamDef& d) { d.nodes.resize(1); }).find("1 nodes are too few"), std::string::npos);
  EXPECT_NE(text_with([](BeamDef& d) { d.nodes[2].id = 1; }).find("1 is given twice"), std::string::npos);
  EXPECT_NE(text_with([](BeamDef& d) {
              d.nodes[2].position = d.nodes[1].position;
            }).find("nodes 2 and 3 are at the same place"),
            std::string::npos);
  EXPECT_NE(text_with([](BeamDef& d) {
              d.elements = {{1, 2, 0, 0, {}}, {3, 4, 0, 0, {}}};
            }).find("nothing joins node 3 to node 1"),
            std::string::npos);
  EXPECT_NE(text_with([](BeamDef& d) {
              d.elements = {{1, 9, 0, 0, {}}};
            }).find("there is no node 9"),
            std::string::npos);
  EXPECT_NE(text_with([](BeamDef& d) {
              d.elements = {{1, 2, 3, 0, {}}};
            }).find("there is no section 3"),
            std::string::npos);
  EXPECT_NE(text_with([](BeamDef& d) {
              d.elements = {{1, 2, 0, 0, {2, 0, 0}}};
            }).find("it lies along the element"),
            std::string::npos);
  EXPECT_NE(text_with([](BeamDef& d) {
              d.mass = MassKind::lumped;
              d.rotary_inertia = RotaryInertia::none;
            }).find("leaves rotations without mass"),
            std::string::npos);
}

}  // namespace beam_test
}  // namespace slew::flex
