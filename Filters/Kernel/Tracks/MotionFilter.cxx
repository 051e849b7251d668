// SPDX-License-Identifier: BSD-3-Clause
#include "MotionFilter.h"

#include <glm/matrix.hpp>

namespace avianlidar
{
namespace
{
constexpr std::size_t Size = MotionState::Size;
constexpr std::size_t Turn = 6; // index of the turn rate
using Matrix = std::array<MotionState::Row, Size>;

glm::dmat3 differenceError(const MotionState& state, const glm::dmat3& error)
{
  glm::dmat3 sum = error;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      sum[i][j] += state.covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  return sum;
}

/// Moves the mean by `seconds`. @return derivatives of the new mean with respect to the old one
Matrix move(MotionState::Row& mean, double seconds)
{
  const double rate = mean[Turn];
  const double angle = rate * seconds;
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  // Distances that a unit of velocity covers along itself and to its left, and their derivatives
  // with respect to the rate. Small angles take series with a relative error of 1e-13.
  const bool small = std::fabs(angle) < 1e-3;
  const double along = small ? seconds * (1.0 - angle * angle / 6.0) : sine / rate;
  const double across =
    small ? seconds * angle * (0.5 - angle * angle / 24.0) : (1.0 - cosine) / rate;
  const double square = seconds * seconds;
  const double alongByRate = small ? -square * angle * (1.0 / 3.0 - angle * angle / 30.0)
                                   : (seconds * cosine - along) / rate;
  const double acrossByRate =
    small ? square * (0.5 - angle * angle / 8.0) : (seconds * sine - across) / rate;
  const double vx = mean[3];
  const double vy = mean[4];
  Matrix derivatives{};
  for (std::size_t i = 0; i < Size; ++i)
  {
    derivatives[i][i] = 1.0;
  }
  derivatives[0][3] = derivatives[1][4] = along;
  derivatives[0][4] = -across;
  derivatives[1][3] = across;
  derivatives[2][5] = seconds;
  derivatives[3][3] = derivatives[4][4] = cosine;
  derivatives[3][4] = -sine;
  derivatives[4][3] = sine;
  derivatives[0][Turn] = alongByRate * vx - acrossByRate * vy;
  derivatives[1][Turn] = acrossByRate * vx + alongByRate * vy;
  derivatives[3][Turn] = -seconds * (sine * vx + cosine * vy);
  derivatives[4][Turn] = seconds * (cosine * vx - sine * vy);
  mean[0] += along * vx - across * vy;
  mean[1] += across * vx + along * vy;
  mean[2] += seconds * mean[5];
  mean[3] = cosine * vx - sine * vy;
  mean[4] = sine * vx + cosine * vy;
  return derivatives;
}
}

MotionState startMotion(const Vec3& position, const glm::dmat3& error, const MotionModel& model)
{
  MotionState state;
  for (int i = 0; i < 3; ++i)
  {
    state.mean[static_cast<std::size_t>(i)] = position[i];
  }
  const glm::dmat3 sum = differenceError(state, error);
  for (std::size_t i = 0; i < 3; ++i)
  {
    for (std::size_t j = 0; j < 3; ++j)
    {
      state.covariance[i][j] = sum[static_cast<int>(i)][static_cast<int>(j)];
    }
  }
  state.covariance[3][3] = state.covariance[4][4] = model.speedError * model.speedError;
  state.covariance[5][5] = model.climbError * model.climbError;
  state.covariance[Turn][Turn] = model.turnRateError * model.turnRateError;
  return state;
}

MotionState predicted(const MotionState& state, double seconds, const MotionModel& model)
{
  MotionState later;
  later.mean = state.mean;
  const Matrix f = move(later.mean, seconds);
  Matrix half{};
  for (std::size_t i = 0; i < Size; ++i)
  {
    for (std::size_t j = 0; j < Size; ++j)
    {
      for (std::size_t k = 0; k < Size; ++k)
      {
        half[i][j] += f[i][k] * state.covariance[k][j];
      }
    }
  }
  for (std::size_t i = 0; i < Size; ++i)
  {
    for (std::size_t j = 0; j <= i; ++j)
    {
      for (std::size_t k = 0; k < Size; ++k)
      {
        later.covariance[i][j] += half[i][k] * f[j][k];
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double noise = model.accelerationDensity * seconds;
    later.covariance[axis][axis] += noise * seconds * seconds / 3.0;
    later.covariance[axis + 3][axis] += noise * seconds / 2.0;
    later.covariance[axis + 3][axis + 3] += noise;
  }
  later.covariance[Turn][Turn] += model.turnRateDensity * seconds;
  for (std::size_t i = 0; i < Size; ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      later.covariance[j][i] = later.covariance[i][j];
    }
  }
  return later;
}

Innovation innovationOf(const MotionState& state, const Vec3& position, const glm::dmat3& error)
{
  const glm::dmat3 sum = differenceError(state, error);
  const Vec3 difference = position - state.position();
  return { glm::dot(difference, glm::inverse(sum) * difference), std::log(glm::determinant(sum)) };
}

MotionState updated(const MotionState& state, const Vec3& position, const glm::dmat3& error)
{
  const glm::dmat3 inverse = glm::inverse(differenceError(state, error));
  const Vec3 difference = position - state.position();
  std::array<Vec3, Size> gains;
  MotionState better = state;
  for (std::size_t i = 0; i < Size; ++i)
  {
    const MotionState::Row& row = state.covariance[i];
    gains[i] = inverse * Vec3(row[0], row[1], row[2]);
    better.mean[i] += glm::dot(gains[i], difference);
  }
  for (std::size_t i = 0; i < Size; ++i)
  {
    for (std::size_t j = 0; j <= i; ++j)
    {
      const MotionState::Row& row = state.covariance[j];
      better.covariance[i][j] -= glm::dot(gains[i], Vec3(row[0], row[1], row[2]));
      better.covariance[j][i] = better.covariance[i][j];
    }
  }
  return better;
}

double normalDistanceSquare(double share)
{
  double least = 0.0;
  double most = 1000.0;
  for (int i = 0; i < 100; ++i)
  {
    const double x = 0.5 * (least + most);
    const bool below =
      std::erf(std::sqrt(0.5 * x)) - std::sqrt(2.0 * x / Pi) * std::exp(-0.5 * x) < share;
    (below ? least : most) = x;
  }
  return 0.5 * (least + most);
}
}
