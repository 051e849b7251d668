// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTreeAccess.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarContent.h"

#include "vtkInformationObjectBaseKey.h"
#include "vtkIntArray.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTypeUInt32Array.h"
#include "vtkTypeUInt64Array.h"

#include <limits>
#include <stdexcept>

vtkStandardNewMacro(vtkAvianLidarTreeHolder);

namespace
{
constexpr vtkAvianLidarArrays::Name TreeOptions{ "tree_options", "" };
constexpr vtkAvianLidarArrays::Name TreeNodes{ "tree_nodes", "" };
constexpr vtkAvianLidarArrays::Name TreeOrder{ "tree_order", "" };
constexpr vtkAvianLidarArrays::Name TreeVolumes{ "tree_volumes", "m" };

/// Numbers of any numeric type; false if the array is missing or has a value outside the range.
template <class T>
bool GetNumbers(vtkFieldData* fields, const vtkAvianLidarArrays::Name& name, std::vector<T>& values)
{
  vtkDataArray* array = fields->GetArray(name.name);
  if (!array)
  {
    return false;
  }
  const vtkIdType count = array->GetNumberOfValues();
  const int components = array->GetNumberOfComponents();
  values.resize(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const double value = array->GetComponent(i / components, static_cast<int>(i % components));
    if (std::is_integral<T>::value &&
      !(value >= static_cast<double>(std::numeric_limits<T>::min()) &&
        value <= static_cast<double>(std::numeric_limits<T>::max())))
    {
      return false;
    }
    values[i] = static_cast<T>(value);
  }
  return true;
}

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

vtkAvianLidarTreeAccess::Found Restore(
  vtkFieldData* fields, const std::shared_ptr<const avianlidar::TriangleMesh>& mesh, int threads)
{
  vtkAvianLidarTreeAccess::Found found;
  avianlidar::FlatTree flat;
  if (!fields->HasArray(TreeNodes.name))
  {
    return found;
  }
  if (!vtkAvianLidarTreeAccess::Read(fields, flat))
  {
    found.problem = "of its field arrays tree_options, tree_nodes, tree_order, tree_volumes one is "
                    "missing or not of the kind expected";
    return found;
  }
  flat.checksum = mesh->checksum();
  try
  {
    found.tree = avianlidar::restoreTree(mesh, flat, threads);
  }
  catch (const std::invalid_argument& error)
  {
    found.problem = error.what();
  }
  return found;
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
  for (const vtkAvianLidarArrays::Name& name :
    { vtkAvianLidarArrays::TreeChecksum, TreeOptions, TreeNodes, TreeOrder, TreeVolumes })
  {
    surfaces->GetFieldData()->RemoveArray(name.name);
  }
}

//------------------------------------------------------------------------------
void Write(const avianlidar::FlatTree& flat, vtkFieldData* fields)
{
  const std::vector<int> options = { static_cast<int>(flat.options.splitRule),
    static_cast<int>(flat.options.boundingVolume), flat.options.maximumLeafSize };
  using vtkAvianLidarArrays::MakeOf;
  fields->AddArray(MakeOf<vtkIntArray>(TreeOptions, options));
  fields->AddArray(MakeOf<vtkTypeUInt32Array>(TreeNodes, flat.nodes));
  fields->AddArray(MakeOf<vtkTypeUInt32Array>(TreeOrder, flat.order));
  fields->AddArray(MakeOf<vtkDoubleArray>(TreeVolumes, flat.volumes));
}

//------------------------------------------------------------------------------
bool Read(vtkFieldData* fields, avianlidar::FlatTree& flat)
{
  std::vector<std::int32_t> options;
  if (!GetNumbers(fields, TreeOptions, options) || options.size() != 3 ||
    !GetNumbers(fields, TreeNodes, flat.nodes) || !GetNumbers(fields, TreeOrder, flat.order) ||
    !GetNumbers(fields, TreeVolumes, flat.volumes))
  {
    return false;
  }
  flat.options = { static_cast<avianlidar::SplitRule>(options[0]),
    static_cast<avianlidar::BoundingVolumeType>(options[1]), options[2] };
  return true;
}

//------------------------------------------------------------------------------
void Attach(vtkPolyData* surfaces, std::shared_ptr<const avianlidar::CollisionTree> tree,
  std::shared_ptr<const vtkAvianLidarSurfaces> merged, bool embed)
{
  Detach(surfaces);
  if (embed)
  {
    Write(avianlidar::flattenTree(*tree), surfaces->GetFieldData());
  }
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
Found Find(vtkDataObject* surfaces, const std::shared_ptr<const avianlidar::TriangleMesh>& mesh,
  std::uint64_t checksum, int threads)
{
  Found found;
  auto* poly = vtkPolyData::SafeDownCast(surfaces);
  std::uint64_t stored = 0;
  if (!poly || !GetChecksum(poly->GetFieldData(), stored))
  {
    return found;
  }
  if (stored != checksum)
  {
    found.stale = true;
    return found;
  }
  vtkAvianLidarTreeHolder* holder = HolderOf(poly);
  if (holder && holder->Tree && holder->Tree->checksum == checksum)
  {
    found.tree = holder->Tree;
    return found;
  }
  return Restore(poly->GetFieldData(), mesh, threads);
}
}
