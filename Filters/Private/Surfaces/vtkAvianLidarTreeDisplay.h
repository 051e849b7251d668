// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTreeDisplay.h
 * @brief Makes a surface of the bounding volumes of one level of a collision tree, for display. Not
 * installed.
 */
#ifndef vtkAvianLidarTreeDisplay_h
#define vtkAvianLidarTreeDisplay_h

#include "CollisionTree.h"

class vtkPolyData;

/// Fill `display` with the volumes of the nodes at depth `level`, and of the leaves above this
/// depth; `display` stays empty for level < 0. Cell arrays `node_id`, `triangles`, `depth` (the
/// active scalars), all int.
void vtkAvianLidarMakeTreeDisplay(
  const avianlidar::CollisionTree& tree, int level, vtkPolyData* display);

#endif
