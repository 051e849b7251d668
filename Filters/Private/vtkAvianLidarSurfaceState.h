// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceState.h
 * @brief What surfaces were when they were looked at: which arrays, when they were modified, hashes
 * of names and ids. Not installed.
 */
#ifndef vtkAvianLidarSurfaceState_h
#define vtkAvianLidarSurfaceState_h

#include "vtkAvianLidarSurfaceLeaf.h"
#include "vtkAvianLidarSurfaces.h"

#include <cstdint>
#include <vector>

class vtkObject;

namespace vtkAvianLidarSurfaceState
{
using State = vtkAvianLidarSurfaces::State;
using LeafState = vtkAvianLidarSurfaces::LeafState;

/// An object, or null, and when it was modified.
void AddTo(State& state, vtkObject* object);

/// Points and cells of a leaf.
void AddGeometryTo(State& state, vtkPolyData* poly);

/// Hash of the names of objects and materials. @param seed hash of what belongs to it besides
std::uint64_t HashOfNames(vtkFieldData* fields, std::uint64_t seed);

/// Arrays of the cells of a leaf and hash of its names; the rest of the state is not filled in.
LeafState StateOf(const vtkAvianLidarSurfaceLeaf& leaf);

/// What is asked about a leaf when it has changed; its triangles are known.
void Remember(const vtkAvianLidarSurfaceLeaf& leaf, LeafState& state);

/// True if the leaves differ from those of `known` in kd, ks and kp alone.
/// @param words hash of the names that the whole input brings @param states of the leaves, as by
/// StateOf(); filled in if it is true
bool IsRepaintingOf(const vtkAvianLidarSurfaces& known, std::uint64_t words,
  const std::vector<vtkAvianLidarSurfaceLeaf>& leaves, std::vector<LeafState>& states);
}

#endif
