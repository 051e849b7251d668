// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PrincipalAxes.h
 * @brief Principal axes of a set of vectors: second moments, and the eigenvectors of a symmetric
 * matrix by cyclic Jacobi rotations.
 *
 * Source: G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed., Sec. 8.5.
 * Valid: any numbers; see principalAxes() for those that are not finite.
 * Test: TestBoundingVolume.cxx.
 */
#ifndef avianlidar_PrincipalAxes_h
#define avianlidar_PrincipalAxes_h

#include "Vector.h"

#include <array>

namespace avianlidar
{
/// Sum of the products of two components over vectors: xx, xy, xz, yy, yz, zz.
struct SecondMoments
{
  std::array<double, 6> sums{};
  void add(const Vec3& d)
  {
    this->sums[0] += d.x * d.x;
    this->sums[1] += d.x * d.y;
    this->sums[2] += d.x * d.z;
    this->sums[3] += d.y * d.y;
    this->sums[4] += d.y * d.z;
    this->sums[5] += d.z * d.z;
  }
};

/// Eigenvectors (orthonormal, right-handed, of decreasing eigenvalue) of a symmetric matrix given
/// by its upper half xx, xy, xz, yy, yz, zz; cyclic Jacobi. The coordinate axes if the matrix is
/// zero or not finite.
std::array<Vec3, 3> principalAxes(const std::array<double, 6>& covariance);
}

#endif
