// SPDX-License-Identifier: BSD-3-Clause
// The filter of a target's motion: turns and gates in closed form, derivatives by differences.
// States and covariances of straight flight are TestTracker.py's.
#include "MotionFilter.h"

#include <gtest/gtest.h>

using namespace avianlidar;

TEST(MotionFilter, TurnsInCircles)
{
  MotionState state;
  state.mean = { 0.0, 0.0, 0.0, 12.0, 0.0, 1.0, 0.3 };
  const double half = Pi / 0.3;
  const MotionState opposite = predicted(state, half, {});
  EXPECT_NEAR(opposite.mean[0], 0.0, 1e-12);
  EXPECT_NEAR(opposite.mean[1], 2.0 * 12.0 / 0.3, 1e-12); // to the left: two radii
  EXPECT_NEAR(opposite.mean[2], half, 1e-12);
  EXPECT_NEAR(opposite.mean[3], -12.0, 1e-12);
}

TEST(MotionFilter, DerivativesAreThoseOfDifferences)
{
  for (const double rate : { 0.0, 1e-5, 4.9e-4, 5.1e-4, 0.1, -0.4 })
  {
    MotionState state;
    state.mean = { 1.0, -2.0, 3.0, 9.0, -5.0, 1.0, rate };
    const double step = 1e-5;
    for (std::size_t of = 3; of < MotionState::Size; ++of)
    {
      MotionState more = state;
      MotionState less = state;
      more.mean[of] += step;
      less.mean[of] -= step;
      const MotionState::Row above = predicted(more, 2.0, {}).mean;
      const MotionState::Row below = predicted(less, 2.0, {}).mean;
      // A covariance with one variance becomes the product of the derivatives.
      MotionState one = state;
      one.covariance[of][of] = 1.0;
      const MotionState moved = predicted(one, 2.0, {});
      for (std::size_t i = 0; i < MotionState::Size; ++i)
      {
        const double slope = (above[i] - below[i]) / (2.0 * step);
        const double scale = (above[of] - below[of]) / (2.0 * step);
        EXPECT_NEAR(moved.covariance[i][of], slope * scale, 2e-7) << rate << " " << of << " " << i;
      }
    }
  }
}

TEST(MotionFilter, GatesAreQuantilesOfChiSquare)
{
  // Abramowitz and Stegun, table 26.8, three degrees.
  EXPECT_NEAR(normalDistanceSquare(0.5), 2.36597, 5e-6);
  EXPECT_NEAR(normalDistanceSquare(0.95), 7.81473, 5e-6);
  EXPECT_NEAR(normalDistanceSquare(0.99), 11.3449, 5e-5);
  EXPECT_NEAR(normalDistanceSquare(0.999), 16.266, 5e-4);
}
