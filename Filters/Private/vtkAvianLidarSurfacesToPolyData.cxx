// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarOwn.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <utility>

namespace
{
using avianlidar::Material;

template <class ArrayT, class T>
vtkSmartPointer<ArrayT> MakeArray(
  const vtkAvianLidarArrays::Name& name, const avianlidar::SharedVector<T>& values)
{
  auto array = vtkAvianLidarArrays::Make<ArrayT>(name, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

/// One coefficient of all materials. Where `last` holds that of `before`, of as many, only blocks
/// that are not shared are written: into the same array if nobody but `last` holds it or its
/// values. `last` has lost it then.
vtkSmartPointer<vtkDoubleArray> MakeArray(const vtkAvianLidarArrays::Name& name,
  const avianlidar::SharedBlocks<Material>& materials, double Material::*coefficient,
  const avianlidar::SharedBlocks<Material>& before, vtkPolyData* last)
{
  vtkSmartPointer<vtkDoubleArray> array;
  if (last && before.size() == materials.size())
  {
    array = vtkDoubleArray::SafeDownCast(last->GetCellData()->GetArray(name.name));
    last->GetCellData()->RemoveArray(name.name);
    vtkAvianLidarOwn(array);
  }
  const bool known = array != nullptr;
  if (!known)
  {
    array =
      vtkAvianLidarArrays::Make<vtkDoubleArray>(name, static_cast<vtkIdType>(materials.size()));
  }
  for (std::size_t k = 0; k < materials.blocks(); ++k)
  {
    if (!known || !materials.sharesBlock(k, before))
    {
      std::transform(materials.block(k).begin(), materials.block(k).end(),
        array->GetPointer(static_cast<vtkIdType>(k * materials.BlockSize)),
        [coefficient](const Material& material) { return material.*coefficient; });
    }
  }
  array->Modified();
  return array;
}

vtkSmartPointer<vtkPoints> MakePoints(const avianlidar::TriangleMesh& mesh)
{
  auto points = vtkAvianLidarArrays::MakePoints(static_cast<vtkIdType>(mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
  {
    points->SetPoint(static_cast<vtkIdType>(i), &mesh.points[i].x);
  }
  return points;
}

vtkSmartPointer<vtkCellArray> MakeTriangles(const avianlidar::TriangleMesh& mesh)
{
  const auto count = static_cast<vtkIdType>(mesh.size());
  vtkNew<vtkIdTypeArray> offsets;
  vtkAvianLidarArrays::SetTuples(offsets.Get(), count + 1);
  vtkNew<vtkIdTypeArray> connectivity;
  vtkAvianLidarArrays::SetTuples(connectivity.Get(), 3 * count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const auto& t = mesh.triangles[static_cast<std::size_t>(i)];
    std::copy(t.begin(), t.end(), connectivity->GetPointer(3 * i));
    offsets->SetValue(i, 3 * i);
  }
  offsets->SetValue(count, 3 * count);
  auto polys = vtkSmartPointer<vtkCellArray>::New();
  polys->SetData(offsets, connectivity);
  return polys;
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarSurfaces::ToPolyData(vtkFieldData* fields,
  const vtkAvianLidarSurfaces* before, vtkSmartPointer<vtkPolyData> last) const
{
  namespace Arrays = vtkAvianLidarArrays;
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  const bool known = before && last;
  const bool sameMesh = known && before->mesh == this->mesh;
  if (sameMesh)
  {
    poly->SetPoints(last->GetPoints());
    poly->SetPolys(last->GetPolys());
  }
  else
  {
    poly->SetPoints(MakePoints(*this->mesh));
    poly->SetPolys(MakeTriangles(*this->mesh));
  }
  vtkCellData* cells = poly->GetCellData();
  const auto addLast = [&](const Arrays::Name& name)
  { cells->AddArray(last->GetCellData()->GetArray(name.name)); };
  const auto addIds = [&](const Arrays::Name& name, const avianlidar::SharedVector<int>& ids,
                        const avianlidar::SharedVector<int>& idsBefore)
  {
    if (ids.sharesWith(idsBefore))
    {
      addLast(name);
    }
    else
    {
      cells->AddArray(MakeArray<vtkIntArray>(name, ids));
    }
  };
  const vtkAvianLidarSurfaces none;
  addIds(Arrays::ObjectId, this->objectIds, (known ? *before : none).objectIds);
  addIds(Arrays::MaterialId, this->materialIds, (known ? *before : none).materialIds);
  const bool sameMaterials = known && this->materials.sharesWith(before->materials);
  const std::pair<Arrays::Name, double Material::*> coefficients[] = {
    { Arrays::Kd, &Material::kd }, { Arrays::Ks, &Material::ks }, { Arrays::Kp, &Material::kp }
  };
  for (const auto& [name, coefficient] : coefficients)
  {
    if (sameMaterials)
    {
      addLast(name);
    }
    else
    {
      cells->AddArray(MakeArray(name, this->materials, coefficient,
        (known ? *before : none).materials, known ? last.Get() : nullptr));
    }
  }
  if (fields)
  {
    poly->GetFieldData()->PassData(fields);
  }
  Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::ObjectNames, this->objectNames);
  Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::MaterialNames, this->materialNames);
  return poly;
}
