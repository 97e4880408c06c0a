// SPDX-License-Identifier: Apache-2.0
// Shortening against closed forms: Euler's buckling load, frequencies of a turning beam, a hanging one.
#include "flex/decompositions.h"
#include "tests/support/flex_beams.h"
#include "tests/validation/flex/figure.h"

namespace slew::flex {
namespace foreshortening_test {

using namespace testing;
using Eigen::MatrixXd;
using math::Vec3;

ReductionDef stiffened(int modes, Attachment attachment = Attachment::clamped) {
  ReductionDef def = with_modes(modes, attachment);
  def.stiffening = GeometricStiffening::straight_beam;
  return def;
}

// slender, and softer in one plane
BeamDef strip(int nodes, Triple end = {2, 0, 0}, Triple start = {0, 0, 0}) {
  SectionDef section{.shape = SectionShape::solid_rectangle, .width = 0.02, .height = 0.01, .shear = Shear::none};
  return straight(section, steel(), end, nodes, start);
}

MatrixXd stiffness_of(const ReducedBody& body) {
  MatrixXd K(body.modes(), body.modes());
  for (std::size_t k = 0; k < body.modes(); ++k) {
    for (std::size_t l = 0; l < body.modes(); ++l)
      K(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) = body.K[body.pair(k, l)];
  }
  return K;
}

// lowest eigenvalue of K + load (a . g of the tip)
double lowest(const ReducedBody& body, Vec3 load) {
  MatrixXd K = stiffness_of(body);
  for (std::size_t k = 0; k < body.modes(); ++k) {
    for (std::size_t l = 0; l < body.modes(); ++l)
      K(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) -= dot(body.nodes.back().g[body.pair(k, l)], load);
  }
  return descending_modes(K).values.tail<1>()[0];
}

TEST(Foreshortening, CantileverBucklesAtEulersLoad) {
  const double EI = 2.1e11 * 0.02 * std::pow(0.01, 3) / 12, euler = M_PI * M_PI * EI / (4 * 4);
  for (const int modes : {0, 4, 12}) {
    const Reduction r = reduce(build_beam(strip(20)), stiffened(modes));
    double low = 0, high = 3 * euler;
    while (high - low > 1e-9 * euler) {
      const double middle = (low + high) / 2;
      (lowest(r.body, Vec3(-middle, 0, 0)) > 0 ? low : high) = middle;
    }
    expect_figure("buckling", "load over pi^2 E I/(4 L^2), less 1, " + std::to_string(modes) + " modes inside",
                  std::abs(low / euler - 1), modes == 0 ? 0.01 : 1e-4);
  }
}

// hub at the root, axis z: M + K - W^2 (Y and H along x, y)
double turning_frequency(const ReducedBody& body, double W, int mode) {
  MatrixXd K = stiffness_of(body);
  for (std::size_t k = 0; k < body.modes(); ++k) {
    for (std::size_t l = 0; l < body.modes(); ++l) {
      const std::size_t p = body.pair(k, l);
      // kinetic energy of turning: W^2/2 int rho (px^2 + py^2), p = x + phi q + 1/2 g q q
      K(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) -=
          W * W * (body.Y[p](0, 0) + body.Y[p](1, 1) + body.H[p](0, 0) + body.H[p](1, 1));
    }
  }
  const auto values = descending_modes(K).values;
  return std::sqrt(values[values.size() - 1 - mode]);
}

// one mode: w^2 = w1^2 + 1.193 W^2 out of the plane of turning, less W^2 in it (Southwell)
TEST(Foreshortening, TurningBeamStiffensAsInSouthwell) {
  const Reduction all = reduce(build_beam(strip(20)), stiffened(10));
  const int out_of_plane[] = {1};  // thin along z: first mode flaps
  const ReducedBody flap = select(all.body, out_of_plane);
  ASSERT_GT(std::abs(flap.nodes.back().phi[0].z()), 0.9 * norm(flap.nodes.back().phi[0]));
  const double w1 = flap.omega[0];
  for (const double W : {0.5 * w1, 2 * w1}) {
    const double gained = (std::pow(turning_frequency(flap, W, 0), 2) - w1 * w1) / (W * W);
    expect_figure("turning", "flap, one mode: gain over W^2, less 1.193", std::abs(gained - 1.193), 1e-3);
  }
  const int lag[] = {2};
  const ReducedBody edge = select(all.body, lag);
  ASSERT_GT(std::abs(edge.nodes.back().phi[0].y()), 0.9 * norm(edge.nodes.back().phi[0]));
  const double w2 = edge.omega[0], W = 0.5 * w2;
  const double gained = (std::pow(turning_frequency(edge, W, 0), 2) - w2 * w2) / (W * W);
  expect_figure("turning", "lag, one mode: gain over W^2, less 0.193", std::abs(gained - 0.193), 1e-3);
}

// w/sqrt(E I/(rho A L^4)) of a turning uniform beam without hub: Wright, Smith, Thresher & Wang 1982, exact
TEST(Foreshortening, TurningBeamHasTheExactFrequencies) {
  BeamDef def = strip(40);
  def.rotary_inertia = RotaryInertia::none;
  const ReducedBody body = reduce(build_beam(def), stiffened(40)).body;
  const double I = 0.02 * std::pow(0.01, 3) / 12, unit = std::sqrt(2.1e11 * I / (7850 * 2e-4 * 16));
  // the edgewise mode, twice as stiff, is lower at the highest speed
  struct Row {
    double speed, first;
    int place = 0;
  };
  for (const Row& row :
       {Row{0, 3.5160}, Row{1, 3.6816}, Row{2, 4.1373}, Row{4, 5.5850}, Row{6, 7.3604}, Row{12, 13.1702, 1}})
    expect_figure("turning", "exact, W = " + std::to_string(static_cast<int>(row.speed)) + " [relative]",
                  std::abs(turning_frequency(body, row.speed * unit, row.place) / unit / row.first - 1), 1e-4);
}

// Greenhill 1881: a column of uniform weight buckles at m g = 7.8373 E I/L^2
TEST(Foreshortening, ColumnBucklesUnderItsOwnWeight) {
  const ReducedBody body = reduce(build_beam(strip(20)), stiffened(20)).body;
  const double critical = 7.837347 * 2.1e11 * 0.02 * std::pow(0.01, 3) / 12 / 4;
  double low = 0, high = 3 * critical;
  while (high - low > 1e-9 * critical) {
    const double middle = (low + high) / 2;
    MatrixXd K = stiffness_of(body);
    for (std::size_t k = 0; k < body.modes(); ++k) {
      for (std::size_t l = 0; l < body.modes(); ++l)
        K(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) +=
            middle / body.mass * body.G[body.pair(k, l)].x();
    }
    (descending_modes(K).values.tail<1>()[0] > 0 ? low : high) = middle;
  }
  expect_figure("buckling", "own weight over 7.8373 E I/L^2, less 1", std::abs(low / critical - 1), 1e-5);
}

TEST(Foreshortening, ClampInsideTheBeamShortensBothHalves) {
  ReductionDef def = stiffened(8);
  def.modes.clamped_nodes = {6};
  def.modes.interface_nodes = {1, 11};
  const Reduction r = reduce(build_beam(strip(11)), def);
  EXPECT_LT(norm(r.body.nodes[5].g[0]), 1e-15);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LE(r.body.nodes[10].g[r.body.pair(k, k)].x(), 1e-12) << "the far end comes back";
    EXPECT_GE(r.body.nodes[0].g[r.body.pair(k, k)].x(), -1e-12) << "so does the near one";
  }
}

TEST(Foreshortening, BeamClampedAtBothEndsIsRefused) {
  ReductionDef def = stiffened(8);
  def.modes.clamped_nodes = {1, 11};
  def.modes.interface_nodes = {6};
  EXPECT_NE(error_of([&] { (void)reduce(build_beam(strip(11)), def); }).find("it is clamped at several nodes"),
            std::string::npos);
}

TEST(Foreshortening, FreeBodyShortensAboutItsMeanMass) {
  const Reduction r = reduce(build_beam(strip(20, {1, 2, 2}, {-1, 0.5, 0})), stiffened(8, Attachment::free));
  for (const Vec3& G : r.body.G) EXPECT_LT(norm(G), 1e-12);
  EXPECT_GT(norm(r.body.nodes[0].g[0]), 0);
  // both ends come in by the same
  EXPECT_LT(norm(r.body.nodes.front().g[0] + r.body.nodes.back().g[0]), 1e-6 * norm(r.body.nodes[0].g[0]));
}

}  // namespace foreshortening_test
}  // namespace slew::flex
