// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleOrder.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

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
  // Cells come in the order of the input.
  std::vector<std::uint32_t> given(this->order.size());
  for (std::uint32_t i = 0; i < given.size(); ++i)
  {
    given[this->order[i]] = i;
  }
  const auto asGiven = [&](const auto& values)
  {
    std::vector<std::decay_t<decltype(values[0])>> ordered(values.begin(), values.end());
    avianlidar::reorder(ordered, given);
    return ordered;
  };
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  poly->SetPoints(MakePoints(*this->mesh));
  poly->SetPolys(vtkAvianLidarMakeTriangles(asGiven(this->mesh->triangles)));
  vtkCellData* cells = poly->GetCellData();
  cells->AddArray(Arrays::MakeOf<vtkIntArray>(Arrays::ObjectId, asGiven(this->objectIds)));
  cells->AddArray(Arrays::MakeOf<vtkIntArray>(Arrays::MaterialId, asGiven(this->materialIds)));
  vtkAvianLidarMaterials::AddCoefficients(cells, static_cast<vtkIdType>(this->materials.size()),
    [&](vtkIdType i) -> const avianlidar::Material&
    { return this->materials[given.empty() ? i : given[i]]; });
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
