// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarContent.h
 * @brief Finds whether data objects have changed, by modification times and hashes. Not installed.
 *
 * A program that edits values in place may call Modified() on the array, on its container, or on
 * the data object. None of these objects notifies the other two. So caches first compare the times
 * of all objects at all levels: if all times are unchanged, the data are unchanged. If one time is
 * later, caches compare the content, and keep the parts that are equal.
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
/// Data objects, each with the time at which the object or anything in it was last modified.
using State = std::vector<std::pair<const void*, vtkMTimeType>>;

/// Time at which a vtkPolyData or anything in it was last modified: fields, points, cells, their
/// arrays.
vtkMTimeType TimeOf(vtkPolyData* poly);

/// State of a vtkPolyData, or of a composite with all nodes, leaves and their names.
State StateOf(vtkDataObject* data);

/// Hash of an array, which may be null: its type, size and values. @param seed hash to continue
std::uint64_t HashOf(vtkDataArray* array, std::uint64_t seed);

/// Hash of points and cells.
std::uint64_t HashOfGeometry(vtkPolyData* poly, std::uint64_t seed);
}

#endif
