// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTreeAccess.h
 * @brief How a collision tree travels with a vtkPolyData: attached (by reference, within one
 * process) or embedded (flat arrays in field data, for files). Not installed.
 */
#ifndef vtkAvianLidarTreeAccess_h
#define vtkAvianLidarTreeAccess_h

#include "CollisionTree.h"
#include "TreeSerialization.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkObject.h"

#include <memory>
#include <string>

class vtkDataObject;
class vtkFieldData;
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

/// Write all of a flat tree but its checksum into field data.
void Write(const avianlidar::FlatTree& flat, vtkFieldData* fields);

/// Read what Write() wrote. @return false if arrays are missing or not of the kind expected
bool Read(vtkFieldData* fields, avianlidar::FlatTree& flat);

/// Attach by reference: field array `tree_checksum` whose information holds the tree, and with it
/// what vtkAvianLidarSurfaces::Merge() would make of `surfaces`. Nothing else is to be changed
/// after it. @param embed also write the tree's node arrays into field data
void Attach(vtkPolyData* surfaces, std::shared_ptr<const avianlidar::CollisionTree> tree,
  std::shared_ptr<const vtkAvianLidarSurfaces> merged, bool embed);

/// The merged surfaces that came with `surfaces`, if those are the very output of the tree filter
/// and nothing in it was modified since; else null, as only a look at the content can tell.
std::shared_ptr<const vtkAvianLidarSurfaces> FindMerged(vtkDataObject* surfaces);

struct Found
{
  std::shared_ptr<const avianlidar::CollisionTree> tree; ///< null: none that fits
  bool stale = false;                                    ///< one was there, but of another geometry
  std::string problem; ///< one was there, but its arrays are damaged
};

/// The tree that came with `surfaces`, if its checksum is that of `mesh`. @param threads > 0, or 0
/// for all cores
Found Find(vtkDataObject* surfaces, const std::shared_ptr<const avianlidar::TriangleMesh>& mesh,
  std::uint64_t checksum, int threads);
}

#endif
