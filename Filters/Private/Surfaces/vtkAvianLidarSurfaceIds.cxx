// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceIds.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarMedia.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <set>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Leaf = vtkAvianLidarSurfaceLeaf;
using Column = vtkAvianLidarColumn;

using vtkAvianLidarMaterials::NamedMaterials;

/// Text of an object of a leaf. A single text belongs to the first object. Several texts are
/// indexed by the id in the leaf.
/// @param rank index of the object among the objects of the leaf
std::string TextOfObject(
  vtkFieldData* fields, const Arrays::Name& name, int local, std::size_t rank)
{
  auto* own = Arrays::FindTexts(fields, name);
  const bool one = own && own->GetNumberOfValues() == 1 && rank == 0;
  return Arrays::TextAt(fields, name, one ? 0 : local);
}

/// True if object ids are kept.
bool IdsAreUsable(const std::vector<Leaf>& leaves)
{
  std::set<int> all;
  vtkIdType cells = 0;
  for (const Leaf& leaf : leaves)
  {
    vtkDataArray* ids = leaf.data->GetCellData()->GetArray(Arrays::ObjectId.name);
    if (leaf.data->GetNumberOfCells() == 0 || vtkAvianLidarMedia::IsMedium(leaf.data))
    {
      continue;
    }
    if (!ids)
    {
      return false;
    }
    cells += leaf.data->GetNumberOfCells();
    std::set<int> mine;
    const Column column(ids);
    for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i)
    {
      if (i == 0 || column[i] != column[i - 1])
      {
        mine.insert(static_cast<int>(column[i]));
      }
    }
    for (int id : mine)
    {
      if (id < 0 || id > 1000000 || !all.insert(id).second)
      {
        return false;
      }
    }
  }
  return cells > 0;
}
}

void vtkAvianLidarSurfaceIds::Begin(vtkFieldData* sceneFields, const std::vector<Leaf>& leaves)
{
  this->SceneFields = sceneFields;
  this->KeepObjectIds = IdsAreUsable(leaves);
  const auto haveClasses = [](vtkFieldData* fields)
  { return Arrays::FindTexts(fields, Arrays::ObjectClasses) != nullptr; };
  this->LeavesHaveClasses = std::any_of(leaves.begin(), leaves.end(),
    [&](const Leaf& leaf) { return haveClasses(leaf.data->GetFieldData()); });
  this->SceneHasClasses = haveClasses(sceneFields);
  for (int i = 0; i < vtkAvianLidarMaterials::NumberOfStandardMaterials; ++i)
  {
    this->MaterialNames.push_back(NamedMaterials[i].name);
  }
}

void vtkAvianLidarSurfaceIds::AddEmptyLeaf(const Leaf& leaf)
{
  if (!this->KeepObjectIds && !leaf.name.empty())
  {
    this->ObjectNames.push_back(leaf.name);
    this->SetClass(
      this->NextObject++, TextOfObject(leaf.data->GetFieldData(), Arrays::ObjectClasses, 0, 0));
  }
}

int vtkAvianLidarSurfaceIds::AddObject(
  const Leaf& leaf, vtkPolyData* poly, int local, std::size_t rank)
{
  const int global = this->KeepObjectIds ? local : this->NextObject++;
  if (static_cast<int>(this->ObjectNames.size()) <= global)
  {
    this->ObjectNames.resize(global + 1);
  }
  this->ObjectNames[global] = this->ObjectName(leaf, poly, local, rank, global);
  this->SetClass(global, TextOfObject(poly->GetFieldData(), Arrays::ObjectClasses, local, rank));
  return global;
}

int vtkAvianLidarSurfaceIds::AddMedium(const std::string& name, int wanted)
{
  constexpr int most = 1000000;
  const auto count = this->ObjectNames.size();
  const auto place = static_cast<std::size_t>(wanted);
  const bool isFree =
    wanted >= 0 && wanted <= most && (place >= count || this->ObjectNames[place].empty());
  const int id = this->KeepObjectIds && isFree ? wanted : static_cast<int>(count);
  this->ObjectNames.resize(std::max(this->ObjectNames.size(), static_cast<std::size_t>(id) + 1));
  this->ObjectNames[id] = name.empty() ? "object " + std::to_string(id) : name;
  this->ObjectClasses.resize(this->ObjectNames.size());
  this->ObjectClasses[id] = "vegetation";
  return id;
}

void vtkAvianLidarSurfaceIds::AddUnusedNames(const std::vector<Leaf>& leaves)
{
  for (const Leaf& leaf : leaves)
  {
    vtkFieldData* fields = leaf.data->GetFieldData();
    auto* names = Arrays::FindTexts(fields, Arrays::ObjectNames);
    const vtkIdType count = names && this->KeepObjectIds ? names->GetNumberOfValues() : 0;
    // A single name belongs to the object of the leaf, whatever id the object has.
    for (vtkIdType id = 0; count > 1 && id < count; ++id)
    {
      this->ObjectNames.resize(
        std::max(this->ObjectNames.size(), static_cast<std::size_t>(id) + 1));
      if (this->ObjectNames[id].empty() && !names->GetValue(id).empty())
      {
        this->ObjectNames[id] = names->GetValue(id);
        this->SetClass(static_cast<int>(id), Arrays::TextAt(fields, Arrays::ObjectClasses, id));
      }
    }
  }
}

void vtkAvianLidarSurfaceIds::SetClass(int global, const std::string& objectClass)
{
  if (this->LeavesHaveClasses || this->SceneHasClasses)
  {
    this->ObjectClasses.resize(this->ObjectNames.size());
    this->ObjectClasses[global] = this->LeavesHaveClasses
      ? objectClass
      : Arrays::TextAt(this->SceneFields, Arrays::ObjectClasses, global);
  }
}

int vtkAvianLidarSurfaceIds::MaterialOf(vtkPolyData* poly, int local)
{
  std::string name = Arrays::TextAt(poly->GetFieldData(), Arrays::MaterialNames, local);
  if (name.empty())
  {
    name = Arrays::TextAt(this->SceneFields, Arrays::MaterialNames, local);
  }
  if (name.empty())
  {
    name = local < 0 ? "unnamed"
      : local < vtkAvianLidarMaterials::NumberOfStandardMaterials
      ? NamedMaterials[local].name
      : "material " + std::to_string(local);
  }
  std::vector<std::string>& names = this->MaterialNames;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end())
  {
    return static_cast<int>(found - names.begin());
  }
  names.push_back(name);
  return static_cast<int>(names.size()) - 1;
}

std::string vtkAvianLidarSurfaceIds::ObjectName(
  const Leaf& leaf, vtkPolyData* poly, int local, std::size_t rank, int global) const
{
  std::string name = TextOfObject(poly->GetFieldData(), Arrays::ObjectNames, local, rank);
  if (name.empty())
  {
    name = leaf.name;
  }
  if (name.empty())
  {
    name = Arrays::TextAt(this->SceneFields, Arrays::ObjectNames, local);
  }
  return name.empty() ? "object " + std::to_string(global) : name;
}
