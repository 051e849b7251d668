// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTriangles.h
 * @brief Divides polygons and strips into triangles. Not installed.
 */
#ifndef vtkAvianLidarTriangles_h
#define vtkAvianLidarTriangles_h

#include "vtkSmartPointer.h"

#include <string>

class vtkDataArray;
class vtkPolyData;

/// The points and field data of `data`, and triangles with cell arrays: first the triangles of
/// polygons (PolygonTriangulation.h), then of strips. Points at which edges of a polygon cross are
/// added. Cells of fewer than three points and polygons without area give no triangles.
/// @param warning becomes a sentence about polygons that cross or overlap themselves, or empty
/// @param names numbers of cells for the sentence; null: indices in `data`
vtkSmartPointer<vtkPolyData> vtkAvianLidarTriangles(
  vtkPolyData* data, std::string* warning = nullptr, vtkDataArray* names = nullptr);

#endif
