// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include "BoundingVolume.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarSurfaceLeaf.h"

#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

namespace
{
using avianlidar::Material;
using avianlidar::TriangleMesh;
using avianlidar::Vec3;
using Leaf = vtkAvianLidarSurfaceLeaf;

using vtkAvianLidarMaterials::StandardMaterials;

std::string StringOfField(vtkFieldData* fields, const char* array, vtkIdType index)
{
  auto* names = fields ? vtkStringArray::SafeDownCast(fields->GetAbstractArray(array)) : nullptr;
  return names && index >= 0 && index < names->GetNumberOfValues() ? names->GetValue(index)
                                                                   : std::string();
}

/// Merges the leaves one after the other; its members are the state of that walk.
class Merger
{
public:
  vtkAvianLidarSurfaces Result;

  void Run(vtkDataObject* input)
  {
    const std::vector<Leaf> leaves = Leaf::Collect(input, this->Result.problem);
    this->Mesh = std::make_shared<TriangleMesh>();
    for (const auto& standard : StandardMaterials)
    {
      this->Result.materialNames.push_back(standard.name);
    }
    this->InputFields = input ? input->GetFieldData() : nullptr;
    for (const Leaf& leaf : leaves)
    {
      const std::string wrong = leaf.Check();
      if (this->Result.problem.empty() && !wrong.empty())
      {
        this->Complain(leaf, wrong);
      }
    }
    if (!this->Result.problem.empty())
    {
      return;
    }
    this->KeepObjectIds = this->IdsAreUsable(leaves);
    for (const Leaf& leaf : leaves)
    {
      if (!this->AddLeaf(leaf))
      {
        return;
      }
    }
    if (this->WithoutMaterial)
    {
      this->Result.advice = "surfaces: " + std::to_string(this->WithoutMaterial) +
        " triangles have no kd, ks, kp cell arrays and are taken as Wall (kd 0.146, ks 0.054, kp "
        "112). "
        "Use the Material filter, and combine surfaces by Group Datasets: Append Geometry drops "
        "arrays that one "
        "input lacks.";
    }
    this->Result.mesh = this->Mesh;
  }

private:
  std::shared_ptr<TriangleMesh> Mesh;
  vtkFieldData* InputFields = nullptr;
  bool KeepObjectIds = false;
  int NextObject = 0;
  vtkIdType WithoutMaterial = 0;

  bool Complain(const Leaf& leaf, const std::string& what)
  {
    this->Result.problem = leaf.Complaint(what);
    return false;
  }

  /// Object ids are kept when every leaf brings its own, no two leaves share one, and they are
  /// small and not negative; otherwise ids are given in leaf order.
  bool IdsAreUsable(const std::vector<Leaf>& leaves) const
  {
    std::set<int> all;
    vtkIdType cells = 0;
    for (const Leaf& leaf : leaves)
    {
      vtkDataArray* ids = leaf.data->GetCellData()->GetArray(vtkAvianLidarArrays::ObjectId.name);
      if (leaf.data->GetNumberOfCells() == 0)
      {
        continue;
      }
      if (!ids)
      {
        return false;
      }
      cells += leaf.data->GetNumberOfCells();
      std::set<int> mine;
      for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i)
      {
        mine.insert(static_cast<int>(ids->GetComponent(i, 0)));
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

  bool AddLeaf(const Leaf& leaf)
  {
    vtkSmartPointer<vtkPolyData> poly = leaf.Triangulated();
    const vtkIdType cells = poly->GetNumberOfPolys();
    if (cells == 0)
    {
      this->NameEmptyLeaf(leaf);
      return true;
    }
    if (this->Mesh->points.size() + poly->GetNumberOfPoints() >= avianlidar::NoTriangle ||
      this->Mesh->size() + cells >= avianlidar::NoTriangle)
    {
      return this->Complain(leaf, "more than 4294967294 points or triangles in the scene");
    }
    return this->AddPoints(leaf, poly) && this->AddTriangles(leaf, poly);
  }

  void NameEmptyLeaf(const Leaf& leaf)
  {
    if (!this->KeepObjectIds && !leaf.name.empty())
    {
      this->Result.objectNames.push_back(leaf.name);
      ++this->NextObject;
    }
  }

  bool AddPoints(const Leaf& leaf, vtkPolyData* poly)
  {
    this->FirstPoint = static_cast<std::uint32_t>(this->Mesh->points.size());
    this->Mesh->points.reserve(this->Mesh->points.size() + poly->GetNumberOfPoints());
    for (vtkIdType i = 0; i < poly->GetNumberOfPoints(); ++i)
    {
      Vec3 p;
      poly->GetPoint(i, &p.x);
      const double largest = std::max({ std::abs(p.x), std::abs(p.y), std::abs(p.z) });
      if (!avianlidar::isFinite(p) || largest > avianlidar::MaximumCoordinate)
      {
        return this->Complain(leaf,
          "point " + std::to_string(i) +
            " has a coordinate that is not finite or beyond 1e30, expected metres");
      }
      this->Mesh->points.push_back(p);
    }
    return true;
  }

  bool AddTriangles(const Leaf& leaf, vtkPolyData* poly)
  {
    const vtkAvianLidarSurfaceArrays arrays(poly);
    std::map<int, int> objectMap;
    std::map<int, int> materialMap;
    auto iterator = vtk::TakeSmartPointer(poly->GetPolys()->NewIterator());
    for (iterator->GoToFirstCell(); !iterator->IsDoneWithTraversal(); iterator->GoToNextCell())
    {
      vtkIdType count = 0;
      const vtkIdType* ids = nullptr;
      iterator->GetCurrentCell(count, ids);
      const vtkIdType cell = iterator->GetCurrentCellId();
      if (arrays.ghosts && arrays.ghosts->GetValue(cell))
      {
        continue;
      }
      this->Mesh->triangles.push_back({ this->FirstPoint + static_cast<std::uint32_t>(ids[0]),
        this->FirstPoint + static_cast<std::uint32_t>(ids[1]),
        this->FirstPoint + static_cast<std::uint32_t>(ids[2]) });
      if (!this->AddMaterial(leaf, poly, arrays, cell, materialMap))
      {
        return false;
      }
      this->AddObject(leaf, poly, arrays.object, cell, objectMap);
    }
    return true;
  }

  bool AddMaterial(const Leaf& leaf, vtkPolyData* poly, const vtkAvianLidarSurfaceArrays& arrays,
    vtkIdType cell, std::map<int, int>& materialMap)
  {
    Material material = StandardMaterials[0].material;
    int id = 0;
    if (arrays.kd)
    {
      material = { arrays.kd->GetComponent(cell, 0), arrays.ks->GetComponent(cell, 0),
        arrays.kp->GetComponent(cell, 0) };
      const std::string wrong = avianlidar::checkMaterial(material);
      if (!wrong.empty())
      {
        return this->Complain(leaf, "cell " + std::to_string(cell) + ": " + wrong);
      }
      const int local =
        arrays.material ? static_cast<int>(arrays.material->GetComponent(cell, 0)) : -1;
      auto found = materialMap.find(local);
      id = found != materialMap.end() ? found->second
                                      : (materialMap[local] = this->GlobalMaterial(poly, local));
    }
    else
    {
      ++this->WithoutMaterial;
    }
    this->Result.materials.push_back(material);
    this->Result.materialIds.push_back(id);
    return true;
  }

  /// Materials are told apart by name: ids of different leaves need not agree.
  int GlobalMaterial(vtkPolyData* poly, int local)
  {
    std::string name =
      StringOfField(poly->GetFieldData(), vtkAvianLidarArrays::MaterialNames.name, local);
    if (name.empty())
    {
      name = StringOfField(this->InputFields, vtkAvianLidarArrays::MaterialNames.name, local);
    }
    if (name.empty())
    {
      name = local < 0 ? "unnamed"
        : local < vtkAvianLidarMaterials::NumberOfStandardMaterials
        ? StandardMaterials[local].name
        : "material " + std::to_string(local);
    }
    auto& names = this->Result.materialNames;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end())
    {
      return static_cast<int>(found - names.begin());
    }
    names.push_back(name);
    return static_cast<int>(names.size()) - 1;
  }

  void AddObject(const Leaf& leaf, vtkPolyData* poly, vtkDataArray* ids, vtkIdType cell,
    std::map<int, int>& objectMap)
  {
    const int local = ids ? static_cast<int>(ids->GetComponent(cell, 0)) : 0;
    auto found = objectMap.find(local);
    if (found == objectMap.end())
    {
      const int global = this->KeepObjectIds ? local : this->NextObject++;
      found = objectMap.emplace(local, global).first;
      if (static_cast<int>(this->Result.objectNames.size()) <= global)
      {
        this->Result.objectNames.resize(global + 1);
      }
      this->Result.objectNames[global] =
        this->ObjectName(leaf, poly, local, objectMap.size() - 1, global);
    }
    this->Result.objectIds.push_back(found->second);
  }

  std::string ObjectName(
    const Leaf& leaf, vtkPolyData* poly, int local, std::size_t rank, int global) const
  {
    const char* array = vtkAvianLidarArrays::ObjectNames.name;
    auto* own = vtkStringArray::SafeDownCast(poly->GetFieldData()->GetAbstractArray(array));
    std::string name;
    if (own && own->GetNumberOfValues() == 1 && rank == 0)
    {
      name = own->GetValue(0); // a leaf that is one object names it so
    }
    else if (own)
    {
      name = StringOfField(poly->GetFieldData(), array, local);
    }
    if (name.empty())
    {
      name = leaf.name;
    }
    if (name.empty())
    {
      name = StringOfField(this->InputFields, array, local);
    }
    return name.empty() ? "object " + std::to_string(global) : name;
  }

  std::uint32_t FirstPoint = 0;
};
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::Merge(vtkDataObject* input)
{
  Merger merger;
  merger.Run(input);
  return std::move(merger.Result);
}

//------------------------------------------------------------------------------
std::vector<std::pair<const void*, vtkMTimeType>> vtkAvianLidarSurfaces::StateOf(
  vtkDataObject* input)
{
  std::vector<std::pair<const void*, vtkMTimeType>> state;
  std::string problem;
  state.emplace_back(input, input->GetFieldData()->GetMTime());
  for (const Leaf& leaf : Leaf::Collect(input, problem))
  {
    state.emplace_back(leaf.data, leaf.data->GetMTime());
    // A renamed block leaves no trace in its data.
    state.emplace_back(leaf.data, std::hash<std::string>()(leaf.name));
    state.emplace_back(leaf.data->GetFieldData(), leaf.data->GetFieldData()->GetMTime());
  }
  return problem.empty() ? state : std::vector<std::pair<const void*, vtkMTimeType>>{};
}
