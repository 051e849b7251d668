// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScene.h
 * @brief Attaches the merged surfaces of a scene and their collision tree to a vtkPolyData, within
 * one process. Not installed.
 *
 * The field array `tree_checksum` of the vtkPolyData holds the scene in its information and, as its
 * value, the checksum of the mesh. So filters that pass field data pass the scene. A changed
 * geometry is found by its checksum.
 */
#ifndef vtkAvianLidarScene_h
#define vtkAvianLidarScene_h

#include "CollisionTree.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkObject.h"

#include <memory>

class vtkDataObject;
class vtkPolyData;

class vtkAvianLidarScene : public vtkObject
{
public:
  static vtkAvianLidarScene* New();
  vtkTypeMacro(vtkAvianLidarScene, vtkObject);

  std::shared_ptr<const vtkAvianLidarSurfaces> Surfaces;
  std::shared_ptr<const avianlidar::CollisionTree> Tree;

  /// Attach the scene to the vtkPolyData that Surfaces->ToPolyData() has filled. The vtkPolyData
  /// must not be changed afterwards.
  void AttachTo(vtkPolyData* output);

  /// Remove the scene, which would be stale with another geometry.
  static void Detach(vtkDataObject* data);

  /// The surfaces of the attached scene. Null if the scene was attached to another object, or if
  /// `data` was modified afterwards. The contents must then be compared.
  static std::shared_ptr<const vtkAvianLidarSurfaces> FindSurfaces(vtkDataObject* data);

  struct FoundTree
  {
    std::shared_ptr<const avianlidar::CollisionTree> tree; ///< fitting tree; null: no tree fits
    bool stale = false; ///< true if the attached tree is of another geometry
  };

  /// The tree of the attached scene, if `checksum` is the checksum of the tree's mesh.
  static FoundTree FindTree(vtkDataObject* data, std::uint64_t checksum);

protected:
  vtkAvianLidarScene() = default;
  ~vtkAvianLidarScene() override = default;

private:
  vtkAvianLidarScene(const vtkAvianLidarScene&) = delete;
  void operator=(const vtkAvianLidarScene&) = delete;

  const void* Owner = nullptr; ///< vtkPolyData to which the scene was attached
  vtkMTimeType Time = 0;       ///< time of the last modification of `Owner`
};

#endif
