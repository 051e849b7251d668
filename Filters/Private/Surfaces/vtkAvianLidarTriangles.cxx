// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTriangles.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"
#include "vtkTriangleStrip.h"

namespace
{
bool IsShort(vtkCellArray* cells, vtkIdType cell)
{
  return cells->GetCellSize(cell) < 3;
}

bool HasShort(vtkCellArray* cells)
{
  vtkIdType cell = 0;
  while (cell < cells->GetNumberOfCells() && !IsShort(cells, cell))
  {
    ++cell;
  }
  return cell < cells->GetNumberOfCells();
}

/// Polygons of at least three points, and strips as triangles, without vertices and lines.
/// vtkTriangleFilter reads points that shorter polygons do not have. The filter of VTK 9.3 also
/// mixes up cell arrays if the input has triangles and other cells.
vtkSmartPointer<vtkPolyData> PolygonsOf(vtkPolyData* data)
{
  auto rest = vtkSmartPointer<vtkPolyData>::New();
  rest->SetPoints(data->GetPoints());
  rest->GetFieldData()->PassData(data->GetFieldData());
  vtkNew<vtkCellArray> polygons;
  vtkNew<vtkIdList> from;
  vtkNew<vtkIdList> points;
  vtkIdType id = data->GetNumberOfVerts() + data->GetNumberOfLines();
  for (vtkCellArray* cells : { data->GetPolys(), data->GetStrips() })
  {
    for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell, ++id)
    {
      if (IsShort(cells, cell))
      {
        continue;
      }
      cells->GetCellAtId(cell, points);
      if (cells == data->GetStrips())
      {
        vtkTriangleStrip::DecomposeStrip(
          static_cast<int>(points->GetNumberOfIds()), points->GetPointer(0), polygons);
      }
      else
      {
        polygons->InsertNextCell(points);
      }
      while (from->GetNumberOfIds() < polygons->GetNumberOfCells())
      {
        from->InsertNextId(id);
      }
    }
  }
  rest->SetPolys(polygons);
  vtkCellData* arrays = rest->GetCellData();
  arrays->CopyAllOn();
  arrays->CopyAllocate(data->GetCellData(), from->GetNumberOfIds());
  for (vtkIdType to = 0; to < from->GetNumberOfIds(); ++to)
  {
    arrays->CopyData(data->GetCellData(), from->GetId(to), to);
  }
  return rest;
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarTriangles(vtkPolyData* data)
{
  vtkSmartPointer<vtkPolyData> input = data;
  if (data->GetNumberOfCells() > data->GetNumberOfPolys() || HasShort(data->GetPolys()))
  {
    input = PolygonsOf(data);
  }
  vtkNew<vtkTriangleFilter> filter;
  filter->PassVertsOff();
  filter->PassLinesOff();
  filter->SetInputData(input);
  filter->Update();
  return filter->GetOutput();
}
