// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTriangles.h
 * @brief Divides polygons and strips into triangles. Not installed.
 */
#ifndef vtkAvianLidarTriangles_h
#define vtkAvianLidarTriangles_h

#include "vtkSmartPointer.h"

class vtkPolyData;

/// The points and field data of `data`, and triangles with cell arrays: first the triangles of
/// polygons, then of strips. Cells of fewer than three points give no triangles.
vtkSmartPointer<vtkPolyData> vtkAvianLidarTriangles(vtkPolyData* data);

#endif
