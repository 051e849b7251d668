// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoincidentFaces.h
 * @brief Finds triangles that coincide and gives them one plane, so that rounding does not decide
 * which triangle is seen.
 *
 * Two triangles coincide if they overlap and their distance nowhere in the overlap exceeds the sum
 * of their tolerances. A triangle's tolerance is the rounding of its corners: 32 u_d (sixteen
 * roundings to double precision) times the largest coordinate, with u_d = 2^-53. If all coordinates
 * of the triangle are numbers of single precision, the tolerance grows by 4 u_s times the largest
 * coordinates, projected on the triangle's normal, with u_s = 2^-24. The growth is at most half a
 * millimetre.
 *
 * Pairs are found by descending the tree against itself. Triangles that coincide, directly or by a
 * chain of coincident triangles, then take the plane of the triangle whose least altitude is
 * largest, because rounding tilts this plane least. The ranges of a ray on coincident triangles are
 * equal bit for bit, and the triangle with the lowest number is seen.
 *
 * Source: none.
 * Valid: any triangles. The result depends only on the mesh, not on the tree or the threads. A
 * triangle that lies farther from the common plane than rounding explains keeps its own plane.
 * Test: TestCoincidentFaces.cxx.
 */
#ifndef avianlidar_CoincidentFaces_h
#define avianlidar_CoincidentFaces_h

#include "CollisionTree.h"
#include "ParallelLoop.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Set planeOwners and planeDepth of an otherwise complete wide tree. @return false if `keepGoing`
/// returned false
bool findPlaneOwners(CollisionTree& tree, int threads, const KeepGoing& keepGoing);
}

#endif
