// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MotionFilter.h
 * @brief Where a target is and how it moves, estimated from positions with errors: a Kalman filter
 * of constant velocity, or an extended one of a coordinated turn.
 *
 * The state is position, velocity and the turn rate w of the horizontal velocity. Between two
 * positions the velocity turns by w dt, and white noise is added to the acceleration and to the
 * derivative of w. Constant velocity is the same with w known to be 0.
 *
 * Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and
 * Navigation", 2001 (discretised continuous white noise acceleration; coordinated turn with unknown
 * rate).
 * Differs: noise of the acceleration of a turn is that of straight flight, in all directions.
 * Valid: the extended filter is of first order: turns of less than about a right angle between two
 * positions.
 * Test: TestMotionFilter.cxx; TestTracker.py against a filter in NumPy.
 */
#ifndef avianlidar_MotionFilter_h
#define avianlidar_MotionFilter_h

#include "Vector.h"

#include <glm/mat3x3.hpp>

#include <array>

namespace avianlidar
{
struct MotionModel
{
  double accelerationDensity = 0.0; ///< m2/s3
  double turnRateDensity = 0.0;     ///< rad2/s3
  double speedError = 0.0;          ///< m/s, of the unknown velocity of a new target along x and y
  double climbError = 0.0;          ///< m/s, the same along z
  double turnRateError = 0.0;       ///< rad/s, of its turn rate; 0: it flies straight
};

struct MotionState
{
  static constexpr std::size_t Size = 7;
  using Row = std::array<double, Size>;

  Row mean{}; ///< x, y, z m, their velocities m/s, turn rate rad/s
  std::array<Row, Size> covariance{};

  Vec3 position() const { return { this->mean[0], this->mean[1], this->mean[2] }; }
  Vec3 velocity() const { return { this->mean[3], this->mean[4], this->mean[5] }; }
};

/// What a position says of a target: the square of its distance from the one predicted, in standard
/// deviations, and the logarithm of the determinant of the covariance (m6) of their difference.
struct Innovation
{
  double distanceSquare;
  double logDeterminant;
};

/// A new target. @param error covariance of the position, m2
MotionState startMotion(const Vec3& position, const glm::dmat3& error, const MotionModel& model);

/// The same `seconds` later, at least 0.
MotionState predicted(const MotionState& state, double seconds, const MotionModel& model);

Innovation innovationOf(const MotionState& state, const Vec3& position, const glm::dmat3& error);

/// The same after its position was measured.
MotionState updated(const MotionState& state, const Vec3& position, const glm::dmat3& error);

/// The square of the distance, in standard deviations, that a share of three-dimensional normal
/// numbers does not exceed: the quantile of chi square of three degrees.
double normalDistanceSquare(double share);
}

#endif
