// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaces.h
 * @brief Surfaces as the kernel wants them: any vtkPolyData or composite of them becomes one
 * triangle mesh with a material on every triangle. Used by the collision tree and the echo filter;
 * not installed.
 */
#ifndef vtkAvianLidarSurfaces_h
#define vtkAvianLidarSurfaces_h

#include "Reflectance.h"
#include "TriangleMesh.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

class vtkDataObject;
class vtkFieldData;
class vtkPolyData;

/// The merged scene. `problem` is set, and nothing else is to be used, when the input was bad.
struct vtkAvianLidarSurfaces
{
  std::shared_ptr<const avianlidar::TriangleMesh> mesh;
  std::vector<avianlidar::Material> materials; ///< one per triangle
  std::vector<int> objectIds;                  ///< one per triangle
  std::vector<int> materialIds;                ///< one per triangle
  std::vector<std::string> objectNames;        ///< by object id
  std::vector<std::string> materialNames;      ///< by material id
  std::string problem;                         ///< what is wrong with the input, and where
  std::string advice;                          ///< suspicious but usable: to be said once per scene

  /// Merge every vtkPolyData of `input` (itself or the leaves of a composite) in leaf order.
  /// Ghost cells, vertices and lines are skipped; polygons and strips are triangulated.
  static vtkAvianLidarSurfaces Merge(vtkDataObject* input);

  /// Which data objects `input` consists of and when each was last modified: unchanged means
  /// nothing was modified. Empty if it is not known.
  static std::vector<std::pair<const void*, vtkMTimeType>> StateOf(vtkDataObject* input);

  /// The same as one vtkPolyData: double points, triangles, the five cell arrays, names and the
  /// input's other field data.
  vtkSmartPointer<vtkPolyData> ToPolyData(vtkDataObject* input) const;
};

#endif
