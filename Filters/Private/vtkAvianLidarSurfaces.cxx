// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarMaterials.h"

#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace
{
using avianlidar::Material;
using avianlidar::TriangleMesh;
using avianlidar::Vec3;

using vtkAvianLidarMaterials::StandardMaterials;

struct Leaf
{
  vtkPolyData* data = nullptr;
  std::string name;
};

std::vector<Leaf> CollectLeaves(vtkDataObject* input, std::string& problem)
{
  std::vector<Leaf> leaves;
  if (auto* poly = vtkPolyData::SafeDownCast(input))
  {
    leaves.push_back({ poly, "" });
    return leaves;
  }
  auto* composite = vtkCompositeDataSet::SafeDownCast(input);
  if (!composite)
  {
    problem = "the surfaces are neither vtkPolyData nor a composite of it";
    return leaves;
  }
  auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
  int number = 0;
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal();
       iterator->GoToNextItem(), ++number)
  {
    std::string name = "block " + std::to_string(number);
    if (iterator->HasCurrentMetaData() &&
      iterator->GetCurrentMetaData()->Has(vtkCompositeDataSet::NAME()))
    {
      name = iterator->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME());
    }
    auto* poly = vtkPolyData::SafeDownCast(iterator->GetCurrentDataObject());
    if (!poly)
    {
      problem = "surfaces: block '" + name + "' is not vtkPolyData (use Extract Surface first)";
      return leaves;
    }
    leaves.push_back({ poly, name });
  }
  return leaves;
}

bool OnlyTriangles(vtkPolyData* poly)
{
  return poly->GetNumberOfStrips() == 0 && poly->GetNumberOfVerts() == 0 &&
    poly->GetNumberOfLines() == 0 &&
    (poly->GetPolys()->IsHomogeneous() == 3 || poly->GetNumberOfPolys() == 0);
}

vtkSmartPointer<vtkPolyData> Triangulated(vtkPolyData* poly)
{
  if (OnlyTriangles(poly))
  {
    return poly;
  }
  vtkNew<vtkTriangleFilter> filter;
  filter->PassVertsOff();
  filter->PassLinesOff();
  filter->SetInputData(poly);
  filter->Update();
  return filter->GetOutput();
}

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
    const std::vector<Leaf> leaves = CollectLeaves(input, this->Result.problem);
    this->Mesh = std::make_shared<TriangleMesh>();
    for (const auto& standard : StandardMaterials)
    {
      this->Result.materialNames.push_back(standard.name);
    }
    this->InputFields = input ? input->GetFieldData() : nullptr;
    this->KeepObjectIds = this->IdsAreUsable(leaves);
    for (const Leaf& leaf : leaves)
    {
      if (!this->Result.problem.empty() || !this->AddLeaf(leaf))
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

  void Complain(const Leaf& leaf, const std::string& what)
  {
    this->Result.problem =
      "surfaces" + (leaf.name.empty() ? "" : ", block '" + leaf.name + "'") + ": " + what;
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
    vtkSmartPointer<vtkPolyData> poly = Triangulated(leaf.data);
    const vtkIdType cells = poly->GetNumberOfPolys();
    if (cells == 0)
    {
      this->NameEmptyLeaf(leaf);
      return true;
    }
    if (this->Mesh->points.size() + poly->GetNumberOfPoints() >= avianlidar::NoTriangle ||
      this->Mesh->size() + cells >= avianlidar::NoTriangle)
    {
      this->Complain(leaf, "more than 4294967294 points or triangles in the scene");
      return false;
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
      if (!avianlidar::isFinite(p))
      {
        this->Complain(leaf,
          "point " + std::to_string(i) + " has a coordinate that is not finite, expected metres");
        return false;
      }
      this->Mesh->points.push_back(p);
    }
    return true;
  }

  bool AddTriangles(const Leaf& leaf, vtkPolyData* poly)
  {
    const LeafArrays arrays = this->FindArrays(leaf, poly);
    if (!this->Result.problem.empty())
    {
      return false;
    }
    auto* ghosts = vtkUnsignedCharArray::SafeDownCast(
      poly->GetCellData()->GetArray(vtkDataSetAttributes::GhostArrayName()));
    std::map<int, int> objectMap;
    std::map<int, int> materialMap;
    auto iterator = vtk::TakeSmartPointer(poly->GetPolys()->NewIterator());
    for (iterator->GoToFirstCell(); !iterator->IsDoneWithTraversal(); iterator->GoToNextCell())
    {
      vtkIdType count = 0;
      const vtkIdType* ids = nullptr;
      iterator->GetCurrentCell(count, ids);
      const vtkIdType cell = iterator->GetCurrentCellId();
      if (ghosts && ghosts->GetValue(cell))
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

  struct LeafArrays
  {
    vtkDataArray* object = nullptr;
    vtkDataArray* material = nullptr;
    vtkDataArray* kd = nullptr;
    vtkDataArray* ks = nullptr;
    vtkDataArray* kp = nullptr;
  };

  LeafArrays FindArrays(const Leaf& leaf, vtkPolyData* poly)
  {
    vtkCellData* data = poly->GetCellData();
    LeafArrays arrays;
    arrays.object = data->GetArray(vtkAvianLidarArrays::ObjectId.name);
    arrays.material = data->GetArray(vtkAvianLidarArrays::MaterialId.name);
    arrays.kd = data->GetArray(vtkAvianLidarArrays::Kd.name);
    arrays.ks = data->GetArray(vtkAvianLidarArrays::Ks.name);
    arrays.kp = data->GetArray(vtkAvianLidarArrays::Kp.name);
    const int present = (arrays.kd != nullptr) + (arrays.ks != nullptr) + (arrays.kp != nullptr);
    if (present != 0 && present != 3)
    {
      this->Complain(
        leaf, "of the cell arrays kd, ks, kp only some are there, expected all three or none");
    }
    for (vtkDataArray* array : { arrays.object, arrays.material, arrays.kd, arrays.ks, arrays.kp })
    {
      if (array && array->GetNumberOfComponents() != 1)
      {
        this->Complain(leaf,
          std::string("cell array '") + array->GetName() + "' has " +
            std::to_string(array->GetNumberOfComponents()) + " components, expected 1");
      }
    }
    return arrays;
  }

  bool AddMaterial(const Leaf& leaf, vtkPolyData* poly, const LeafArrays& arrays, vtkIdType cell,
    std::map<int, int>& materialMap)
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
        this->Complain(leaf, "cell " + std::to_string(cell) + ": " + wrong);
        return false;
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

void AddStrings(vtkFieldData* fields, const vtkAvianLidarArrays::Name& name,
  const std::vector<std::string>& values)
{
  auto array =
    vtkAvianLidarArrays::Make<vtkStringArray>(name, static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    array->SetValue(static_cast<vtkIdType>(i), values[i]);
  }
  fields->AddArray(array);
}

template <class ArrayT, class T>
void AddCellArray(
  vtkPolyData* poly, const vtkAvianLidarArrays::Name& name, const std::vector<T>& values)
{
  auto array = vtkAvianLidarArrays::Make<ArrayT>(name, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  poly->GetCellData()->AddArray(array);
}
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::Merge(vtkDataObject* input)
{
  Merger merger;
  merger.Run(input);
  return std::move(merger.Result);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarSurfaces::ToPolyData(vtkDataObject* input) const
{
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(this->mesh->points.size()));
  for (std::size_t i = 0; i < this->mesh->points.size(); ++i)
  {
    points->SetPoint(static_cast<vtkIdType>(i), &this->mesh->points[i].x);
  }
  poly->SetPoints(points);
  vtkNew<vtkCellArray> polys;
  polys->AllocateExact(
    static_cast<vtkIdType>(this->mesh->size()), static_cast<vtkIdType>(3 * this->mesh->size()));
  for (const auto& t : this->mesh->triangles)
  {
    polys->InsertNextCell({ t[0], t[1], t[2] });
  }
  poly->SetPolys(polys);
  std::vector<double> kd, ks, kp;
  for (const Material& m : this->materials)
  {
    kd.push_back(m.kd);
    ks.push_back(m.ks);
    kp.push_back(m.kp);
  }
  AddCellArray<vtkIntArray>(poly, vtkAvianLidarArrays::ObjectId, this->objectIds);
  AddCellArray<vtkIntArray>(poly, vtkAvianLidarArrays::MaterialId, this->materialIds);
  AddCellArray<vtkDoubleArray>(poly, vtkAvianLidarArrays::Kd, kd);
  AddCellArray<vtkDoubleArray>(poly, vtkAvianLidarArrays::Ks, ks);
  AddCellArray<vtkDoubleArray>(poly, vtkAvianLidarArrays::Kp, kp);
  if (input && input->GetFieldData())
  {
    poly->GetFieldData()->PassData(input->GetFieldData());
  }
  AddStrings(poly->GetFieldData(), vtkAvianLidarArrays::ObjectNames, this->objectNames);
  AddStrings(poly->GetFieldData(), vtkAvianLidarArrays::MaterialNames, this->materialNames);
  return poly;
}
