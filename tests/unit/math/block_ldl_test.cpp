// SPDX-License-Identifier: Apache-2.0
// Saddle-point systems of blocks against a dense solution by another library.
#include "math/block_ldl.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/reference_algebra.h"

namespace slew::math {
namespace block_ldl_test {

using testing::Index;
using Matrix = testing::Dense<double>;
using Vector = testing::Dense<double>;

// The same system twice: as blocks, and dense.
class System {
 public:
  explicit System(BlockPattern pattern) : pattern_(std::move(pattern)), ldl_(pattern_) {
    dense_ = Matrix(ldl_.rows(), ldl_.rows());
    ldl_.clear();
  }
  void add(int row, int column, const Matrix& block) {
    std::vector<double> values;
    for (int r = 0; r < block.rows(); ++r) {
      for (int c = 0; c < block.cols(); ++c) values.push_back(block(r, c));
    }
    add_dense(row, column, block);
    if (row == column) return ldl_.add_diagonal(row, values);
    add_dense(column, row, block.transposed());
    ldl_.add_coupling(row, column, values);
  }
  Matrix random(int rows, int columns) {
    Matrix block(rows, columns);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) block(r, c) = uniform_(random_);
    }
    return block;
  }
  Matrix random_inertia(int size) {
    const Matrix a = random(size, size);
    return a * a.transposed() + 0.1 * Matrix::identity(size);
  }
  // Adds a body with the rows of the joint that hangs it on another one; none: on the ground.
  void hang(int node, int joint_rows, int parent, double mass = 1) {
    Matrix own(6 + joint_rows, 6 + joint_rows);
    own.put(0, 0, mass * random_inertia(6));
    const Matrix G = random(joint_rows, 6);
    own.put(6, 0, G);
    own.put(0, 6, G.transposed());
    add(node, node, own);
    if (parent >= 0) close(node, 6, joint_rows, parent);
  }
  // Adds rows of a node that act on another node's body.
  void close(int node, int first, int rows, int body) {
    Matrix block(size(node), size(body));
    block.put(first, 0, random(rows, 6));
    add(node, body, block);
  }
  [[nodiscard]] int size(int node) const { return pattern_.nodes[index(node)].size; }
  // The same values once more.
  void refill() {
    const Matrix values = dense_;
    dense_ = Matrix(ldl_.rows(), ldl_.rows());
    ldl_.clear();
    const auto again = [&](int row, int column) {
      add(row, column,
          values.block(ldl_.first_row(row), ldl_.first_row(column), pattern_.nodes[index(row)].size,
                       pattern_.nodes[index(column)].size));
    };
    for (std::size_t i = 0; i < pattern_.nodes.size(); ++i) again(static_cast<int>(i), static_cast<int>(i));
    for (const auto& [a, b] : pattern_.couplings) again(a, b);
  }
  Vector solve(const Vector& b) const {
    Vector x = b;
    ldl_.solve({x.data(), static_cast<std::size_t>(x.size())});
    return x;
  }
  [[nodiscard]] BlockLdl& ldl() { return ldl_; }
  [[nodiscard]] const Matrix& dense() const { return dense_; }

 private:
  void add_dense(int row, int column, const Matrix& block) {
    const Index first = ldl_.first_row(row), left = ldl_.first_row(column);
    dense_.put(first, left, dense_.block(first, left, block.rows(), block.cols()) + block);
  }
  static std::size_t index(int node) { return static_cast<std::size_t>(node); }

  BlockPattern pattern_;
  BlockLdl ldl_;
  Matrix dense_;
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

constexpr double kTolerance = 1e-10;

// bodies 0 .. n-1, each with its joint
BlockPattern chain(int bodies, int rows) {
  BlockPattern pattern;
  for (int i = 0; i < bodies; ++i) pattern.nodes.push_back({6 + rows, BlockKind::regular});
  for (int i = 1; i < bodies; ++i) pattern.couplings.emplace_back(i, i - 1);
  return pattern;
}

void expect_solved(System& system, double tolerance) {
  ASSERT_TRUE(system.ldl().factorize(kTolerance));
  EXPECT_EQ(system.ldl().redundant_rows(), 0);
  const Vector b = system.random(system.ldl().rows(), 1);
  // in long double
  const Vector expected = testing::solve(system.dense(), b);
  EXPECT_LT((system.solve(b) - expected).norm(), tolerance * expected.norm());
}

TEST(BlockLdl, SolvesAChainOfBodiesAndJoints) {
  System system(chain(7, 5));
  for (int i = 0; i < 7; ++i) system.hang(i, 5, i - 1);
  expect_solved(system, 1e-10);
}

TEST(BlockLdl, SolvesLoopsBranchesAndCoupledMasses) {
  // 0 - 1 - 2 - 3 with 4 and 5 on 1; a loop from 3 to 5, one from 2 to the ground, a mass between 4 and 1
  BlockPattern pattern;
  const int rows[] = {5, 3, 0, 4, 6, 2};
  const int parents[] = {-1, 0, 1, 2, 1, 1};
  for (const int r : rows) pattern.nodes.push_back({6 + r, BlockKind::regular});
  for (int i = 1; i < 6; ++i) {
    if (rows[i] > 0) pattern.couplings.emplace_back(i, parents[i]);
  }
  pattern.nodes.push_back({3, BlockKind::closing});
  pattern.nodes.push_back({1, BlockKind::closing});
  pattern.couplings.insert(pattern.couplings.end(), {{6, 3}, {6, 5}, {7, 2}});
  System system(pattern);
  for (int i = 0; i < 6; ++i) system.hang(i, rows[i], rows[i] > 0 ? parents[i] : -1);
  for (const int body : {3, 5}) system.close(6, 0, 3, body);
  system.close(7, 0, 1, 2);
  // coupled masses make the inertia of two bodies one block
  Matrix mass(system.size(4), system.size(1));
  mass.put(0, 0, 0.05 * system.random(6, 6));
  system.add(4, 1, mass);
  expect_solved(system, 1e-10);
}

// Massless bodies 1, 2 and 3 stand on body 0, 2 and 3 are coupled, 1 is on the ground: its rows are met by the motion
// of 0 alone, to which they are not coupled. With the fewest neighbours next they would come before it, as redundant.
TEST(BlockLdl, TakesTheRowsOfALoopAfterItsInnerBodies) {
  BlockPattern pattern;
  pattern.nodes = {{6, BlockKind::regular},
                   {12, BlockKind::regular},
                   {12, BlockKind::regular},
                   {12, BlockKind::regular},
                   {5, BlockKind::closing}};
  pattern.couplings = {{1, 0}, {2, 0}, {3, 0}, {3, 2}, {4, 1}};
  pattern.follows = {{4, 0}, {4, 1}};
  System system(pattern);
  system.hang(0, 0, -1);
  for (const int node : {1, 2, 3}) system.hang(node, 6, 0, 0.0);
  system.close(4, 0, 5, 1);
  Matrix coupling(12, 12);
  coupling.put(0, 0, 1e-4 * system.random(6, 6));
  system.add(3, 2, coupling);
  expect_solved(system, 1e-10);
}

TEST(BlockLdl, OfAChainHasABlockALink) {
  for (const int bodies : {10, 100}) EXPECT_EQ(BlockLdl(chain(bodies, 5)).coupling_count(), bodies - 1);
}

// two rows of closing node 3 repeat rows of node 2 on the same two bodies
TEST(BlockLdl, LeavesRedundantRowsOutAndMeetsThemAllTheSame) {
  BlockPattern pattern;
  pattern.nodes = {{6, BlockKind::regular}, {6, BlockKind::regular}, {4, BlockKind::closing}, {3, BlockKind::closing}};
  pattern.couplings = {{2, 0}, {2, 1}, {3, 0}, {3, 1}};
  System system(pattern);
  for (const int body : {0, 1}) system.add(body, body, system.random_inertia(6));
  for (const int body : {0, 1}) {
    const Matrix G = system.random(4, 6);
    Matrix again = system.random(3, 6);
    again.put(0, 0, G.row(1) - 2 * G.row(3));
    again.put(2, 0, G.row(0));
    system.add(2, body, G);
    system.add(3, body, again);
  }
  ASSERT_TRUE(system.ldl().factorize(kTolerance));
  EXPECT_EQ(system.ldl().redundant_rows(), 2);
  // which of the dependent ones goes is the plan's: two of these five
  int among = 0;
  for (int row = 0; row < 4; ++row) among += system.ldl().is_redundant(2, row) ? 1 : 0;
  for (const int row : {0, 2}) among += system.ldl().is_redundant(3, row) ? 1 : 0;
  EXPECT_EQ(among, 2);
  EXPECT_FALSE(system.ldl().is_redundant(3, 1));
  // a consistent right-hand side is met in every row
  const Vector b = system.dense() * system.random(system.ldl().rows(), 1);
  EXPECT_LT((system.dense() * system.solve(b) - b).norm(), 1e-11 * b.norm());
}

TEST(BlockLdl, FindsARowThatRepeatsItselfWithinItsNode) {
  BlockPattern pattern;
  pattern.nodes = {{6, BlockKind::regular}, {2, BlockKind::closing}};
  pattern.couplings = {{1, 0}};
  System system(pattern);
  system.add(0, 0, system.random_inertia(6));
  Matrix G = system.random(2, 6);
  G.put(1, 0, 3 * G.row(0));
  system.add(1, 0, G);
  ASSERT_TRUE(system.ldl().factorize(kTolerance));
  EXPECT_EQ(system.ldl().redundant_rows(), 1);
}

TEST(BlockLdl, KeepsItsAccuracyWithMassesFarApart) {
  System system(chain(6, 5));
  for (int i = 0; i < 6; ++i) system.hang(i, 5, i - 1, i % 2 == 0 ? 1e6 : 1.0);
  expect_solved(system, 1e-7);
}

TEST(BlockLdl, TakesABodyWithoutInertiaThatItsJointHolds) {
  System system(chain(2, 5));
  system.hang(0, 5, -1);
  // a point mass: no moments of inertia
  Matrix own(11, 11);
  own.put(0, 0, 2 * Matrix::identity(3));
  const Matrix G = system.random(5, 6);
  own.put(6, 0, G);
  own.put(0, 6, G.transposed());
  system.add(1, 1, own);
  system.close(1, 6, 5, 0);
  expect_solved(system, 1e-10);
}

// masses with rows as stiff springs between them: definite, with eigenvalues far apart in every block
System sprung(int bodies, double stiffness) {
  BlockPattern pattern;
  pattern.nodes.resize(static_cast<std::size_t>(bodies), {6, BlockKind::definite});
  for (int i = 1; i < bodies; ++i) pattern.couplings.emplace_back(i, i - 1);
  System system(pattern);
  for (int i = 0; i < bodies; ++i) {
    const Matrix G = system.random(5, 6), to_parent = system.random(5, 6);
    system.add(i, i, system.random_inertia(6) + stiffness * G.transposed() * G);
    if (i == 0) continue;
    system.add(i - 1, i - 1, stiffness * to_parent.transposed() * to_parent);
    system.add(i, i - 1, stiffness * G.transposed() * to_parent);
  }
  return system;
}

TEST(BlockLdl, SolvesADefiniteMatrix) {
  System system = sprung(8, 10);
  expect_solved(system, 1e-10);
}

TEST(BlockLdl, LosesTheRatioOfStiffAndSoftInADefiniteMatrixNotItsSquare) {
  // rounding is 1e-16, soft directions have 1e-2 of the mass
  System system = sprung(8, 1e8);
  expect_solved(system, 1e-4);
}

// determinants of two nodes: the first unchanged, the second less the contribution of the first
TEST(BlockLdl, HasTheDeterminantsOfADefiniteMatrix) {
  System system(BlockPattern{{{1, BlockKind::definite}, {2, BlockKind::definite}}, {{1, 0}}, {}});
  Matrix first(1, 1), other(2, 2), between(2, 1);
  first(0, 0) = 4;
  other(0, 0) = 5, other(0, 1) = other(1, 0) = 1, other(1, 1) = 3;
  between(0, 0) = 2;
  system.add(0, 0, first);
  system.add(1, 1, other);
  system.add(1, 0, between);
  ASSERT_TRUE(system.ldl().factorize(kTolerance));
  // 5 - 2 2/4 = 4, so 4 3 - 1
  EXPECT_NEAR(system.ldl().root_of_determinant(0), 2, 1e-14);
  EXPECT_NEAR(system.ldl().root_of_determinant(1), std::sqrt(11), 1e-14);
}

TEST(BlockLdl, ReportsThatADefiniteNodeIsNot) {
  System system = sprung(2, 10);
  system.add(1, 1, -1e3 * Matrix::identity(6));
  EXPECT_FALSE(system.ldl().factorize(kTolerance));
}

TEST(BlockLdl, ReportsThatANodeIsSingular) {
  System system(chain(2, 5));
  system.hang(0, 5, -1);
  system.hang(1, 5, 0, 0.0);
  EXPECT_FALSE(system.ldl().factorize(kTolerance));
}

TEST(BlockLdl, GivesTheSameBitsWhenItIsFilledAgain) {
  System system(chain(4, 5));
  for (int i = 0; i < 4; ++i) system.hang(i, 5, i - 1);
  ASSERT_TRUE(system.ldl().factorize(kTolerance));
  const Vector b = system.random(system.ldl().rows(), 1);
  const Vector first = system.solve(b);
  system.refill();
  ASSERT_TRUE(system.ldl().factorize(kTolerance));
  EXPECT_EQ(first, system.solve(b));
}

}  // namespace block_ldl_test
}  // namespace slew::math
