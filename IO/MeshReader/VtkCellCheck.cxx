// SPDX-License-Identifier: BSD-3-Clause
#include "Imports.h"

#include "vtkAvianLidarCells.h"

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkCellTypes.h"
#include "vtkDataArray.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVersionMacros.h"

#include <algorithm>

namespace avianlidar::scene
{
namespace
{
void CheckPoints(vtkCellArray* cells, vtkIdType points)
{
  const std::string wrong = vtkAvianLidarCellsError(cells, points);
  failIf(!wrong.empty(), "is broken: ", wrong);
}

// Returns the least number of points of a type with a variable number, or 0 for any other type.
vtkIdType LeastPoints(int type)
{
  switch (type)
  {
    case VTK_POLY_VERTEX:
    case VTK_CONVEX_POINT_SET:
      return 1;
    case VTK_POLY_LINE:
      return 2;
    case VTK_TRIANGLE_STRIP:
    case VTK_POLYGON:
      return 3;
    case VTK_POLYHEDRON:
      return 4;
    case VTK_QUADRATIC_POLYGON:
      return 6;
    default:
      return 0;
  }
}

// @param of cells of each type, kept between calls
void CheckSize(int type, vtkIdType size, vtkGenericCell* of)
{
  constexpr int lastOfFixedOrder = VTK_POLYHEDRON;
  failIf(type > lastOfFixedOrder, "has cells of type ", type,
    ", of variable order, which are not supported: tessellate them first");
  vtkIdType least = LeastPoints(type);
  vtkIdType most = VTK_ID_MAX;
  if (least == 0)
  {
    of->SetCellType(type);
    least = most = of->GetNumberOfPoints();
  }
  failIf(size < least || size > most, "is broken: a ", vtkCellTypes::GetClassNameFromTypeId(type),
    " has ", size, " points");
}

// Throws Error unless a polyhedron has a face.
void CheckNumberOfFaces(vtkIdType faces)
{
  failIf(faces < 1, "is broken: a polyhedron's faces are missing");
  failIf(faces < 4, "is broken: a polyhedron has ", faces, " faces");
}

void CheckSizeOfFace(vtkIdType points)
{
  failIf(points < 3, "is broken: a face of a polyhedron has ", points, " points");
}

#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 3, 20230807)
// Checks the faces of polyhedra, which are cells of a separate array.
void CheckFaces(vtkUnstructuredGrid* grid)
{
  vtkCellArray* faces = grid->GetPolyhedronFaces();
  if (faces)
  {
    CheckPoints(faces, grid->GetNumberOfPoints());
  }
  if (vtkCellArray* of = grid->GetPolyhedronFaceLocations())
  {
    CheckPoints(of, faces ? faces->GetNumberOfCells() : 0);
  }
}

void CheckFaces(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkCellArray* of = grid->GetPolyhedronFaceLocations();
  vtkNew<vtkIdList> faces;
  if (of && cell < of->GetNumberOfCells())
  {
    of->GetCellAtId(cell, faces);
  }
  CheckNumberOfFaces(faces->GetNumberOfIds());
  for (vtkIdType face = 0; face < faces->GetNumberOfIds(); ++face)
  {
    CheckSizeOfFace(grid->GetPolyhedronFaces()->GetCellSize(faces->GetId(face)));
  }
}
#else
void CheckFaces(vtkUnstructuredGrid*) {}

// Checks the faces of a polyhedron, given as the number of faces and the points of each face.
void CheckFaces(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkIdTypeArray* faces = grid->GetFaces();
  vtkIdTypeArray* places = grid->GetFaceLocations();
  const vtkIdType end = faces ? faces->GetNumberOfValues() : 0;
  vtkIdType place =
    places && cell < places->GetNumberOfValues() ? places->GetValue(cell) : vtkIdType(-1);
  const auto next = [&] { return place >= 0 && place < end ? faces->GetValue(place++) : 0; };
  vtkIdType face = next();
  for (CheckNumberOfFaces(face); face > 0; --face)
  {
    vtkIdType point = next();
    for (CheckSizeOfFace(point); point > 0; --point)
    {
      const vtkIdType id = place < end ? next() : -1;
      failIf(id < 0 || id >= grid->GetNumberOfPoints(),
        "is broken: a cell has a point id outside 0 to ", grid->GetNumberOfPoints() - 1);
    }
  }
}
#endif

void CheckGrid(vtkUnstructuredGrid* grid)
{
  CheckPoints(grid->GetCells(), grid->GetNumberOfPoints());
  CheckFaces(grid);
  vtkNew<vtkGenericCell> of;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    const int type = grid->GetCellType(cell);
    CheckSize(type, grid->GetCells()->GetCellSize(cell), of);
    if (type == VTK_POLYHEDRON)
    {
      CheckFaces(grid, cell);
    }
  }
}

// Checks the number of points of an axis, which VTK's readers and surface filter do not check.
void CheckPointsOfAxis(vtkDataArray* coordinates, int expected)
{
  const vtkIdType found = coordinates ? coordinates->GetNumberOfTuples() : 0;
  failIf(found != expected || expected < 1, "is broken: an axis has ", found,
    " coordinates, expected ", std::max(expected, 1));
}

void CheckRectilinear(vtkRectilinearGrid* grid)
{
  const int* dimensions = grid->GetDimensions();
  CheckPointsOfAxis(grid->GetXCoordinates(), dimensions[0]);
  CheckPointsOfAxis(grid->GetYCoordinates(), dimensions[1]);
  CheckPointsOfAxis(grid->GetZCoordinates(), dimensions[2]);
}

void CheckStructured(vtkStructuredGrid* grid)
{
  int dimensions[3];
  grid->GetDimensions(dimensions);
  double expected = 1.0; // a product of three ints may exceed 64 bits
  for (const int dimension : dimensions)
  {
    expected *= std::max(dimension, 0);
  }
  const vtkIdType found = grid->GetNumberOfPoints();
  failIf(static_cast<double>(found) != expected, "is broken: a grid of ", dimensions[0], " x ",
    dimensions[1], " x ", dimensions[2], " has ", found, " points");
}

void CheckSurface(vtkPolyData* surface)
{
  for (vtkCellArray* cells :
    { surface->GetVerts(), surface->GetLines(), surface->GetPolys(), surface->GetStrips() })
  {
    CheckPoints(cells, surface->GetNumberOfPoints());
  }
  vtkNew<vtkGenericCell> of;
  for (vtkIdType strip = 0; strip < surface->GetNumberOfStrips(); ++strip)
  {
    CheckSize(VTK_TRIANGLE_STRIP, surface->GetStrips()->GetCellSize(strip), of);
  }
}
}

void CheckCells(vtkDataSet* data)
{
  if (auto* surface = vtkPolyData::SafeDownCast(data))
  {
    CheckSurface(surface);
  }
  else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(data))
  {
    CheckGrid(grid);
  }
  else if (auto* axes = vtkRectilinearGrid::SafeDownCast(data))
  {
    CheckRectilinear(axes);
  }
  else if (auto* structured = vtkStructuredGrid::SafeDownCast(data))
  {
    CheckStructured(structured);
  }
}
}
