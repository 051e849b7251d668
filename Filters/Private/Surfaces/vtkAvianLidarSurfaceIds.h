// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceIds.h
 * @brief Ids, names and classes of the objects and materials of a scene, from those of its leaves.
 * Not installed.
 *
 * Object ids are kept when every leaf brings its own, no two leaves share one, and they are small
 * and not negative; otherwise they are given in leaf order. Materials are distinguished by name:
 * ids of different leaves need not agree. The classes of a scene as a whole count only where no
 * leaf brings any: a composite may have them from the first of its producers.
 */
#ifndef vtkAvianLidarSurfaceIds_h
#define vtkAvianLidarSurfaceIds_h

#include "vtkAvianLidarSurfaceLeaf.h"

#include <cstddef>
#include <string>
#include <vector>

class vtkFieldData;

class vtkAvianLidarSurfaceIds
{
public:
  std::vector<std::string> ObjectNames;   ///< by object id
  std::vector<std::string> ObjectClasses; ///< likewise; empty: none brings any
  std::vector<std::string> MaterialNames; ///< by material id

  /// @param sceneFields of the whole input, may be null; must outlive this
  void Begin(vtkFieldData* sceneFields, const std::vector<vtkAvianLidarSurfaceLeaf>& leaves);

  /// A leaf without triangles may be an object all the same.
  void AddEmptyLeaf(const vtkAvianLidarSurfaceLeaf& leaf);

  /// Id in the scene of an object of a leaf, asked for once. @param poly the leaf, triangulated
  /// @param local its id there @param rank number of objects of the leaf that were asked for before
  int AddObject(
    const vtkAvianLidarSurfaceLeaf& leaf, vtkPolyData* poly, int local, std::size_t rank);

  /// Id in the scene of a medium that is an object. @param wanted taken where ids are kept; -1: a
  /// new one
  int AddMedium(const std::string& name, int wanted);

  /// Id in the scene of a material of a leaf. @param local its id there, negative if it has none
  int MaterialOf(vtkPolyData* poly, int local);

private:
  void SetClass(int global, const std::string& objectClass);
  std::string ObjectName(const vtkAvianLidarSurfaceLeaf& leaf, vtkPolyData* poly, int local,
    std::size_t rank, int global) const;

  vtkFieldData* SceneFields = nullptr;
  bool KeepObjectIds = false;
  bool LeavesHaveClasses = false;
  bool SceneHasClasses = false;
  int NextObject = 0;
};

#endif
