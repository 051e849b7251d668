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
#include "SharedVector.h"
#include "TriangleMesh.h"

#include "vtkSmartPointer.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

class vtkDataObject;
class vtkFieldData;
class vtkPolyData;
struct vtkAvianLidarSurfaceLeaf;

/// The merged scene. `problem` is set, and nothing else is to be used, when the input was bad.
struct vtkAvianLidarSurfaces
{
  std::shared_ptr<const avianlidar::TriangleMesh> mesh;
  std::uint64_t checksum = 0;                               ///< of the mesh
  avianlidar::SharedVector<avianlidar::Material> materials; ///< one per triangle
  avianlidar::SharedVector<int> objectIds;                  ///< one per triangle
  avianlidar::SharedVector<int> materialIds;                ///< one per triangle
  std::vector<std::string> objectNames;                     ///< by object id
  std::vector<std::string> objectClasses;                   ///< likewise; empty: none brings any
  std::vector<std::string> materialNames;                   ///< by material id
  std::vector<std::string> media; ///< texts (vtkAvianLidarMedia.h), which are no surfaces
  /// What a leaf held when its triangles were taken, to see what a change leaves as it was.
  struct LeafState
  {
    std::uint64_t words;        ///< hash of its name and the texts of its objects and materials
    std::uint64_t geometry;     ///< hash of points, cells and ghosts
    std::uint64_t ids;          ///< hash of its ids
    std::uint64_t coefficients; ///< hash of those of its materials
    std::size_t begin;          ///< triangles [begin, end)
    std::size_t end;
    bool plain; ///< its cells are these triangles, one by one, and have materials
  };
  std::vector<LeafState> leaves;
  std::uint64_t words = 0; ///< hash of the texts that the whole input brings
  std::string problem;     ///< what is wrong with the input, and where
  std::string warning;     ///< suspicious but usable: to be said once per scene

  /// Merge every vtkPolyData of `input` (itself or the leaves of a composite) in leaf order.
  /// Ghost cells, vertices and lines are skipped; polygons and strips are triangulated.
  /// @param known an earlier result: its mesh is taken if points and cells are the same, and of its
  /// materials and ids what has the same values. If nothing but materials of some leaves changed,
  /// their cells alone are merged anew @param threads that look at the leaves, > 0, or 0 for all
  static vtkAvianLidarSurfaces Merge(
    vtkDataObject* input, const vtkAvianLidarSurfaces* known = nullptr, int threads = 0);

  /// The same of leaves that were collected already. @param fields that come with all of them, may
  /// be null
  static vtkAvianLidarSurfaces Merge(const std::vector<vtkAvianLidarSurfaceLeaf>& leaves,
    vtkFieldData* fields, const vtkAvianLidarSurfaces* known = nullptr, int threads = 0);

  /// The same as one vtkPolyData: double points, triangles, ids and coefficients, names and
  /// `fields` besides, if not null.
  vtkSmartPointer<vtkPolyData> ToPolyData(vtkFieldData* fields) const;

  /// A warning that names objects whose faces coincide; empty without any. @param pairs of
  /// triangles, the first of each is seen
  std::string WarningOnCoincidence(
    const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const;

  /// What Merge() would make of ToPolyData().
  vtkAvianLidarSurfaces MergedAgain() const;
};

#endif
