// SPDX-License-Identifier: BSD-3-Clause
#include "Imports.h"

#include "MeshFormats.h"
#include "RegularFile.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarTriangles.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDataSetSurfaceFilter.h"
#include "vtkExecutive.h"
#include "vtkGenericDataObjectReader.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
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

// Throws std::bad_alloc if VTK reports that an array cannot be allocated. Debian's VTK would end
// the process after the report.
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
    this->Superclass::DisplayErrorText(text);
  }

  // The legacy reader only warns of missing values and does not initialise their memory.
  void DisplayGenericWarningText(const char* text) override
  {
    failIf(std::strstr(text, "Error reading"), "VTK cannot read it: ", FirstLine(text));
    this->Superclass::DisplayGenericWarningText(text);
  }

  vtkTypeMacro(ThrowingWindow, vtkOutputWindow);

  std::string First; // text of the first error
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
  outside->Update();
  const vtkSmartPointer<vtkPolyData> surface = vtkAvianLidarTriangles(outside->GetOutput());
  surface->GetFieldData()->ShallowCopy(data->GetFieldData());
  const auto first = static_cast<std::int64_t>(mesh.points.size());
  double farthest = 0.0;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    Vec3 p;
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
    throw Error(std::string("holds no geometry but a ") + data->GetClassName());
  }
  failIf(
    mesh.triangles.empty() && !throwing->First.empty(), "VTK cannot read it: ", throwing->First);
  return mesh;
}
}
