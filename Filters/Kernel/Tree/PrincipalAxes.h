// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PrincipalAxes.h
 * @brief Principal axes of a set of vectors, of their second moments (the sum of their outer
 * products).
 *
 * Source: power iteration by squaring: G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed.,
 * Sec. 8.2.
 * Valid: symmetric matrices without negative eigenvalues; see principalAxes() for others.
 * Test: TestBoundingVolume.cxx.
 */
#ifndef avianlidar_PrincipalAxes_h
#define avianlidar_PrincipalAxes_h

#include "BeamFrame.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace avianlidar
{
/// Eigenvectors (orthonormal, right-handed, of decreasing eigenvalue), in columns; the coordinate
/// axes if the matrix is zero or not finite.
inline glm::dmat3 principalAxes(const glm::dmat3& moments)
{
  // Squared again and again, the matrix tends to the projection on its first axis.
  glm::dmat3 power = moments;
  for (int step = 0; step < 40; ++step)
  {
    power /= power[0][0] + power[1][1] + power[2][2];
    power = power * power;
  }
  const int longest = power[0][0] >= power[1][1] ? (power[0][0] >= power[2][2] ? 0 : 2)
                                                 : (power[1][1] >= power[2][2] ? 1 : 2);
  if (!(power[longest][longest] > 0.0))
  {
    return glm::dmat3(1.0);
  }
  // In the plane across it the other two are at an angle that is known in closed form.
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), power[longest], 1.0);
  const Vec3 one = moments * frame.e1;
  const Vec3 two = moments * frame.e2;
  const double angle = 0.5 *
    std::atan2(2.0 * glm::dot(frame.e2, one), glm::dot(frame.e1, one) - glm::dot(frame.e2, two));
  const Vec3 second = std::cos(angle) * frame.e1 + std::sin(angle) * frame.e2;
  return { frame.axis, second, glm::cross(frame.axis, second) };
}
}

#endif
