// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfacePart.h
 * @brief Part of one block of a scene as it goes from rank to rank. Not installed.
 *
 * A part in lean form has triangles alone, no ghost cells, and of the arrays those that a scene is
 * merged from: a vtkPolyData with any subset of the cell arrays object_id, material_id (int), kd,
 * ks, kp (double), and the field arrays object_names and material_names.
 */
#ifndef vtkAvianLidarSurfacePart_h
#define vtkAvianLidarSurfacePart_h

#include "vtkAvianLidarSurfaceLeaf.h"

#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <vector>

class vtkAvianLidarByteReader;
class vtkAvianLidarByteWriter;

namespace vtkAvianLidarSurfacePart
{
/// True if it has a triangle that is no ghost.
bool HasTriangles(const vtkAvianLidarSurfaceLeaf& leaf);

/// In lean form; the leaf's own data where that is lean already, but for arrays nobody reads.
vtkSmartPointer<vtkPolyData> Lean(const vtkAvianLidarSurfaceLeaf& leaf);

/// Write what is in lean form, and read it.
void Write(vtkPolyData* part, vtkAvianLidarByteWriter& bytes);
vtkSmartPointer<vtkPolyData> Read(vtkAvianLidarByteReader& bytes);

/// True if both have the same arrays and names, so that they can be one block.
bool AreAlike(vtkPolyData* one, vtkPolyData* other);

/// Parts that are alike as one, in their order.
vtkSmartPointer<vtkPolyData> Join(const std::vector<vtkPolyData*>& parts);
}

#endif
