// SPDX-License-Identifier: Apache-2.0
#include "math/bounded_least_squares.h"

#include <gtest/gtest.h>

#include <vector>

#include "math/range_projector.h"

namespace slew::math {
namespace bounded_least_squares_test {

using Numbers = std::vector<double>;

TEST(BoundedLeastSquares, SolvesARegularSystemWithAPositiveSolution) {
  const Numbers q = bounded_least_squares(Numbers{1, -0.5, 0, 1}, Numbers{2, 6}, Numbers{0, 0});
  EXPECT_NEAR(q[0], 5, 1e-9);
  EXPECT_NEAR(q[1], 6, 1e-9);
}

// q_1 - q_2 = 4: the point of this line nearest to (10, 10), and to (0, 0) with both at least 0
TEST(BoundedLeastSquares, TakesTheSolutionNearestToTheAim) {
  const Numbers free = bounded_least_squares(Numbers{1, -1}, Numbers{4}, Numbers{10, 10});
  EXPECT_NEAR(free[0], 12, 1e-9);
  EXPECT_NEAR(free[1], 8, 1e-9);
  const Numbers bounded = bounded_least_squares(Numbers{1, -1}, Numbers{4}, Numbers{0, 0});
  EXPECT_NEAR(bounded[0], 4, 1e-9);
  EXPECT_EQ(bounded[1], 0);
}

TEST(BoundedLeastSquares, KeepsAnUnknownAtItsBoundThatWouldBeNegative) {
  // without bounds (-1, 2)
  const Numbers q = bounded_least_squares(Numbers{1, 1, 1, 2}, Numbers{1, 3}, Numbers{0, 0});
  EXPECT_EQ(q[0], 0);
  EXPECT_NEAR(q[1], 7.0 / 5, 1e-7) << "least squares of the second unknown alone";
}

TEST(BoundedLeastSquares, LeavesTheLeastRemainderOfEquationsThatContradict) {
  const Numbers q = bounded_least_squares(Numbers{1, 1}, Numbers{3, 7}, Numbers{0});
  EXPECT_NEAR(q[0], 5, 1e-6);
  EXPECT_EQ(bounded_least_squares(Numbers{1, 1}, Numbers{-3, -7}, Numbers{1})[0], 0);
}

TEST(RangeProjector, OfARegularMatrixIsTheIdentity) {
  EXPECT_EQ(range_projector(Numbers{2, 1, 1, 3}, 2), (Numbers{1, 0, 0, 1}));
}

TEST(RangeProjector, OfOneCoordinateMovedByTwoIsItsDirection) {
  // W = l l^T, l = (1, -2), beside a coordinate of its own
  const Numbers P = range_projector(Numbers{1, -2, 0, -2, 4, 0, 0, 0, 5}, 3);
  const Numbers by_hand = {0.2, -0.4, 0, -0.4, 0.8, 0, 0, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(P[i], by_hand[i], 1e-14) << i;
}

}  // namespace bounded_least_squares_test
}  // namespace slew::math
