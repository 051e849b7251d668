// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarContent.h
 * @brief What data objects hold, and when it was modified. Not installed.
 *
 * Whoever edits values in place may call Modified() on the array, on what holds it, or on the data
 * object: none of them tells the others. So caches look at times first, of everything at any level:
 * where all are those of the time before, nothing has changed. Where one is later, they look at the
 * content, and keep what is the same.
 */
#ifndef vtkAvianLidarContent_h
#define vtkAvianLidarContent_h

#include "vtkType.h"

#include <cstdint>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkDataObject;
class vtkPolyData;

namespace vtkAvianLidarContent
{
/// Data objects and when each, or anything in it, was last modified.
using State = std::vector<std::pair<const void*, vtkMTimeType>>;

/// When a vtkPolyData or anything in it was last modified: fields, points, cells, their arrays.
vtkMTimeType TimeOf(vtkPolyData* poly);

/// A vtkPolyData, or a composite with all nodes, leaves and their names. Empty for want of memory:
/// ranks ask it on their own before they agree.
State StateOf(vtkDataObject* data);

/// Hash of an array, may be null: its type, size and values. @param seed the hash of what comes
/// before
std::uint64_t HashOf(vtkDataArray* array, std::uint64_t seed);

/// Hash of points and cells.
std::uint64_t HashOfGeometry(vtkPolyData* poly, std::uint64_t seed);
}

#endif
