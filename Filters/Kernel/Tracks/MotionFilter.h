// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MotionFilter.h
 * @brief Estimates position and velocity of a target from positions with errors: a Kalman filter
 * for constant velocity, or an extended Kalman filter for a coordinated turn.
 *
 * The state is position, velocity and the turn rate w of the horizontal velocity. In the time dt
 * between two positions, the velocity turns by w dt. White noise is added to the acceleration and
 * to the derivative of w. Constant velocity is a turn with the rate 0.
 *
 * Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and
 * Navigation", 2001 (discretised continuous white noise acceleration; coordinated turn with unknown
 * rate).
 * Differs: acceleration in a turn has the noise of straight flight, in all directions.
 * Valid: turns of less than about a right angle between two positions, because the extended filter
 * is of first order.
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
  double accelerationDensity = 0.0; ///< spectral density of the acceleration noise, m2/s3
  double turnRateDensity = 0.0;     ///< spectral density of the noise of turn acceleration, rad2/s3
  double speedError = 0.0;    ///< standard deviation of a new target's velocity along x and y, m/s
  double climbError = 0.0;    ///< standard deviation of a new target's velocity along z, m/s
  double turnRateError = 0.0; ///< standard deviation of a new turn rate, rad/s; 0: straight flight
};

struct MotionState
{
  static constexpr std::size_t Size = 7;
  using Row = std::array<double, Size>;

  Row mean{}; ///< x, y, z in m, their velocities in m/s, turn rate in rad/s
  std::array<Row, Size> covariance{};

  Vec3 position() const { return { this->mean[0], this->mean[1], this->mean[2] }; }
  Vec3 velocity() const { return { this->mean[3], this->mean[4], this->mean[5] }; }
};

/// Difference between measured and predicted position: the squared length of the difference in
/// standard deviations, and the logarithm of the determinant of the covariance (m6).
struct Innovation
{
  double distanceSquare;
  double logDeterminant;
};

/// State of a new target. @param error covariance of the position, m2
MotionState startMotion(const Vec3& position, const glm::dmat3& error, const MotionModel& model);

/// State after `seconds` s, at least 0.
MotionState predicted(const MotionState& state, double seconds, const MotionModel& model);

Innovation innovationOf(const MotionState& state, const Vec3& position, const glm::dmat3& error);

/// State after a position was measured. @param error covariance of the position, m2
MotionState updated(const MotionState& state, const Vec3& position, const glm::dmat3& error);

/// Squared distance, in standard deviations, that a share of three-dimensional normal numbers does
/// not exceed: the quantile of chi square with three degrees of freedom.
double normalDistanceSquare(double share);
}

#endif
