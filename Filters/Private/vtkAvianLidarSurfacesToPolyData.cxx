// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>

namespace
{
using avianlidar::Material;

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
  vtkAvianLidarArrays::SetFieldStrings(
    poly->GetFieldData(), vtkAvianLidarArrays::ObjectNames, this->objectNames);
  vtkAvianLidarArrays::SetFieldStrings(
    poly->GetFieldData(), vtkAvianLidarArrays::MaterialNames, this->materialNames);
  return poly;
}
