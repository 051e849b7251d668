// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTreeAccess.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarContent.h"

#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTypeUInt64Array.h"

vtkStandardNewMacro(vtkAvianLidarTreeHolder);

namespace
{
/// A 64-bit value does not survive a trip through double.
bool GetChecksum(vtkFieldData* fields, std::uint64_t& value)
{
  auto* array = fields->GetArray(vtkAvianLidarArrays::TreeChecksum.name);
  if (!array || array->GetNumberOfValues() < 1)
  {
    return false;
  }
  if (auto* exact = vtkTypeUInt64Array::SafeDownCast(array))
  {
    value = exact->GetValue(0);
    return true;
  }
  value = array->GetVariantValue(0).ToTypeUInt64();
  return true;
}

vtkAvianLidarTreeHolder* HolderOf(vtkPolyData* surfaces)
{
  auto* array = surfaces->GetFieldData()->GetArray(vtkAvianLidarArrays::TreeChecksum.name);
  return array ? vtkAvianLidarTreeHolder::SafeDownCast(
                   array->GetInformation()->Get(vtkAvianLidarCollisionTree::COLLISION_TREE()))
               : nullptr;
}
}

namespace vtkAvianLidarTreeAccess
{
//------------------------------------------------------------------------------
void Detach(vtkDataObject* surfaces)
{
  surfaces->GetFieldData()->RemoveArray(vtkAvianLidarArrays::TreeChecksum.name);
}

//------------------------------------------------------------------------------
void Attach(vtkPolyData* surfaces, std::shared_ptr<const avianlidar::CollisionTree> tree,
  std::shared_ptr<const vtkAvianLidarSurfaces> merged)
{
  Detach(surfaces);
  auto checksum =
    vtkAvianLidarArrays::Make<vtkTypeUInt64Array>(vtkAvianLidarArrays::TreeChecksum, 1);
  checksum->SetValue(0, tree->checksum);
  vtkNew<vtkAvianLidarTreeHolder> holder;
  holder->Tree = std::move(tree);
  holder->Surfaces = std::move(merged);
  checksum->GetInformation()->Set(vtkAvianLidarCollisionTree::COLLISION_TREE(), holder);
  surfaces->GetFieldData()->AddArray(checksum);
  holder->Original = surfaces;
  holder->Time = vtkAvianLidarContent::TimeOf(surfaces);
}

//------------------------------------------------------------------------------
std::shared_ptr<const vtkAvianLidarSurfaces> FindMerged(vtkDataObject* surfaces)
{
  auto* poly = vtkPolyData::SafeDownCast(surfaces);
  vtkAvianLidarTreeHolder* holder = poly ? HolderOf(poly) : nullptr;
  const bool untouched =
    holder && holder->Original == poly && holder->Time == vtkAvianLidarContent::TimeOf(poly);
  return untouched ? holder->Surfaces : nullptr;
}

//------------------------------------------------------------------------------
Found Find(vtkDataObject* surfaces, std::uint64_t checksum)
{
  Found found;
  auto* poly = vtkPolyData::SafeDownCast(surfaces);
  std::uint64_t stored = 0;
  if (!poly || !GetChecksum(poly->GetFieldData(), stored))
  {
    return found;
  }
  found.stale = stored != checksum;
  vtkAvianLidarTreeHolder* holder = HolderOf(poly);
  if (!found.stale && holder && holder->Tree && holder->Tree->checksum == checksum)
  {
    found.tree = holder->Tree;
  }
  return found;
}
}
