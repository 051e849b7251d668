// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSceneReader.h"

#include "Private/SceneBuilder.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarMedia.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarText.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <vtksys/SystemTools.hxx>

#include <array>
#include <new>

vtkStandardNewMacro(vtkAvianLidarSceneReader);

namespace
{
using namespace avianlidar::scene;

void AddTriple(
  vtkFieldData* fields, const vtkAvianLidarArrays::Name& name, const std::array<double, 3>& values)
{
  auto array = vtkAvianLidarArrays::Make<vtkDoubleArray>(name, 1, 3);
  array->SetTuple(0, values.data());
  fields->AddArray(array);
}

void AddGeometry(const Mesh& mesh, vtkPolyData* block)
{
  auto points = vtkAvianLidarArrays::MakePoints(static_cast<vtkIdType>(mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
  {
    points->SetPoint(static_cast<vtkIdType>(i), mesh.points[i].data());
  }
  block->SetPoints(points);
  block->SetPolys(vtkAvianLidarMakeTriangles(mesh.triangles, [](std::size_t i) { return i; }));
}

void AddCellArrays(
  const Mesh& mesh, int objectId, const std::vector<Material>& materials, vtkPolyData* block)
{
  const auto n = static_cast<vtkIdType>(mesh.triangles.size());
  auto object = vtkAvianLidarArrays::Make<vtkIntArray>(vtkAvianLidarArrays::ObjectId, n);
  object->FillValue(objectId);
  block->GetCellData()->AddArray(object);
  block->GetCellData()->AddArray(
    vtkAvianLidarArrays::MakeOf<vtkIntArray>(vtkAvianLidarArrays::MaterialId, mesh.materials));
  vtkAvianLidarMaterials::AddCoefficients(block->GetCellData(), n,
    [&](vtkIdType i) -> const avianlidar::Material&
    { return materials[mesh.materials[i]].coefficients; });
}

void AddFieldData(const BuiltScene& built, vtkFieldData* fields)
{
  const Scene& scene = built.description;
  std::vector<std::string> names, classes, materials;
  for (const Part& part : built.parts)
  {
    names.push_back(part.name);
    classes.push_back(part.objectClass);
  }
  for (const Material& material : scene.materials)
  {
    materials.push_back(material.name);
  }
  vtkAvianLidarArrays::SetFieldStrings(fields, vtkAvianLidarArrays::ObjectNames, names);
  vtkAvianLidarArrays::SetFieldStrings(fields, vtkAvianLidarArrays::ObjectClasses, classes);
  vtkAvianLidarArrays::SetFieldStrings(fields, vtkAvianLidarArrays::MaterialNames, materials);
  vtkAvianLidarArrays::SetFieldStrings(fields, vtkAvianLidarArrays::Attribution, scene.attribution);
  vtkAvianLidarArrays::SetFieldStrings(fields, vtkAvianLidarArrays::SceneReport, built.report);
  if (scene.origin)
  {
    AddTriple(fields, vtkAvianLidarArrays::GeodeticOrigin,
      { scene.origin->latitude, scene.origin->longitude, scene.origin->height });
  }
  if (scene.lidar)
  {
    AddTriple(fields, vtkAvianLidarArrays::LidarPosition, *scene.lidar);
  }
}

// Adds a block for each part. Frees the triangles of each part after the copy, so that memory does
// not hold a large scene twice.
void AddBlocks(BuiltScene& built, bool empty, vtkMultiBlockDataSet* output)
{
  vtkAbstractArray* materialNames =
    output->GetFieldData()->GetAbstractArray(vtkAvianLidarArrays::MaterialNames.name);
  for (std::size_t i = 0; i < built.parts.size(); ++i)
  {
    Part& part = built.parts[i];
    const auto index = static_cast<unsigned int>(i);
    vtkSmartPointer<vtkPolyData> block;
    if (!empty)
    {
      block = vtkSmartPointer<vtkPolyData>::New();
      AddGeometry(part.mesh, block);
      if (part.medium.empty())
      {
        AddCellArrays(part.mesh, static_cast<int>(i), built.description.materials, block);
      }
      else
      {
        constexpr double drawn = 2000.0; // size of the drawing of an unbounded medium, m
        const std::string named = vtkAvianLidarMedia::WithObject(part.medium, part.name, -1);
        block = vtkAvianLidarMedia::Surface(
          vtkAvianLidarMedia::WithCrowns(named, block, part.crowns), block, drawn);
      }
      vtkAvianLidarArrays::SetFieldStrings(
        block->GetFieldData(), vtkAvianLidarArrays::ObjectNames, { part.name });
      vtkAvianLidarArrays::SetFieldStrings(
        block->GetFieldData(), vtkAvianLidarArrays::ObjectClasses, { part.objectClass });
      block->GetFieldData()->AddArray(materialNames);
    }
    output->SetBlock(index, block);
    output->GetMetaData(index)->Set(
      vtkCompositeDataSet::NAME(), vtkAvianLidarText(part.name).c_str());
    part.mesh = Mesh();
  }
}

std::string Joined(const std::vector<std::string>& lines)
{
  std::string text;
  for (const std::string& line : lines)
  {
    text += "\n  " + line;
  }
  return text;
}
}

//------------------------------------------------------------------------------
vtkAvianLidarSceneReader::vtkAvianLidarSceneReader()
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkAvianLidarSceneReader::~vtkAvianLidarSceneReader()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
void vtkAvianLidarSceneReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Text: " << this->Text << "\n";
}

//------------------------------------------------------------------------------
int vtkAvianLidarSceneReader::CanReadFile(const char* fileName)
{
  if (!fileName)
  {
    return 0;
  }
  const std::string name = vtksys::SystemTools::LowerCase(fileName);
  return vtksys::SystemTools::StringEndsWith(name, ".lidarscene.json") &&
    vtksys::SystemTools::FileExists(fileName, true) &&
    vtksys::SystemTools::TestFileAccess(fileName, vtksys::TEST_FILE_READ);
}

//------------------------------------------------------------------------------
int vtkAvianLidarSceneReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  outputVector->GetInformationObject(0)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarSceneReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkInformation* info = outputVector->GetInformationObject(0);
      vtkMultiBlockDataSet* output = vtkMultiBlockDataSet::GetData(info);
      output->Initialize();
      vtkAvianLidarRequire(this->FileName && *this->FileName
          ? ""
          : "FileName is not set, expected the name of a .lidarscene.json file");
      const int piece = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER())
        ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER())
        : 0;
      vtkAvianLidarAbort::StopIfWanted(this);
      try
      {
        const auto progress = vtkAvianLidarAbort::KeepGoing(this);
        BuiltScene built = piece == 0 ? BuildScene(this->FileName, progress, this->Text)
                                      : OutlineScene(this->FileName, progress, this->Text);
        if (!built.warnings.empty())
        {
          vtkWarningMacro("" << vtkAvianLidarText(this->FileName + (":" + Joined(built.warnings))));
        }
        AddFieldData(built, output->GetFieldData());
        AddBlocks(built, piece > 0, output);
        this->UpdateProgress(1.0);
      }
      catch (const std::bad_alloc&)
      {
        vtkAvianLidarRequire(": there is not enough memory for it", this->FileName);
      }
    });
}
