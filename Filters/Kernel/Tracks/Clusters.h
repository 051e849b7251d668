// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Clusters.h
 * @brief Clusters of a scan's points: connected components by a distance that grows with range.
 *
 * Two points are neighbours if they are at most `distance` + `angle` (r1 + r2) / 2 apart, with r1
 * and r2 their ranges. The distance between echoes of one target in neighbouring beams is the angle
 * between the beams times the range. Points lie in grids whose cells are about as large as the
 * distance of neighbours. The neighbours of a point are taken out of their cells. The neighbours of
 * each neighbour follow, until the cluster is complete. Time is about linear in the number of
 * points, also in dense clouds.
 *
 * Source: connected components of the graph of neighbours. The method is DBSCAN with clusters of
 * one point or more: M. Ester et al., "A density-based algorithm for discovering clusters", KDD
 * 1996.
 * Valid: coordinates and ranges up to 1e9 m. The order of the points changes no bit of the result.
 * Test: TestClusters.cxx.
 */
#ifndef avianlidar_Clusters_h
#define avianlidar_Clusters_h

#include "Vector.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
/// A point of a scan.
struct CloudPoint
{
  Vec3 position;     ///< position, m
  double time;       ///< time of the echo, s
  double rangeError; ///< standard deviation of the range, m
};

struct Cluster
{
  Vec3 center;          ///< mean position of the points, m
  double time;          ///< mean time of the points, s
  double rangeVariance; ///< variance of the range, m2, mean over the points
  int points;
};

struct Clusters
{
  std::vector<Cluster> all;         ///< sorted by x, then y, z, time
  std::vector<std::size_t> ofPoint; ///< index of each point's cluster
};

/// @param sensor origin of the ranges, m @param distance distance of neighbours at range 0, m, at
/// least 0 @param angle growth of this distance with the range, rad, 0 to 0.5
Clusters findClusters(
  const std::vector<CloudPoint>& points, const Vec3& sensor, double distance, double angle);
}

#endif
