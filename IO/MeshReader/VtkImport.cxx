// SPDX-License-Identifier: BSD-3-Clause
#include "Imports.h"

#include "MeshImport.h"
#include "RegularFile.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarTriangles.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCellTypes.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDataSetSurfaceFilter.h"
#include "vtkExecutive.h"
#include "vtkGenericCell.h"
#include "vtkGenericDataObjectReader.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkLogger.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVersionMacros.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLGenericDataObjectReader.h"
#include "vtkXMLUtilities.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

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

/**
 * Checks that the cells and the faces of polyhedra name only existing points, that each cell has
 * the number of points of its type, and that each grid has the number of points of its dimensions.
 * Refuses cells of arbitrary order (Lagrange, Bezier, parametric). The time is linear in the number
 * of points of all cells.
 *
 * Throws Error, which names the fault.
 */
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

// Returns the first line of a message of VTK, without file, line, class and address in front.
std::string FirstLine(const std::string& message)
{
  const std::size_t head = message.find("): ");
  const std::size_t begin = head == std::string::npos ? 0 : head + 3;
  const std::size_t end = std::min(message.find('\n', begin), message.size());
  return message.substr(begin, end - begin);
}

// Keeps the messages of a reader of VTK, which would otherwise appear on the screen.
class QuietVtk
{
public:
  explicit QuietVtk(vtkObject* object)
  {
    this->Command->SetClientData(&this->Text);
    this->Command->SetCallback(
      [](vtkObject*, unsigned long event, void* text, void* message)
      {
        if (event == vtkCommand::ErrorEvent)
        {
          auto& first = *static_cast<std::string*>(text);
          first = first.empty() ? FirstLine(static_cast<const char*>(message)) : first;
        }
      });
    object->AddObserver(vtkCommand::ErrorEvent, this->Command);
    object->AddObserver(vtkCommand::WarningEvent, this->Command);
  }
  const std::string& Reason() const { return this->Text; }

private:
  vtkNew<vtkCallbackCommand> Command;
  std::string Text;
};

// Keeps VTK's first error and prints nothing. Throws std::bad_alloc if VTK reports that an array
// cannot be allocated. Debian's VTK would end the process after the report.
class ThrowingWindow : public vtkOutputWindow
{
public:
  static ThrowingWindow* New();

  void DisplayErrorText(const char* text) override
  {
    if (std::strstr(text, "Unable to allocate"))
    {
      throw std::bad_alloc();
    }
    this->First = this->First.empty() ? FirstLine(text) : this->First;
  }

  // The legacy reader only warns of missing values and does not initialise their memory.
  void DisplayGenericWarningText(const char* text) override
  {
    failIf(std::strstr(text, "Error reading"), "VTK cannot read it: ", FirstLine(text));
    this->First = this->First.empty() ? FirstLine(text) : this->First;
  }

  void DisplayWarningText(const char* text) override
  {
    this->First = this->First.empty() ? FirstLine(text) : this->First;
  }

  vtkTypeMacro(ThrowingWindow, vtkOutputWindow);

  std::string First; // text of the first error or warning
};
vtkStandardNewMacro(ThrowingWindow);

template <class Reader>
vtkSmartPointer<vtkDataObject> Read(const std::string& file)
{
  vtkNew<Reader> reader;
  const QuietVtk quiet(reader);
  const QuietVtk quietExecutive(reader->GetExecutive());
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkSmartPointer<vtkDataObject> data = reader->GetOutputDataObject(0);
  failIf(!data || !quiet.Reason().empty() || !quietExecutive.Reason().empty(),
    "VTK cannot read it: ", quiet.Reason(),
    (quiet.Reason().empty() ? quietExecutive.Reason() : std::string()));
  return data;
}

// Throws Error unless the files that a composite names are regular. VTK would open any file.
void RequireRegularParts(vtkXMLDataElement* element, const std::string& folder)
{
  if (const char* name = element->GetAttribute("file"))
  {
    const std::string part = vtksys::SystemTools::CollapseFullPath(name, folder);
    const std::string irregular = whyNotRegular(part);
    failIf(!irregular.empty() || !vtksys::SystemTools::FileExists(part), "names the file ", part,
      ": ", (irregular.empty() ? "no such file" : irregular));
    failIf(!IsVtkFile(part) || EndingOf(part) == ".vtk" || EndingOf(part).find(".vtm") == 0,
      "names the file ", part, ", expected .vtp, .vtu, .vts, .vtr or .vti");
  }
  for (int i = 0; i < element->GetNumberOfNestedElements(); ++i)
  {
    RequireRegularParts(element->GetNestedElement(i), folder);
  }
}

void RequireRegularParts(const std::string& file)
{
  const auto root = vtk::TakeSmartPointer(vtkXMLUtilities::ReadElementFromFile(file.c_str()));
  if (root)
  {
    RequireRegularParts(root, vtksys::SystemTools::GetFilenamePath(file));
  }
}

// Adds material ids and names if the file has the arrays of this project's surfaces.
void AddMaterials(vtkPolyData* surface, Mesh& mesh)
{
  vtkDataArray* ids = surface->GetCellData()->GetArray(vtkAvianLidarArrays::MaterialId.name);
  auto* names = vtkStringArray::SafeDownCast(
    surface->GetFieldData()->GetAbstractArray(vtkAvianLidarArrays::MaterialNames.name));
  const auto first = static_cast<int>(mesh.materialNames.size());
  const vtkIdType known = ids && names ? names->GetNumberOfValues() : 0;
  for (vtkIdType i = 0; i < known; ++i)
  {
    mesh.materialNames.push_back(names->GetValue(i));
  }
  mesh.materialNames.emplace_back();
  for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i)
  {
    const double id = ids && ids->GetNumberOfTuples() > i ? ids->GetComponent(i, 0) : -1.0;
    mesh.materials.push_back(
      first + static_cast<int>(id >= 0 && id < known ? id : static_cast<double>(known)));
  }
}

void AddDataSet(vtkDataSet* data, Mesh& mesh)
{
  CheckCells(data);
  vtkNew<vtkDataSetSurfaceFilter> outside;
  outside->SetInputData(data);
  outside->PassThroughCellIdsOn();
  outside->Update();
  std::string warning;
  const vtkSmartPointer<vtkPolyData> surface = vtkAvianLidarTriangles(outside->GetOutput(),
    &warning, outside->GetOutput()->GetCellData()->GetArray(outside->GetOriginalCellIdsName()));
  if (!warning.empty())
  {
    mesh.warnings.push_back(warning);
  }
  surface->GetFieldData()->ShallowCopy(data->GetFieldData());
  const auto first = static_cast<std::int64_t>(mesh.points.size());
  double farthest = 0.0;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    Point3 p;
    surface->GetPoint(i, p.data());
    farthest = std::max({ farthest, std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) });
    mesh.points.push_back(p);
  }
  if (surface->GetPoints() && surface->GetPoints()->GetDataType() == VTK_FLOAT)
  {
    mesh.rounding = std::max(mesh.rounding, SpacingAt(farthest));
  }
  vtkIdType size = 0;
  const vtkIdType* ids = nullptr;
  vtkCellArray* triangles = surface->GetPolys();
  for (triangles->InitTraversal(); triangles->GetNextCell(size, ids);)
  {
    mesh.triangles.push_back({ first + ids[0], first + ids[1], first + ids[2] });
  }
  AddMaterials(surface, mesh);
}
}

Mesh ReadVtkMesh(const std::string& file)
{
  const vtkNew<ThrowingWindow> throwing;
  vtkOutputWindow::SetInstance(throwing);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  if (EndingOf(file).find(".vtm") == 0)
  {
    RequireRegularParts(file);
  }
  const vtkSmartPointer<vtkDataObject> data = EndingOf(file) == ".vtk"
    ? Read<vtkGenericDataObjectReader>(file)
    : Read<vtkXMLGenericDataObjectReader>(file);
  Mesh mesh;
  if (auto* one = vtkDataSet::SafeDownCast(data))
  {
    AddDataSet(one, mesh);
  }
  else if (auto* many = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> iterator;
    iterator.TakeReference(many->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      if (auto* leaf = vtkDataSet::SafeDownCast(iterator->GetCurrentDataObject()))
      {
        AddDataSet(leaf, mesh);
      }
    }
  }
  else
  {
    fail("holds no geometry but a ", data->GetClassName());
  }
  failIf(
    mesh.triangles.empty() && !throwing->First.empty(), "VTK cannot read it: ", throwing->First);
  if (!throwing->First.empty())
  {
    mesh.warnings.push_back("VTK says: " + throwing->First);
  }
  return mesh;
}
}
