// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PrincipalAxes.h
 * @brief Principal axes of a set of vectors, from their second moments (the sum of their outer
 * products).
 *
 * Source: power iteration by squaring: G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed.,
 * Sec. 8.2.
 * Valid: symmetric matrices without negative eigenvalues; see principalAxes() for other matrices.
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
  const glm::dmat3 scaled = moments / (moments[0][0] + moments[1][1] + moments[2][2]);
  glm::dmat3 power = scaled;
  for (int step = 0; step < 40; ++step)
  {
    power = power * power;
    power /= power[0][0] + power[1][1] + power[2][2];
  }
  const int longest = power[0][0] >= power[1][1] ? (power[0][0] >= power[2][2] ? 0 : 2)
                                                 : (power[1][1] >= power[2][2] ? 1 : 2);
  if (!(power[longest][longest] > 0.0))
  {
    return glm::dmat3(1.0);
  }
  // In the plane across the first axis, the angle of the two other axes has a closed form.
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), power[longest], 1.0);
  const Vec3 one = scaled * frame.e1;
  const Vec3 two = scaled * frame.e2;
  // Half of the angle with this sine and cosine, from square roots only, because square roots have
  // equal bits in every mathematical library.
  const double sine = 2.0 * glm::dot(frame.e2, one);
  const double cosine = glm::dot(frame.e1, one) - glm::dot(frame.e2, two);
  const double length = std::sqrt(sine * sine + cosine * cosine);
  const double larger = std::sqrt(0.5 * (length + std::fabs(cosine)));
  const double smaller = larger > 0.0 ? 0.5 * sine / larger : 0.0;
  const Vec3 across =
    cosine >= 0.0 ? larger * frame.e1 + smaller * frame.e2 : smaller * frame.e1 + larger * frame.e2;
  const Vec3 second = larger > 0.0 ? unitVector(across) : frame.e1;
  return { frame.axis, second, glm::cross(frame.axis, second) };
}
}

#endif
