// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceState.h
 * @brief Computes hashes of surfaces, which ranks and movers compare. Not installed.
 */
#ifndef vtkAvianLidarSurfaceState_h
#define vtkAvianLidarSurfaceState_h

#include <cstdint>

class vtkFieldData;
class vtkPolyData;

namespace vtkAvianLidarSurfaceState
{
/// Hash of the names of objects and materials, and of the classes of objects. @param seed hash to
/// continue
std::uint64_t HashOfNames(vtkFieldData* fields, std::uint64_t seed);

/// Hash of everything that vtkAvianLidarSurfaces::Merge() reads of a vtkPolyData.
std::uint64_t HashOf(vtkPolyData* poly);
}

#endif
