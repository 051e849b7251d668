// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTriangles.h
 * @brief Triangles of polygons and strips. Not installed.
 */
#ifndef vtkAvianLidarTriangles_h
#define vtkAvianLidarTriangles_h

#include "vtkSmartPointer.h"

class vtkPolyData;

/// The points, the triangles of polygons, then of strips, with the arrays of their cells, and the
/// field data. Cells of less than three points have none.
vtkSmartPointer<vtkPolyData> vtkAvianLidarTriangles(vtkPolyData* data);

#endif
