// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Clusters.h
 * @brief Points of a scan that belong together: connected components, by a distance that grows with
 * the range.
 *
 * Two points are neighbours if they are at most distance + angle (r1 + r2) / 2 apart, r1 and r2
 * their ranges: two echoes of one target in neighbouring beams are apart by the angle between
 * these. Points lie in grids whose cells are about as large as that distance. From a point its
 * neighbours are taken out of their cells, then theirs, until a cluster is whole: about linear in
 * the number of points, in dense clouds, too.
 *
 * Source: connected components of the graph of neighbours; with one point enough for a cluster,
 * that is M. Ester et al., "A density-based algorithm for discovering clusters", KDD 1996 (DBSCAN).
 * Valid: coordinates and ranges up to 1e9 m. The same bits for any order of the points.
 * Test: TestClusters.cxx.
 */
#ifndef avianlidar_Clusters_h
#define avianlidar_Clusters_h

#include "Vector.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
/// One for each point.
struct CloudPoint
{
  Vec3 position;     ///< m
  double time;       ///< s
  double rangeError; ///< m, one standard deviation
};

struct Cluster
{
  Vec3 center;          ///< m, mean of its points
  double time;          ///< s, mean
  double rangeVariance; ///< m2, mean of a point
  int points;
};

struct Clusters
{
  std::vector<Cluster> all;         ///< by x, then y, z, time
  std::vector<std::size_t> ofPoint; ///< the cluster of each point
};

/// @param distance m, at least 0 @param angle rad, 0 to 0.5
Clusters findClusters(
  const std::vector<CloudPoint>& points, const Vec3& sensor, double distance, double angle);
}

#endif
