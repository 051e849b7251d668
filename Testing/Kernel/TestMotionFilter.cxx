// SPDX-License-Identifier: BSD-3-Clause
// The filter of a target's motion: closed forms, derivatives by differences, and errors that are as
// large as it says.
#include "MotionFilter.h"

#include <gtest/gtest.h>

#include <random>

using namespace avianlidar;

namespace
{
MotionModel gull(bool turns)
{
  return { 2.0, turns ? 1e-3 : 0.0, 7.0, 2.0, turns ? 0.2 : 0.0 };
}

glm::dmat3 someError()
{
  return glm::dmat3(2.0, 0.5, 0.2, 0.5, 1.0, -0.1, 0.2, -0.1, 0.5);
}

using Random = std::mt19937_64;

Vec3 normalVector(Random& random)
{
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return { x, y, normal(random) };
}

/// A random vector of the covariance of someError(), by its Cholesky factor.
Vec3 errorOf(Random& random)
{
  const glm::dmat3 a = someError();
  const double xx = std::sqrt(a[0][0]);
  const double yx = a[0][1] / xx;
  const double zx = a[0][2] / xx;
  const double yy = std::sqrt(a[1][1] - yx * yx);
  const double zy = (a[1][2] - zx * yx) / yy;
  const double zz = std::sqrt(a[2][2] - zx * zx - zy * zy);
  const Vec3 n = normalVector(random);
  return { xx * n.x, yx * n.x + yy * n.y, zx * n.x + zy * n.y + zz * n.z };
}
}

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

TEST(MotionFilter, ErrorsAreAsLargeAsItSays)
{
  const MotionModel model = gull(false);
  constexpr int targets = 400;
  constexpr int scans = 12;
  Random random(7);
  double innovations = 0.0; // squares, of which each has the mean 3
  double positions = 0.0;
  double velocities = 0.0;
  for (int target = 0; target < targets; ++target)
  {
    Vec3 position = 100.0 * normalVector(random);
    Vec3 velocity = normalVector(random) * Vec3(7.0, 7.0, 2.0);
    MotionState state = startMotion(position + errorOf(random), someError(), model);
    for (int scan = 1; scan < scans; ++scan)
    {
      // White noise acceleration, integrated over t: velocity w sqrt(q t), position w t / 2 of it
      // and as much again, independent, as makes q t^3 / 3.
      const double t = 1.0 + 0.2 * scan;
      const Vec3 change = std::sqrt(model.accelerationDensity * t) * normalVector(random);
      position += velocity * t + 0.5 * t * change +
        std::sqrt(model.accelerationDensity * t * t * t / 12.0) * normalVector(random);
      velocity += change;
      const Vec3 measured = position + errorOf(random);
      state = predicted(state, t, model);
      innovations += innovationOf(state, measured, someError()).distanceSquare;
      state = updated(state, measured, someError());
    }
    positions += innovationOf(state, position, glm::dmat3(0.0)).distanceSquare;
    glm::dmat3 error;
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < 3; ++j)
      {
        error[i][j] =
          state.covariance[3 + static_cast<std::size_t>(i)][3 + static_cast<std::size_t>(j)];
      }
    }
    MotionState only;
    velocities += innovationOf(only, velocity - state.velocity(), error).distanceSquare;
  }
  // A mean of n chi squares of three degrees has the standard error sqrt(6 / n).
  constexpr double n = targets;
  EXPECT_NEAR(positions / n, 3.0, 1.96 * std::sqrt(6.0 / n));
  EXPECT_NEAR(velocities / n, 3.0, 1.96 * std::sqrt(6.0 / n));
  EXPECT_NEAR(innovations / (n * (scans - 1)), 3.0, 1.96 * std::sqrt(6.0 / (n * (scans - 1))));
}

TEST(MotionFilter, GatesAreQuantilesOfChiSquare)
{
  // Abramowitz and Stegun, table 26.8, three degrees.
  EXPECT_NEAR(normalDistanceSquare(0.5), 2.36597, 5e-6);
  EXPECT_NEAR(normalDistanceSquare(0.95), 7.81473, 5e-6);
  EXPECT_NEAR(normalDistanceSquare(0.99), 11.3449, 5e-5);
  EXPECT_NEAR(normalDistanceSquare(0.999), 16.266, 5e-4);
}
