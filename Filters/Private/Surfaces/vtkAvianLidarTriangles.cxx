// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTriangles.h"

#include "PolygonTriangulation.h"
#include "vtkAvianLidarCells.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <limits>
#include <vector>

namespace
{
using avianlidar::Vec3;
using Triangle = avianlidar::PolygonTriangulation::Triangle;

/// Collects triangles, and the cells from which they come.
class Collector
{
public:
  std::vector<Triangle> Triangles;
  vtkNew<vtkIdList> From;
  std::vector<Vec3> Added; ///< points after the points of the data
  avianlidar::LostAreas Lost;

  Collector(vtkPolyData* data, vtkDataArray* names)
    : Points(data->GetPoints())
    , Names(names)
    , Precision(this->Points && this->Points->GetDataType() == VTK_FLOAT
          ? std::numeric_limits<float>::epsilon()
          : 0.0)
  {
  }

  void AddTriangle(vtkIdType cell, const Triangle& triangle)
  {
    this->Triangles.push_back(triangle);
    this->From->InsertNextId(cell);
  }

  void AddStrip(vtkIdType cell, vtkIdList* strip)
  {
    const vtkIdType* ids = strip->GetPointer(0);
    for (vtkIdType i = 0; i + 2 < strip->GetNumberOfIds(); ++i)
    {
      this->AddTriangle(cell, { ids[i], ids[i + 1 + i % 2], ids[i + 2 - i % 2] });
    }
  }

  void AddPolygon(vtkIdType cell, vtkIdList* polygon)
  {
    const vtkIdType size = polygon->GetNumberOfIds();
    const vtkIdType* ids = polygon->GetPointer(0);
    if (size == 3)
    {
      this->AddTriangle(cell, { ids[0], ids[1], ids[2] });
    }
    if (size <= 3)
    {
      return;
    }
    this->Corners.resize(static_cast<std::size_t>(size));
    for (vtkIdType i = 0; i < size; ++i)
    {
      this->Points->GetPoint(ids[i], &this->Corners[i].x);
    }
    this->Polygon.Divide(this->Corners);
    const vtkIdType first = this->Points->GetNumberOfPoints() +
      static_cast<vtkIdType>(this->Added.size()) - size; // of added points, less their first index
    for (Triangle triangle : this->Polygon.GetTriangles())
    {
      for (std::int64_t& corner : triangle)
      {
        corner = corner < size ? ids[corner] : first + corner;
      }
      this->AddTriangle(cell, triangle);
    }
    this->Added.insert(
      this->Added.end(), this->Polygon.GetAdded().begin(), this->Polygon.GetAdded().end());
    const bool named = this->Names && this->Names->GetNumberOfTuples() > cell;
    this->Lost.Check(this->Polygon,
      named ? static_cast<vtkIdType>(this->Names->GetComponent(cell, 0)) : cell,
      this->Precision * this->Polygon.GetLargest());
  }

private:
  vtkPoints* const Points;
  vtkDataArray* const Names;
  const double Precision; ///< distance from 1 to the next coordinate, if in single precision
  avianlidar::PolygonTriangulation Polygon;
  std::vector<Vec3> Corners;
};

/// The points of `data`, followed by other points.
vtkSmartPointer<vtkPoints> PointsWith(vtkPolyData* data, const std::vector<Vec3>& added)
{
  if (added.empty())
  {
    return data->GetPoints();
  }
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(data->GetPoints()->GetDataType());
  points->DeepCopy(data->GetPoints());
  for (const Vec3& p : added)
  {
    points->InsertNextPoint(p.x, p.y, p.z);
  }
  return points;
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarTriangles(
  vtkPolyData* data, std::string* warning, vtkDataArray* names)
{
  Collector found(data, names);
  vtkIdType cell = data->GetNumberOfVerts() + data->GetNumberOfLines();
  vtkNew<vtkIdList> ids;
  for (vtkCellArray* cells : { data->GetPolys(), data->GetStrips() })
  {
    const bool areStrips = cells == data->GetStrips();
    for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i, ++cell)
    {
      cells->GetCellAtId(i, ids);
      areStrips ? found.AddStrip(cell, ids) : found.AddPolygon(cell, ids);
    }
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(PointsWith(data, found.Added));
  result->SetPolys(vtkAvianLidarMakeTriangles(found.Triangles, [](std::size_t i) { return i; }));
  result->GetFieldData()->PassData(data->GetFieldData());
  vtkCellData* arrays = data->GetCellData();
  for (int k = 0; k < arrays->GetNumberOfArrays(); ++k)
  {
    vtkAbstractArray* given = arrays->GetAbstractArray(k);
    if (given->GetNumberOfTuples() < data->GetNumberOfCells())
    {
      continue; // broken
    }
    auto taken = vtk::TakeSmartPointer(given->NewInstance());
    taken->SetName(given->GetName());
    taken->SetNumberOfComponents(given->GetNumberOfComponents());
    taken->SetNumberOfTuples(found.From->GetNumberOfIds());
    given->GetTuples(found.From, taken);
    result->GetCellData()->AddArray(taken);
  }
  if (warning)
  {
    *warning = found.Lost.Sentence("cell");
  }
  return result;
}
