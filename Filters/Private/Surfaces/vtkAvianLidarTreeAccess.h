// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTreeAccess.h
 * @brief Attaches a collision tree to a vtkPolyData by reference, within one process. Not
 * installed.
 */
#ifndef vtkAvianLidarTreeAccess_h
#define vtkAvianLidarTreeAccess_h

#include "CollisionTree.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkObject.h"

#include <memory>

class vtkDataObject;
class vtkPolyData;

/// Carries an immutable tree through VTK's information objects.
class vtkAvianLidarTreeHolder : public vtkObject
{
public:
  static vtkAvianLidarTreeHolder* New();
  vtkTypeMacro(vtkAvianLidarTreeHolder, vtkObject);
  std::shared_ptr<const avianlidar::CollisionTree> Tree;
  std::shared_ptr<const vtkAvianLidarSurfaces> Surfaces;
  const void* Original = nullptr; ///< vtkPolyData to which they were attached
  vtkMTimeType Time = 0;          ///< when anything in it was modified last

protected:
  vtkAvianLidarTreeHolder() = default;
  ~vtkAvianLidarTreeHolder() override = default;

private:
  vtkAvianLidarTreeHolder(const vtkAvianLidarTreeHolder&) = delete;
  void operator=(const vtkAvianLidarTreeHolder&) = delete;
};

namespace vtkAvianLidarTreeAccess
{
/// Remove a tree and its field array, as a tree of another geometry would be stale.
void Detach(vtkDataObject* surfaces);

/// Attach by reference: field array `tree_checksum` whose information holds the tree, and with it
/// what vtkAvianLidarSurfaces::Merge() would make of `surfaces`. Nothing else is to be changed
/// after it.
void Attach(vtkPolyData* surfaces, std::shared_ptr<const avianlidar::CollisionTree> tree,
  std::shared_ptr<const vtkAvianLidarSurfaces> merged);

/// The merged surfaces that came with `surfaces`, if `surfaces` is the output object of the tree
/// filter and was not modified since; else null, as only the content can then be compared.
std::shared_ptr<const vtkAvianLidarSurfaces> FindMerged(vtkDataObject* surfaces);

struct Found
{
  std::shared_ptr<const avianlidar::CollisionTree> tree; ///< null: no tree fits
  bool stale = false;                                    ///< the tree was of another geometry
};

/// The tree that came with `surfaces`, if it is of the mesh with this checksum.
Found Find(vtkDataObject* surfaces, std::uint64_t checksum);
}

#endif
