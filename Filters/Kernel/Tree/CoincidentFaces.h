// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoincidentFaces.h
 * @brief Finds triangles that lie on each other, and gives them one plane, so that rounding does
 * not decide which of them is seen.
 *
 * Two triangles coincide if they overlap and are nowhere in their overlap farther apart than the
 * rounding of their corners: 32 u_d (sixteen roundings to double precision) of the largest
 * coordinate of each and, if all its coordinates are numbers in single precision, 4 u of that, at
 * most half a millimetre. All that coincide, directly or by others, take the plane of the one whose
 * least altitude is largest, as rounding tilts it least. Rays then have equal ranges on them, bit
 * for bit, and equal ranges go to the lower triangle number.
 *
 * Pairs are found by a descent of the tree against itself.
 *
 * Source: none.
 * Valid: any triangles. Depends on the mesh alone, not on the tree or the threads. A triangle that
 * lies farther from the common plane than rounding explains keeps its own.
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
/// Set planeOwners and planeDepth. @param tree wide, complete but for these @return false if
/// stopped
bool findPlaneOwners(CollisionTree& tree, int threads, const KeepGoing& keepGoing);
}

#endif
