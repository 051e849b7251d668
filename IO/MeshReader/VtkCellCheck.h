// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VtkCellCheck.h
 * @brief Whether the cells of a data set from a file are what VTK's filters take for granted.
 */
#ifndef AvianLidarVtkCellCheck_h
#define AvianLidarVtkCellCheck_h

class vtkDataSet;

namespace avianlidar::scene
{
/**
 * Cells must name points that are there, as many as their type has, and a polyhedron's faces too.
 * Cells of variable order (Lagrange, Bezier, parametric) are refused. Grids must have the points
 * that their dimensions say. O(points of cells).
 *
 * Throws Error, which says what is wrong.
 */
void CheckCells(vtkDataSet* data);
}

#endif
