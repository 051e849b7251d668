// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ClosedShells.h
 * @brief Finds the closed shells of a set of triangles, and turns the triangles of each shell
 * outward.
 *
 * Triangles are paired at each edge. Paired triangles belong to one shell. If more than two
 * triangles share an edge, triangles that name the same given points are paired first. The other
 * triangles are paired by their angle about the edge. Thus bodies that touch become separate shells
 * or one closed shell. All shells face outward, except holes. A hole is a shell inside another
 * shell, and its triangles face inward.
 * Source: none.
 * Valid: finite points. Corners with equal coordinates are one point. About 32 triangles of a shell
 * decide whether the shell lies inside another shell.
 * Test: TestClosedShells.cxx.
 */
#ifndef avianlidar_ClosedShells_h
#define avianlidar_ClosedShells_h

#include "TriangleMesh.h"

#include <string>

namespace avianlidar
{
/// The surface with merged points and without triangles that have two equal corners.
/// @param problem receives what is wrong with the surface; if anything is wrong, the result is
/// empty
TriangleMesh closedShells(const TriangleMesh& mesh, std::string& problem);
}

#endif
