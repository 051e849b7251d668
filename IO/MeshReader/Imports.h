// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Imports.h
 * @brief The two libraries that read mesh files.
 */
#ifndef AvianLidarImports_h
#define AvianLidarImports_h

#include "SceneTypes.h"

#include <cmath>

class vtkDataSet;

namespace avianlidar::scene
{
/// What a file holds, before points are merged. Throws Error or std::bad_alloc.
Mesh ReadAssimpMesh(const std::string& file);
Mesh ReadVtkMesh(const std::string& file);

/**
 * Cells must name points that are there, as many as their type has, and a polyhedron's faces too.
 * Cells of variable order (Lagrange, Bezier, parametric) are refused. Grids must have the points
 * that their dimensions say. O(points of cells).
 *
 * Throws Error, which says what is wrong.
 */
void CheckCells(vtkDataSet* data);
/// The distance between a number of single precision and the next one.
inline double SpacingAt(double number)
{
  const auto single = static_cast<float>(std::abs(number));
  return std::nextafter(single, HUGE_VALF) - single;
}
}

#endif
