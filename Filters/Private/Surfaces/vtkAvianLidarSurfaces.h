// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaces.h
 * @brief Converts surfaces for the kernel: any vtkPolyData or composite of vtkPolyData becomes one
 * triangle mesh with a material on every triangle. The collision tree and the echo filter use this
 * mesh. Not installed.
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

/// The merged scene. If the input was bad, `problem` is set, and no other member is valid.
struct vtkAvianLidarSurfaces
{
  std::shared_ptr<const avianlidar::TriangleMesh> mesh;
  std::uint64_t checksum = 0; ///< checksum of the mesh
  std::uint64_t geometry = 0; ///< hash of the input apart from its materials
  std::shared_ptr<const std::vector<std::uint32_t>>
    order; ///< order of triangles (TriangleOrder.h); null or empty: as given
  avianlidar::SharedVector<avianlidar::Material> materials; ///< material of each triangle
  avianlidar::SharedVector<int> objectIds;                  ///< object id of each triangle
  avianlidar::SharedVector<int> materialIds;                ///< material id of each triangle
  std::vector<std::string> objectNames;                     ///< names by object id
  std::vector<std::string> objectClasses;                   ///< classes by object id, if any
  std::vector<std::string> materialNames;                   ///< names by material id
  std::vector<std::string> media; ///< texts of media (vtkAvianLidarMedia.h), which are not surfaces
  struct Range
  {
    std::size_t begin, end; ///< first triangle, and triangle after the last
  };
  std::vector<Range> leaves; ///< triangles of each leaf if triangles keep their order
  std::string problem;       ///< error text of bad input, with the place; empty: no error
  std::string warning;       ///< warning about suspicious input, to be given once per scene

  /// Merge every vtkPolyData of `input` (`input` itself or the leaves of a composite). Triangles
  /// are sorted (TriangleOrder.h), so that surfaces give the same echoes however they are divided.
  /// Ghost cells, vertices and lines are skipped. Polygons and strips are triangulated. Merging the
  /// result of ToPolyData() gives the same scene.
  /// @param known earlier result, may be null, whose mesh is shared if the geometry is equal.
  /// Edited coefficients of a large scene are then merged several times faster.
  /// @param threads number of threads that check the leaves; 0: all threads
  static vtkAvianLidarSurfaces Merge(
    vtkDataObject* input, const vtkAvianLidarSurfaces* known = nullptr, int threads = 0);

  /// Merge leaves that were collected already. @param fields field data of the whole scene, may be
  /// null @param keepsOrder if true, triangles are in the order of leaves and cells
  static vtkAvianLidarSurfaces Merge(const std::vector<vtkAvianLidarSurfaceLeaf>& leaves,
    vtkFieldData* fields, const vtkAvianLidarSurfaces* known, int threads, bool keepsOrder);

  /// Hash of mesh, materials, ids and media.
  std::uint64_t Hash() const;

  /// The merged scene as one vtkPolyData: points in double precision, triangles, ids and
  /// coefficients, names, and `fields` if not null. @param input surfaces of this rank, with which
  /// arrays are shared if they are slices (vtkAvianLidarSlices.h)
  vtkSmartPointer<vtkPolyData> ToPolyData(vtkFieldData* fields, vtkDataObject* input) const;

  /// A warning that names objects whose faces coincide; empty if no faces coincide. @param pairs
  /// pairs of coincident triangles, the visible triangle first
  std::string WarningOnCoincidence(
    const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const;
};

#endif
