// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file HitComparison.h
 * @brief Do two contenders find the same hits? Asked before any time is taken.
 */
#ifndef avianlidar_HitComparison_h
#define avianlidar_HitComparison_h

#include "Workload.h"

namespace benchmarks
{
struct HitAgreement
{
  std::size_t rays = 0;
  std::size_t hits = 0;   ///< of the first
  std::size_t differ = 0; ///< range differs by more than 1e-3, relative, or only one has a hit
  std::size_t atEdges =
    0; ///< of those, rays within rounding of the boundary of one of the triangles
  /// Neither equal nor explained by the rounding of single precision at an edge, share of all rays.
  double unexplained() const
  {
    return this->rays ? static_cast<double>(this->differ - this->atEdges) / this->rays : 0.0;
  }
};

/// An edge explains a difference if the ray passes it within 1e-5 rad, or within what 16 roundings
/// of single precision at the triangle's farthest corner amount to at the hit.
HitAgreement compareHits(const Scene& scene, const Workload& work,
  const std::vector<avianlidar::Hit>& ours, const std::vector<avianlidar::Hit>& theirs);
}

#endif
