// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

namespace
{
vtkSmartPointer<vtkPoints> MakePoints(const avianlidar::TriangleMesh& mesh)
{
  auto points = vtkAvianLidarArrays::MakePoints(static_cast<vtkIdType>(mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
  {
    points->SetPoint(static_cast<vtkIdType>(i), &mesh.points[i].x);
  }
  return points;
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarSurfaces::ToPolyData(
  vtkFieldData* fields, const vtkAvianLidarSurfaces* before, vtkPolyData* last) const
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
    poly->SetPolys(vtkAvianLidarMakeTriangles(this->mesh->triangles));
  }
  vtkCellData* cells = poly->GetCellData();
  const auto addLast = [&](const char* name)
  { cells->AddArray(last->GetCellData()->GetArray(name)); };
  const auto addIds = [&](const Arrays::Name& name, const avianlidar::SharedVector<int>& ids,
                        const avianlidar::SharedVector<int>& idsBefore)
  {
    if (ids.sharesWith(idsBefore))
    {
      addLast(name.name);
    }
    else
    {
      cells->AddArray(Arrays::MakeOf<vtkIntArray>(name, ids));
    }
  };
  const vtkAvianLidarSurfaces none;
  addIds(Arrays::ObjectId, this->objectIds, (known ? *before : none).objectIds);
  addIds(Arrays::MaterialId, this->materialIds, (known ? *before : none).materialIds);
  if (known && this->materials.sharesWith(before->materials))
  {
    for (const avianlidar::MaterialCoefficient& coefficient : avianlidar::MaterialCoefficients)
    {
      addLast(coefficient.name);
    }
  }
  else
  {
    vtkAvianLidarMaterials::AddCoefficients(cells, static_cast<vtkIdType>(this->materials.size()),
      [&](vtkIdType i) -> const avianlidar::Material& { return this->materials[i]; });
  }
  if (fields)
  {
    poly->GetFieldData()->PassData(fields);
  }
  Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::ObjectNames, this->objectNames);
  if (!this->objectClasses.empty())
  {
    Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::ObjectClasses, this->objectClasses);
  }
  Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::MaterialNames, this->materialNames);
  return poly;
}
