// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ClosedShells.h
 * @brief Closed shells of a set of triangles, each facing outward, whichever way the triangles
 * wind.
 *
 * Triangles that share an edge belong to one shell. Where more than two share it, those that name
 * the same two points do if they are two; the others are paired by their angle about the edge, so
 * that bodies which touch are shells of their own or one shell that is closed all the same. A shell
 * faces outward, except a hole: a shell inside another one that is wound the other way.
 *
 * Source: none.
 * Valid: finite points; corners with equal coordinates are one point. Whether a shell is inside
 * another is asked of some 32 of its triangles.
 * Test: TestClosedShells.cxx.
 */
#ifndef avianlidar_ClosedShells_h
#define avianlidar_ClosedShells_h

#include "TriangleMesh.h"

#include <string>

namespace avianlidar
{
/// The same surface with merged points, without triangles of which two corners are one.
/// @param problem receives what is wrong with the surface, which is then empty
TriangleMesh closedShells(const TriangleMesh& mesh, std::string& problem);
}

#endif
