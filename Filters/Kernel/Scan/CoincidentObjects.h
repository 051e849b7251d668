// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoincidentObjects.h
 * @brief Finds the objects that a scan sees in place of other objects with coincident faces.
 *
 * Only triangle numbers decide which of two coincident faces is seen. On a plane with such faces a
 * ray goes to the centroid of each triangle (at most MostRaysOfPlane triangles, evenly chosen). If
 * the ray ends on the plane, a second ray ignores the triangle that the first ray hit. Coincident
 * faces behind other faces, such as the common wall of two buildings, do not count.
 *
 * Source: none.
 * Valid: finds only the objects that rays to centroids hit.
 * Test: TestCoincidentFaces.cxx.
 */
#ifndef avianlidar_CoincidentObjects_h
#define avianlidar_CoincidentObjects_h

#include "BeamView.h"
#include "ScanBeams.h"
#include "ScanSetup.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace avianlidar
{
/// A plane (CollisionTree::planeOwners) and a beam that sees a triangle of the plane.
struct SeenPlane
{
  std::uint32_t owner;
  std::size_t beam;
  bool operator<(const SeenPlane& other) const
  {
    return this->owner < other.owner || (this->owner == other.owner && this->beam < other.beam);
  }
};

/// Append the planes of coincident faces that a beam sees.
void addSeenPlanes(const CollisionTree& tree, const BeamView& view, std::size_t beam,
  std::vector<SeenPlane>& planes);

/// Sort planes, and keep only the first beam of each plane.
void sortSeenPlanes(std::vector<SeenPlane>& planes);

/// Coincident triangles that differ in object or material: a visible triangle, and a triangle that
/// the visible triangle hides.
using CoincidentPair = std::pair<std::uint32_t, std::uint32_t>;

/// One pair of triangles for each pair of objects, in the order of object ids. @param planes
/// planes, sorted by sortSeenPlanes()
std::vector<CoincidentPair> findCoincidentObjects(
  const ScanSetup& setup, const ScanBeams& beams, const std::vector<SeenPlane>& planes);
}

#endif
