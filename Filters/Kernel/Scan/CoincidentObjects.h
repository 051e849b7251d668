// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoincidentObjects.h
 * @brief Which objects a scan sees that lie on other objects, so that their numbers alone decide
 * which of them is seen.
 *
 * One ray goes to the centroid of each triangle of a plane on which faces coincide (at most
 * MostRaysOfPlane, evenly chosen) and, if it ends on such a triangle, another one behind that.
 * Faces that coincide behind others, as two buildings with a common wall have them, do not count.
 *
 * Source: none.
 * Valid: names what rays to centroids find, not everything.
 * Test: TestCoincidentFaces.cxx.
 */
#ifndef avianlidar_CoincidentObjects_h
#define avianlidar_CoincidentObjects_h

#include "BeamTrace.h"
#include "ScanSetup.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace avianlidar
{
/// A plane (CollisionTree::planeOwners) and a beam that sees a triangle of it.
struct SeenPlane
{
  std::uint32_t owner;
  std::size_t beam;
  bool operator<(const SeenPlane& other) const
  {
    return this->owner < other.owner || (this->owner == other.owner && this->beam < other.beam);
  }
};

/// Append the planes of faces that coincide and that a beam sees.
void addSeenPlanes(const CollisionTree& tree, const BeamTrace& trace, std::size_t beam,
  std::vector<SeenPlane>& planes);

/// Sort, and leave the first beam of each plane.
void sortSeenPlanes(std::vector<SeenPlane>& planes);

/// Triangles that coincide and differ in object or material: one that is seen, and one on the same
/// place that is not.
using CoincidentPair = std::pair<std::uint32_t, std::uint32_t>;

/// One pair for each pair of objects, in their order. @param planes sorted
std::vector<CoincidentPair> findCoincidentObjects(
  const ScanSetup& setup, const ScanBeams& beams, const std::vector<SeenPlane>& planes);
}

#endif
