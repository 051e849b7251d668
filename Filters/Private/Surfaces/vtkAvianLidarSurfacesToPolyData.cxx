// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cstddef>

namespace
{
vtkSmartPointer<vtkPoints> MakePoints(const avianlidar::TriangleMesh& mesh)
{
  auto points = vtkAvianLidarArrays::MakePoints(static_cast<vtkIdType>(mesh.points.size()));
  auto* coordinates = static_cast<double*>(points->GetVoidPointer(0));
  for (const avianlidar::Vec3& point : mesh.points)
  {
    coordinates = std::copy_n(&point.x, 3, coordinates);
  }
  return points;
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarSurfaces::ToPolyData(vtkFieldData* fields) const
{
  namespace Arrays = vtkAvianLidarArrays;
  // Cells are in the order of the input.
  const bool isSorted = !this->order || this->order->empty();
  const auto cellOf = [&](std::size_t i)
  { return static_cast<vtkIdType>(isSorted ? i : (*this->order)[i]); };
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  poly->SetPoints(MakePoints(*this->mesh));
  poly->SetPolys(vtkAvianLidarMakeTriangles(this->mesh->triangles, cellOf));
  const auto count = static_cast<vtkIdType>(this->materials.size());
  auto objects = Arrays::Make<vtkIntArray>(Arrays::ObjectId, count);
  auto kinds = Arrays::Make<vtkIntArray>(Arrays::MaterialId, count);
  poly->GetCellData()->AddArray(objects);
  poly->GetCellData()->AddArray(kinds);
  vtkAvianLidarMaterials::Coefficients coefficients(poly->GetCellData(), count);
  for (std::size_t i = 0; i < this->materials.size(); ++i)
  {
    const vtkIdType cell = cellOf(i);
    objects->SetValue(cell, this->objectIds[i]);
    kinds->SetValue(cell, this->materialIds[i]);
    coefficients.Set(cell, this->materials[i]);
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
  if (!this->media.empty())
  {
    Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::Media, this->media);
  }
  return poly;
}
