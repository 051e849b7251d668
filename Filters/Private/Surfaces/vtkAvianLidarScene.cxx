// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarScene.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarContent.h"

#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTypeUInt64Array.h"

vtkStandardNewMacro(vtkAvianLidarScene);

namespace
{
/// Read a checksum of 64 bits. A conversion to double would lose digits.
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

vtkAvianLidarScene* SceneOf(vtkPolyData* data)
{
  auto* array = data->GetFieldData()->GetArray(vtkAvianLidarArrays::TreeChecksum.name);
  return array ? vtkAvianLidarScene::SafeDownCast(
                   array->GetInformation()->Get(vtkAvianLidarCollisionTree::COLLISION_TREE()))
               : nullptr;
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarScene::Detach(vtkDataObject* data)
{
  data->GetFieldData()->RemoveArray(vtkAvianLidarArrays::TreeChecksum.name);
}

//------------------------------------------------------------------------------
void vtkAvianLidarScene::AttachTo(vtkPolyData* output)
{
  Detach(output);
  auto checksum =
    vtkAvianLidarArrays::Make<vtkTypeUInt64Array>(vtkAvianLidarArrays::TreeChecksum, 1);
  checksum->SetValue(0, this->Tree->checksum);
  checksum->GetInformation()->Set(vtkAvianLidarCollisionTree::COLLISION_TREE(), this);
  output->GetFieldData()->AddArray(checksum);
  this->Owner = output;
  this->Time = vtkAvianLidarContent::TimeOf(output);
}

//------------------------------------------------------------------------------
std::shared_ptr<const vtkAvianLidarSurfaces> vtkAvianLidarScene::FindSurfaces(vtkDataObject* data)
{
  auto* poly = vtkPolyData::SafeDownCast(data);
  vtkAvianLidarScene* scene = poly ? SceneOf(poly) : nullptr;
  const bool untouched =
    scene && scene->Owner == poly && scene->Time == vtkAvianLidarContent::TimeOf(poly);
  return untouched ? scene->Surfaces : nullptr;
}

//------------------------------------------------------------------------------
vtkAvianLidarScene::FoundTree vtkAvianLidarScene::FindTree(
  vtkDataObject* data, std::uint64_t checksum)
{
  FoundTree found;
  auto* poly = vtkPolyData::SafeDownCast(data);
  std::uint64_t stored = 0;
  if (!poly || !GetChecksum(poly->GetFieldData(), stored))
  {
    return found;
  }
  found.stale = stored != checksum;
  vtkAvianLidarScene* scene = SceneOf(poly);
  if (!found.stale && scene && scene->Tree->checksum == checksum)
  {
    found.tree = scene->Tree;
  }
  return found;
}
