// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceState.h
 * @brief What surfaces held when they were looked at, as hashes. Not installed.
 */
#ifndef vtkAvianLidarSurfaceState_h
#define vtkAvianLidarSurfaceState_h

#include "vtkAvianLidarSurfaceLeaf.h"
#include "vtkAvianLidarSurfaces.h"

#include <cstdint>
#include <vector>

class vtkFieldData;

namespace vtkAvianLidarSurfaceState
{
using LeafState = vtkAvianLidarSurfaces::LeafState;

/// Hash of the names of objects and materials, and of the classes of objects. @param seed hash of
/// what belongs to it besides
std::uint64_t HashOfNames(vtkFieldData* fields, std::uint64_t seed);

/// Hash of all that Merge() reads of a vtkPolyData, whatever its block is called.
std::uint64_t HashOf(vtkPolyData* poly);

/// What a leaf holds; its triangles are not known yet.
LeafState StateOf(const vtkAvianLidarSurfaceLeaf& leaf, const vtkAvianLidarSurfaceArrays& arrays);

/// True if points and cells of all leaves are those of `known`.
bool IsGeometryOf(const vtkAvianLidarSurfaces& known, const std::vector<LeafState>& states);

/// True if leaves of that geometry differ from those of `known` in coefficients alone, or not at
/// all.
/// @param words hash of the names that the whole input brings @param arrays of the leaves
/// @param states of the leaves, as by StateOf(); filled in if it is true
bool IsRepaintingOf(const vtkAvianLidarSurfaces& known, std::uint64_t words,
  const std::vector<vtkAvianLidarSurfaceLeaf>& leaves,
  const std::vector<vtkAvianLidarSurfaceArrays>& arrays, std::vector<LeafState>& states);
}

#endif
