// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceIds.h
 * @brief Makes the ids, names and classes of the objects and materials of a scene from the ids,
 * names and classes that its leaves have. Not installed.
 *
 * Object ids are kept if every leaf has ids, no two leaves share an id, and all ids are from 0 to
 * 1,000,000. Otherwise ids are assigned in leaf order. Materials are distinguished by name:
 * different leaves may give a material different ids. The classes in the scene's own field data
 * count only if no leaf has classes: a composite may have copied these classes from the first of
 * its producers.
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
  std::vector<std::string> ObjectNames;   ///< names by object id
  std::vector<std::string> ObjectClasses; ///< classes by object id; empty: no leaf has classes
  std::vector<std::string> MaterialNames; ///< names by material id

  /// Start with the leaves of a scene. @param sceneFields field data of the whole input, which may
  /// be null and must outlive this object
  void Begin(vtkFieldData* sceneFields, const std::vector<vtkAvianLidarSurfaceLeaf>& leaves);

  /// Add the object of a leaf without triangles, if the leaf is an object.
  void AddEmptyLeaf(const vtkAvianLidarSurfaceLeaf& leaf);

  /// Id in the scene of an object of a leaf. To be called once per object. @param poly the leaf,
  /// triangulated
  /// @param local id in the leaf @param rank number of earlier calls for the leaf
  int AddObject(
    const vtkAvianLidarSurfaceLeaf& leaf, vtkPolyData* poly, int local, std::size_t rank);

  /// Id in the scene of a medium that is an object. @param wanted id, used if ids are kept; -1:
  /// choose a new id
  int AddMedium(const std::string& name, int wanted);

  /// Keep the names and classes of objects without cells, if ids are kept. To be called last.
  void AddUnusedNames(const std::vector<vtkAvianLidarSurfaceLeaf>& leaves);

  /// Id in the scene of a material of a leaf. @param local id in the leaf; negative: no id
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
