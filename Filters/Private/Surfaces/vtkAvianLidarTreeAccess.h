// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTreeAccess.h
 * @brief How a collision tree travels with a vtkPolyData, within one process: by reference. Not
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
  const void* Original = nullptr; ///< the vtkPolyData that they are
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
/// Remove every trace of a tree, as that of another geometry would be stale.
void Detach(vtkDataObject* surfaces);

/// Attach by reference: field array `tree_checksum` whose information holds the tree, and with it
/// what vtkAvianLidarSurfaces::Merge() would make of `surfaces`. Nothing else is to be changed
/// after it.
void Attach(vtkPolyData* surfaces, std::shared_ptr<const avianlidar::CollisionTree> tree,
  std::shared_ptr<const vtkAvianLidarSurfaces> merged);

/// The merged surfaces that came with `surfaces`, if those are the very output of the tree filter
/// and nothing in it was modified since; else null, as only a look at the content can tell.
std::shared_ptr<const vtkAvianLidarSurfaces> FindMerged(vtkDataObject* surfaces);

struct Found
{
  std::shared_ptr<const avianlidar::CollisionTree> tree; ///< null: none that fits
  bool stale = false;                                    ///< one was there, but of another geometry
};

/// The tree that came with `surfaces`, if it is of the mesh with this checksum.
Found Find(vtkDataObject* surfaces, std::uint64_t checksum);
}

#endif
