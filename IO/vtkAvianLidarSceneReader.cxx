// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSceneReader.h"

#include "SceneBuilder.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarMedia.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarSlices.h"
#include "vtkAvianLidarText.h"

#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

#include <vtksys/SystemTools.hxx>

#include <new>

namespace Arrays = vtkAvianLidarArrays;

vtkStandardNewMacro(vtkAvianLidarSceneReader);

namespace
{
using namespace avianlidar::scene;

void AddGeometry(const Mesh& mesh, vtkPolyData* block)
{
  auto points = Arrays::MakePoints(static_cast<vtkIdType>(mesh.points.size()));
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    points->SetPoint(i, mesh.points[i].data());
  }
  block->SetPoints(points);
  block->SetPolys(vtkAvianLidarMakeTriangles(mesh.triangles, [](std::size_t i) { return i; }));
}

void AddCellArrays(
  const Mesh& mesh, int objectId, const std::vector<Material>& materials, vtkPolyData* block)
{
  const auto n = static_cast<vtkIdType>(mesh.triangles.size());
  block->GetCellData()->AddArray(Arrays::Constant(Arrays::ObjectId, n, objectId));
  block->GetCellData()->AddArray(Arrays::MakeOf<vtkIntArray>(Arrays::MaterialId, mesh.materials));
  vtkAvianLidarMaterials::AddCoefficients(block->GetCellData(), n,
    [&](vtkIdType i) -> const avianlidar::Material&
    { return materials[mesh.materials[i]].coefficients; });
}

template <class ArrayT, class Get, class Set>
void Divide(const std::vector<vtkPolyData*>& blocks, const Get& get, const Set& set)
{
  std::vector<ArrayT*> arrays;
  for (vtkPolyData* block : blocks)
  {
    arrays.push_back(static_cast<ArrayT*>(get(block)));
  }
  const auto slices = vtkAvianLidarSlices::Divide(arrays);
  for (std::size_t i = 0; i < blocks.size(); ++i)
  {
    set(blocks[i], slices[i]);
  }
}

// Moves each array of the blocks into one piece of memory, which a collision tree can share.
void ShareMemory(const std::vector<vtkPolyData*>& blocks)
{
  const auto pointsOf = [](vtkPolyData* block) { return block->GetPoints()->GetData(); };
  Divide<vtkDoubleArray>(blocks, pointsOf,
    [](vtkPolyData* block, vtkDataArray* slice) { block->GetPoints()->SetData(slice); });
  const auto add = [](vtkPolyData* block, vtkDataArray* slice)
  { block->GetCellData()->AddArray(slice); };
  for (const Arrays::Name& name : { Arrays::ObjectId, Arrays::MaterialId })
  {
    Divide<vtkIntArray>(
      blocks, [&](vtkPolyData* block) { return block->GetCellData()->GetArray(name.name); }, add);
  }
  for (const avianlidar::MaterialCoefficient& coefficient : avianlidar::MaterialCoefficients)
  {
    Divide<vtkDoubleArray>(
      blocks, [&](vtkPolyData* block) { return block->GetCellData()->GetArray(coefficient.name); },
      add);
  }
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
  Arrays::SetFieldStrings(fields, Arrays::ObjectNames, names);
  Arrays::SetFieldStrings(fields, Arrays::ObjectClasses, classes);
  Arrays::SetFieldStrings(fields, Arrays::MaterialNames, materials);
  Arrays::SetFieldStrings(fields, Arrays::Attribution, scene.attribution);
  Arrays::SetFieldStrings(fields, Arrays::SceneReport, built.report);
  if (scene.origin)
  {
    const double origin[] = { scene.origin->latitude, scene.origin->longitude,
      scene.origin->height };
    Arrays::SetFieldVector(fields, Arrays::GeodeticOrigin, origin);
  }
  if (scene.lidar)
  {
    Arrays::SetFieldVector(fields, Arrays::LidarPosition, scene.lidar->data());
  }
}

// Adds a block for each part. Frees the triangles of each part after the copy, so that memory does
// not hold a large scene twice.
void AddBlocks(BuiltScene& built, bool empty, vtkMultiBlockDataSet* output)
{
  vtkAbstractArray* materialNames =
    output->GetFieldData()->GetAbstractArray(Arrays::MaterialNames.name);
  std::vector<vtkPolyData*> surfaces;
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
        surfaces.push_back(block);
      }
      else
      {
        constexpr double drawn = 2000.0; // size of the drawing of an unbounded medium, m
        const std::string named = vtkAvianLidarMedia::WithObject(part.medium, part.name, -1);
        block = vtkAvianLidarMedia::Surface(
          vtkAvianLidarMedia::WithCrowns(named, block, part.crowns), block, drawn);
      }
      Arrays::SetFieldStrings(block->GetFieldData(), Arrays::ObjectNames, { part.name });
      Arrays::SetFieldStrings(block->GetFieldData(), Arrays::ObjectClasses, { part.objectClass });
      block->GetFieldData()->AddArray(materialNames);
    }
    output->SetBlock(index, block);
    output->GetMetaData(index)->Set(
      vtkCompositeDataSet::NAME(), vtkAvianLidarText(part.name).c_str());
    part.mesh = Mesh();
  }
  ShareMemory(surfaces);
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
vtkAvianLidarPrintSelfMacro(vtkAvianLidarSceneReader, ErrorsAsData, FileName, Text);

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
      avianlidar::failIf(!this->FileName || !*this->FileName,
        "FileName is not set, expected the name of a .lidarscene.json file");
      const bool isOther = vtkAvianLidarCloudFields::IsOtherPiece(info);
      try
      {
        const auto progress = vtkAvianLidarAbort::KeepGoing(this);
        BuiltScene built = isOther ? OutlineScene(this->FileName, progress, this->Text)
                                   : BuildScene(this->FileName, progress, this->Text);
        std::string warnings;
        for (const std::string& line : built.warnings)
        {
          warnings += "\n  " + line;
        }
        if (!warnings.empty())
        {
          vtkWarningMacro("" << vtkAvianLidarText(this->FileName + (":" + warnings)));
        }
        AddFieldData(built, output->GetFieldData());
        AddBlocks(built, isOther, output);
        this->UpdateProgress(1.0);
      }
      catch (const std::bad_alloc&)
      {
        avianlidar::fail(this->FileName, ": there is not enough memory for it");
      }
    });
}
