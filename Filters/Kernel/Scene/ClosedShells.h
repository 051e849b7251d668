// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ClosedShells.h
 * @brief Finds the closed shells of a set of triangles and makes each face outward.
 *
 * At each edge triangles are paired, and paired triangles belong to one shell. If more than two
 * share an edge, two that name the same given points are paired first, and the others are paired by
 * their angle about the edge. Bodies that touch thus become shells of their own, or one shell that
 * is closed all the same. A shell faces outward, except a hole: a shell inside another one and
 * wound the other way.
 * Source: none.
 * Valid: finite points; corners with equal coordinates are one point. Some 32 triangles of a shell
 * decide whether it lies inside another one.
 * Test: TestClosedShells.cxx.
 */
#ifndef avianlidar_ClosedShells_h
#define avianlidar_ClosedShells_h

#include "TriangleMesh.h"

#include <string>

namespace avianlidar
{
/// The same surface with merged points and without triangles that have two equal corners.
/// @param problem receives what is wrong with the surface; the result is then empty
TriangleMesh closedShells(const TriangleMesh& mesh, std::string& problem);
}

#endif
