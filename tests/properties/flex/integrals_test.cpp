// SPDX-License-Identifier: Apache-2.0
// Integrals of reduced bodies: those of the solid, alike in every frame and mesh, and the same by two ways.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "flex/imported_model.h"
#include "tests/support/flex_beams.h"
#include "tests/support/temporary_folder.h"

namespace slew::flex {
namespace integrals_test {

using namespace testing;
using math::Mat3;
using math::Vec3;

double largest(const Mat3& a) {
  double value = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) value = std::max(value, std::abs(a(i, j)));
  }
  return value;
}

void expect_near(const Mat3& a, const Mat3& b, double tolerance) {
  EXPECT_LT(largest(a - b), tolerance);
}

SectionDef box() {
  return {.shape = SectionShape::hollow_rectangle, .width = 0.12, .height = 0.2, .wall = 0.01};
}

ReductionDef stiffened(int modes, Attachment attachment = Attachment::clamped) {
  ReductionDef def = with_modes(modes, attachment);
  def.stiffening = GeometricStiffening::straight_beam;
  return def;
}

// mass, centre and second moments of a hollow box in closed form, walls included
TEST(Integrals, BoxBeamHasTheRigidBodyOfTheSolid) {
  const double L = 3, rho = 7850, A = 0.12 * 0.2 - 0.1 * 0.18;
  const double Iyy = (0.12 * std::pow(0.2, 3) - 0.1 * std::pow(0.18, 3)) / 12;
  const double Izz = (0.2 * std::pow(0.12, 3) - 0.18 * std::pow(0.1, 3)) / 12;
  for (const int nodes : {2, 20, 200}) {
    const Reduction r = reduce(build_beam(straight(box(), steel(), {L, 0, 0}, nodes)), with_modes(0));
    const double m = rho * A * L;
    EXPECT_NEAR(r.body.mass, m, 1e-12 * m);
    EXPECT_LT(norm(r.body.s0 - Vec3(m * L / 2, 0, 0)), 1e-12 * m * L);
    // by y: integral y^2 dA = Izz
    expect_near(r.body.W0, Mat3::diagonal(m * L * L / 3, rho * Izz * L, rho * Iyy * L), 1e-12 * m * L * L);
  }
}

TEST(Integrals, ReducedBodyHasTheRigidBodyOfItsMatrices) {
  BeamDef def = jib_boom(7);
  def.nodes[3].position[1] += 0.4;  // bent
  for (const MassKind mass : {MassKind::consistent, MassKind::lumped}) {
    def.mass = mass;
    const FeModel model = build_beam(def);
    const RigidMass rigid = rigid_mass(model);
    const Reduction r = reduce(model, with_modes(6));
    EXPECT_NEAR(r.body.mass, rigid.mass, 1e-12 * rigid.mass);
    EXPECT_LT(norm(r.body.s0 - rigid.first), 1e-12 * rigid.mass * 7);
    expect_near(r.body.W0, rigid.second, 1e-12 * largest(rigid.second));
  }
}

TEST(Integrals, TracesAreModalMassesAndPairsAreSymmetric) {
  for (const Attachment attachment : {Attachment::clamped, Attachment::free}) {
    const ReducedBody body = reduce(build_beam(jib_boom(9)), stiffened(10, attachment)).body;
    for (std::size_t k = 0; k < body.modes(); ++k) {
      for (std::size_t l = 0; l < body.modes(); ++l) {
        const Mat3 &Y = body.Y[body.pair(k, l)], &mirrored = body.Y[body.pair(l, k)];
        EXPECT_NEAR(Y(0, 0) + Y(1, 1) + Y(2, 2), k == l ? 1 : 0, 1e-10);
        EXPECT_EQ(largest(Y - transpose(mirrored)), 0);
        EXPECT_EQ(body.G[body.pair(k, l)].array(), body.G[body.pair(l, k)].array());
        EXPECT_EQ(body.K[body.pair(k, l)], body.K[body.pair(l, k)]);
      }
    }
  }
}

TEST(Integrals, FreeModesHaveNeitherMomentumNorAngularMomentum) {
  const ReducedBody body = reduce(build_beam(jib_boom()), with_modes(12, Attachment::free)).body;
  const double scale = std::sqrt(body.mass);
  for (std::size_t k = 0; k < body.modes(); ++k) {
    EXPECT_LT(norm(body.C[k]), 1e-11 * scale);
    EXPECT_LT(largest(body.Z[k] - transpose(body.Z[k])), 1e-10 * scale * 6.5);
  }
}

// C and Z against the sum over the nodes of a fine lumped model
TEST(Integrals, LumpedAndConsistentMassConvergeToEachOther) {
  double before = 0;
  for (const int nodes : {11, 21, 41}) {
    BeamDef def = straight(box(), steel(), {2, 1, 0.5}, nodes);
    const std::vector<int> first = {1, 2, 3, 4};
    const ReducedBody a = select(reduce(build_beam(def), stiffened(12)).body, first);
    def.mass = MassKind::lumped;
    const ReducedBody b = select(reduce(build_beam(def), stiffened(12)).body, first);
    double worst = std::abs(largest(a.W0 - b.W0) / largest(a.W0));
    for (std::size_t k = 0; k < 4; ++k) {
      worst = std::max(worst, std::abs(a.omega[k] / b.omega[k] - 1));
      worst = std::max(worst, norm(a.C[k] - b.C[k]) / std::sqrt(a.mass));
      worst = std::max(worst, largest(a.Z[k] - b.Z[k]) / (2.3 * std::sqrt(a.mass)));
    }
    if (before > 0) {
      EXPECT_NEAR(before / worst, 4, 0.5) << "second order";
    }
    before = worst;
  }
  EXPECT_LT(before, 2e-3);
}

Mat3 some_rotation() {
  const Vec3 z = Vec3(1, 2, 2) * (1.0 / 3), y = Vec3(2, 1, -2) * (1.0 / 3);
  return {cross(y, z), y, z};
}

// the beam and its frame of sections turned as one: all integrals turn with it
TEST(Integrals, TurnedBeamHasTurnedIntegrals) {
  const Mat3 R = some_rotation();
  BeamDef def = straight(box(), steel(), {2, 0.3, 0.1}, 12, {0.2, 0.1, -0.3});
  BeamDef turned = def;
  for (BeamNodeDef& node : turned.nodes) node.position = (R * Vec3(node.position)).array();
  turned.y_axis = (R * Vec3(def.y_axis)).array();
  const ReducedBody a = reduce(build_beam(def), stiffened(8)).body, b = reduce(build_beam(turned), stiffened(8)).body;
  expect_near(R * a.W0 * transpose(R), b.W0, 1e-10);
  EXPECT_LT(norm(R * a.s0 - b.s0), 1e-10);
  for (std::size_t k = 0; k < a.modes(); ++k) {
    EXPECT_NEAR(b.omega[k] / a.omega[k], 1, 1e-9);
    // the sign follows the largest component, which may be another one now
    const double sign =
        dot(R * a.nodes.back().phi[k], b.nodes.back().phi[k]) + dot(R * a.nodes.back().psi[k], b.nodes.back().psi[k]) <
                0
            ? -1
            : 1;
    EXPECT_LT(norm(R * a.C[k] * sign - b.C[k]), 1e-6) << k;
    expect_near(R * a.Z[k] * transpose(R) * sign, b.Z[k], 1e-6);
    expect_near(R * a.Y[a.pair(k, k)] * transpose(R), b.Y[b.pair(k, k)], 1e-6);
    EXPECT_LT(norm(R * a.G[a.pair(k, k)] - b.G[b.pair(k, k)]), 1e-6 * (1 + norm(a.G[a.pair(k, k)])));
    expect_near(R * a.H[a.pair(k, k)] * transpose(R), b.H[b.pair(k, k)], 1e-6 * (1 + largest(a.H[a.pair(k, k)])));
  }
}

TEST(Integrals, TwentyAndTwoHundredNodesAgree) {
  const std::vector<int> first = {1, 2};
  const ReducedBody a = select(reduce(build_beam(jib_boom(20)), stiffened(16)).body, first);
  const ReducedBody b = select(reduce(build_beam(jib_boom(200)), stiffened(16)).body, first);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(a.omega[k] / b.omega[k], 1, 2e-4);
    EXPECT_LT(norm(a.C[k] - b.C[k]), 1e-3 * norm(b.C[k]));
    EXPECT_LT(norm(a.nodes.back().phi[k] - b.nodes.back().phi[k]), 1e-3 * norm(b.nodes.back().phi[k]));
    EXPECT_LT(norm(a.nodes.back().g[a.pair(k, k)] - b.nodes.back().g[b.pair(k, k)]),
              2e-3 * norm(b.nodes.back().g[b.pair(k, k)]));
  }
}

ReducedBody imported(const FeModel& model, std::vector<FeNode> nodes, const SparseMatrix& M, const SparseMatrix& K,
                     ReductionDef def = with_modes(10)) {
  def.modes.clamped_nodes = {model.nodes.front().id};
  def.modes.interface_nodes = {model.nodes.back().id};
  return reduce(model_of_matrices("Body", std::move(nodes), M, K), def).body;
}

TEST(Import, ExportedBeamComesBackWithItsFrequencies) {
  for (const int nodes : {20, 200}) {
    const slew::testing::TemporaryFolder folder("flex_round_trip");
    const FeModel model = at_nodes(build_beam(jib_boom(nodes)));
    const ImportDef files{"Jib", folder.path() / "m.mtx", folder.path() / "k.mtx", folder.path() / "nodes.csv"};
    export_model(model, files);
    const Reduction a = reduce(model, with_modes(10)), b = reduce(import_model(files), with_modes(10));
    EXPECT_NEAR(b.body.mass, a.body.mass, 1e-10 * a.body.mass);
    expect_near(b.body.W0, a.body.W0, 1e-10 * largest(a.body.W0));
    for (std::size_t k = 0; k < a.body.modes(); ++k) {
      EXPECT_NEAR(b.body.omega[k] / a.body.omega[k], 1, 1e-9) << nodes;
      EXPECT_LT(norm(b.body.C[k] - a.body.C[k]), 1e-6 * std::sqrt(a.body.mass)) << k;
      expect_near(b.body.Z[k] - transpose(b.body.Z[k]), a.body.Z[k] - transpose(a.body.Z[k]), 1e-5 * 80);
    }
    // the error of the mean of the diagonals for slender modes is small, and reported
    EXPECT_GT(b.source.deviation.block, 1e-5);
    EXPECT_LT(largest(b.body.Y[0] - a.body.Y[0]), 0.02);
    EXPECT_LT(largest(b.body.Z[0] - a.body.Z[0]), 0.02 * largest(a.body.Z[0]));
  }
}

TEST(Import, OrderOfTheNodesChangesNothing) {
  const FeModel model = at_nodes(build_beam(jib_boom(8)));
  const ReducedBody straight_order = imported(model, model.nodes, model.M, model.K);
  std::vector<std::size_t> order = {0, 1, 2, 3, 4, 5, 6, 7};
  std::mt19937_64 random(3);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<FeNode> nodes;
  std::vector<int> row(48);
  for (std::size_t i = 0; i < 8; ++i) {
    nodes.push_back(model.nodes[order[i]]);
    for (int a = 0; a < 6; ++a) row[6 * order[i] + static_cast<std::size_t>(a)] = static_cast<int>(6 * i) + a;
  }
  const auto permuted = [&](const SparseMatrix& A) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < 48; ++j) {
      for (SparseMatrix::InnerIterator it(A, j); it; ++it)
        entries.emplace_back(row[static_cast<std::size_t>(it.row())], row[static_cast<std::size_t>(j)], it.value());
    }
    SparseMatrix out(48, 48);
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
  };
  const ReducedBody other_order = imported(model, nodes, permuted(model.M), permuted(model.K));
  EXPECT_EQ(straight_order.omega, other_order.omega);
  for (std::size_t k = 0; k < straight_order.modes(); ++k) {
    EXPECT_EQ(straight_order.C[k].array(), other_order.C[k].array());
    EXPECT_EQ(straight_order.nodes[5].phi[k].array(), other_order.nodes[5].phi[k].array());
  }
}

// Eight-node brick of masses m_ij = m_ij 1 and springs along all its lines: a solid of three freedoms a node
struct Brick {
  std::vector<FeNode> nodes;
  SparseMatrix M, K;
};

Brick brick() {
  Brick out;
  for (int i = 0; i < 12; ++i)
    out.nodes.push_back({i + 1, Vec3(0.1 * (i / 4), i % 2 == 0 ? 0 : 0.08, i % 4 < 2 ? 0 : 0.06), 3 * i, 3});
  std::vector<Eigen::Triplet<double>> mass, stiffness;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) {
      if (std::abs(i / 4 - j / 4) > 1) continue;
      // tensor product of linear shape functions along y and z, and along x
      const bool is_end = i / 4 != 1;
      const double x = i / 4 == j / 4 ? (is_end ? 2 : 4) : 1;
      const double value = 0.1 * x / 6 * (i % 2 == j % 2 ? 2 : 1) * (i % 4 / 2 == j % 4 / 2 ? 2 : 1);
      for (int a = 0; a < 3; ++a) mass.emplace_back(3 * i + a, 3 * j + a, value);
      if (i == j) continue;
      const Vec3 d = out.nodes[static_cast<std::size_t>(j)].position - out.nodes[static_cast<std::size_t>(i)].position;
      const Mat3 k = outer(d, d) * (1e6 / dot(d, d) / norm(d));
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          stiffness.emplace_back(3 * i + a, 3 * i + b, k(a, b));
          stiffness.emplace_back(3 * i + a, 3 * j + b, -k(a, b));
        }
      }
    }
  }
  out.M.resize(36, 36);
  out.K.resize(36, 36);
  out.M.setFromTriplets(mass.begin(), mass.end());
  out.K.setFromTriplets(stiffness.begin(), stiffness.end());
  return out;
}

TEST(Import, SolidElementsGiveExactIntegrals) {
  const Brick solid = brick();
  const FeModel model = model_of_matrices("Brick", solid.nodes, solid.M, solid.K);
  for (const bool is_free : {true, false}) {
    ReductionDef def = with_modes(8, is_free ? Attachment::free : Attachment::clamped);
    if (!is_free) def.modes.clamped_nodes = {1, 2, 3, 4};
    def.modes.interface_nodes = {9, 10, 11};
    const Reduction r = reduce(model, def);
    EXPECT_LT(r.source.deviation.block, 1e-15);
    EXPECT_LT(r.source.deviation.modal, 1e-10);
    for (std::size_t k = 0; k < r.body.modes(); ++k) {
      Vec3 C;
      Mat3 Z;
      for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 12; ++j) {
          const double m = model.M.coeff(3 * i, 3 * j);
          const Vec3 u = r.body.nodes[static_cast<std::size_t>(j)].phi[k];
          C += u * m;
          Z += outer(model.nodes[static_cast<std::size_t>(i)].position * m, u);
        }
      }
      EXPECT_LT(norm(C - r.body.C[k]), 1e-12);
      expect_near(Z, r.body.Z[k], 1e-12);
      if (is_free) {
        EXPECT_LT(norm(C), 1e-10);
      }
    }
  }
  ReductionDef one = with_modes(4);
  one.modes.clamped_nodes = {1};
  EXPECT_NE(error_of([&] { (void)reduce(model, one); }).find("these nodes hold 3 of the six rigid motions"),
            std::string::npos);
  one = with_modes(4);
  one.modes.clamped_nodes = {1, 2, 3};
  one.stiffening = GeometricStiffening::straight_beam;
  EXPECT_NE(error_of([&] {
              (void)reduce(model, one);
            }).find("geometric stiffening was requested, but the model has imported matrices"),
            std::string::npos);
}

TEST(Integrals, BentBeamWithGeometricStiffeningIsRefused) {
  BeamDef def = jib_boom(5);
  def.nodes[2].position[2] += 0.01;
  EXPECT_NE(error_of([&] {
              (void)reduce(build_beam(def), stiffened(4));
            }).find("Truck_JibBoom: geometric stiffening was requested, but node 3 is 0.01 m off the line of the beam"),
            std::string::npos);
}

}  // namespace integrals_test
}  // namespace slew::flex
