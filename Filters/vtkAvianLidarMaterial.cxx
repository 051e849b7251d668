// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarMaterial.h"

#include "Glob.h"
#include "Reflectance.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarText.h"

#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkDataObjectTree.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
namespace Materials = vtkAvianLidarMaterials;

// Entry of a value of Material; null for MATERIAL_CUSTOM, which has no entry, and unknown values.
const Materials::NamedMaterial* Named(int material)
{
  const int index = material > vtkAvianLidarMaterial::MATERIAL_CUSTOM ? material - 1 : material;
  const bool is = material != vtkAvianLidarMaterial::MATERIAL_CUSTOM && index >= 0 &&
    index < static_cast<int>(std::size(Materials::NamedMaterials));
  return is ? &Materials::NamedMaterials[index] : nullptr;
}

// Values to write to a leaf.
struct Assignment
{
  std::optional<avianlidar::Material> Coefficients; // without value: materials are kept
  std::string MaterialName;
  int ObjectId = -1;
  std::string ObjectName;
};

// A leaf of the input, the name of its block, and whether the pattern chooses the leaf.
struct Leaf
{
  vtkDataObject* Data;
  std::string Name;
  bool Chosen;
};

std::string NameOf(vtkInformation* metaData)
{
  const char* name = metaData && metaData->Has(vtkCompositeDataSet::NAME())
    ? metaData->Get(vtkCompositeDataSet::NAME())
    : nullptr;
  return name ? name : "";
}

// Finds the leaves below `node`, in the order of the composite's iterator.
void FindLeaves(vtkDataObject* node, const std::string& name, const std::string& pattern,
  bool chosen, std::vector<Leaf>& leaves)
{
  chosen = chosen || avianlidar::globMatches(pattern, name);
  const auto visit = [&](
                       vtkDataObject* child, vtkInformation* metaData, const std::string& inherited)
  {
    const std::string own = NameOf(metaData);
    FindLeaves(child, own.empty() ? inherited : own, pattern, chosen, leaves);
  };
  if (auto* blocks = vtkMultiBlockDataSet::SafeDownCast(node))
  {
    for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i)
    {
      visit(blocks->GetBlock(i), blocks->HasMetaData(i) ? blocks->GetMetaData(i) : nullptr, "");
    }
  }
  else if (auto* sets = vtkPartitionedDataSetCollection::SafeDownCast(node))
  {
    for (unsigned int i = 0; i < sets->GetNumberOfPartitionedDataSets(); ++i)
    {
      visit(
        sets->GetPartitionedDataSet(i), sets->HasMetaData(i) ? sets->GetMetaData(i) : nullptr, "");
    }
  }
  else if (auto* parts = vtkPartitionedDataSet::SafeDownCast(node))
  {
    // Partitions are pieces of one data set. A partition without a name has the name of the set.
    for (unsigned int i = 0; i < parts->GetNumberOfPartitions(); ++i)
    {
      visit(parts->GetPartitionAsDataObject(i),
        parts->HasMetaData(i) ? parts->GetMetaData(i) : nullptr, name);
    }
  }
  else if (node)
  {
    leaves.push_back(Leaf{ node, name, chosen });
  }
}

std::vector<std::string> StringsOf(vtkFieldData* fields, const Arrays::Name& name)
{
  std::vector<std::string> strings;
  auto* array = Arrays::FindTexts(fields, name);
  for (vtkIdType i = 0; array && i < array->GetNumberOfValues(); ++i)
  {
    strings.push_back(array->GetValue(i));
  }
  return strings;
}

// Names of materials in `fields`, else in `whole`, else the standard names. `name` is added if the
// list does not contain it.
std::vector<std::string> MaterialNames(
  vtkFieldData* fields, vtkFieldData* whole, const std::string& name)
{
  std::vector<std::string> names = StringsOf(fields, Arrays::MaterialNames);
  if (names.empty())
  {
    names = StringsOf(whole, Arrays::MaterialNames);
  }
  if (names.empty())
  {
    for (int i = 0; i < Materials::NumberOfStandardMaterials; ++i)
    {
      names.emplace_back(Materials::NamedMaterials[i].name);
    }
  }
  if (std::find(names.begin(), names.end(), name) == names.end())
  {
    names.push_back(name);
  }
  return names;
}

void AssignMaterial(const Assignment& what, vtkFieldData* whole, vtkPolyData* output)
{
  vtkFieldData* fields = output->GetFieldData();
  const std::vector<std::string> names = MaterialNames(fields, whole, what.MaterialName);
  const auto index = std::find(names.begin(), names.end(), what.MaterialName) - names.begin();
  Arrays::SetFieldStrings(fields, Arrays::MaterialNames, names);
  output->GetCellData()->AddArray(
    Arrays::Constant(Arrays::MaterialId, output->GetNumberOfCells(), static_cast<int>(index)));
  Materials::AddCoefficients(output->GetCellData(), output->GetNumberOfCells(),
    [&](vtkIdType) -> const avianlidar::Material& { return *what.Coefficients; });
}

// Object id of the first cell, or -1.
int FirstObjectId(vtkPolyData* data)
{
  vtkDataArray* ids = data->GetCellData()->GetArray(Arrays::ObjectId.name);
  const double id = ids && ids->GetNumberOfTuples() > 0 ? ids->GetComponent(0, 0) : -1.0;
  return Arrays::IsInt(id) ? static_cast<int>(id) : -1;
}

// Sets the object of `output`, a shallow copy of the leaf with the given number.
void AssignObject(
  const Assignment& what, int number, const std::string& blockName, vtkPolyData* output)
{
  vtkFieldData* fields = output->GetFieldData();
  const bool oneObject = what.ObjectId >= 0 || !what.ObjectName.empty();
  if (oneObject || !output->GetCellData()->GetArray(Arrays::ObjectId.name))
  {
    const int known = what.ObjectId >= 0 ? what.ObjectId : FirstObjectId(output);
    output->GetCellData()->AddArray(
      Arrays::Constant(Arrays::ObjectId, output->GetNumberOfCells(), known >= 0 ? known : number));
  }
  const std::vector<std::string> classes = StringsOf(fields, Arrays::ObjectClasses);
  if (oneObject && classes.size() > 1)
  {
    const bool alike = std::count(classes.begin(), classes.end(), classes[0]) ==
      static_cast<std::ptrdiff_t>(classes.size());
    Arrays::SetFieldStrings(fields, Arrays::ObjectClasses, { alike ? classes[0] : "" });
  }
  if (!what.ObjectName.empty())
  {
    Arrays::SetFieldStrings(fields, Arrays::ObjectNames, { what.ObjectName });
  }
  else if (!blockName.empty() && StringsOf(fields, Arrays::ObjectNames).empty())
  {
    Arrays::SetFieldStrings(fields, Arrays::ObjectNames, { blockName });
  }
}

// Requires offsets of cells. Without offsets, VTK counts -1 cells.
void RequireCells(vtkPolyData* surface)
{
  for (vtkCellArray* cells :
    { surface->GetVerts(), surface->GetLines(), surface->GetPolys(), surface->GetStrips() })
  {
    vtkAvianLidarRequire(cells->GetNumberOfCells() < 0 ? vtkAvianLidarOffsetsError(cells) : "");
  }
}

// Changes the names in errors of the kernel, such as "kd + ks is 1.2", to Kd, Ks and Roughness.
std::string NameCoefficients(std::string problem)
{
  for (std::size_t i = 0; i < problem.size(); ++i)
  {
    if (i == 0 || (problem[i] == 'k' && problem[i - 1] == ' '))
    {
      problem[i] = static_cast<char>(std::toupper(problem[i]));
    }
  }
  return problem;
}

// Requires that names in the field data are texts.
void RequireNames(vtkDataObject* data)
{
  Arrays::RequireText(data->GetFieldData(), Arrays::MaterialNames);
  Arrays::RequireText(data->GetFieldData(), Arrays::ObjectNames);
}

// Requires that all chosen leaves are valid vtkPolyData.
void RequireLeaves(const std::vector<Leaf>& leaves)
{
  for (std::size_t i = 0; i < leaves.size(); ++i)
  {
    if (!leaves[i].Chosen)
    {
      continue;
    }
    const std::string block =
      "Input port 0, block " + std::to_string(i) + " '" + leaves[i].Name + "'";
    auto* surface = vtkPolyData::SafeDownCast(leaves[i].Data);
    vtkAvianLidarRequire(surface ? ""
                                 : block + " is a " + leaves[i].Data->GetClassName() +
          ", expected vtkPolyData (use Extract Surface first)");
    vtkAvianLidarWithin(block + ": ",
      [surface]()
      {
        RequireCells(surface);
        RequireNames(surface);
      });
  }
}

void AssignToTree(const Assignment& what, const std::vector<Leaf>& leaves, vtkDataObjectTree* input,
  vtkDataObjectTree* output)
{
  output->ShallowCopy(input);
  vtkFieldData* fields = output->GetFieldData();
  auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(input->NewIterator());
  int number = 0;
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal();
       iterator->GoToNextItem(), ++number)
  {
    if (leaves[number].Chosen)
    {
      vtkNew<vtkPolyData> leaf;
      leaf->ShallowCopy(leaves[number].Data);
      if (what.Coefficients)
      {
        AssignMaterial(what, fields, leaf);
      }
      AssignObject(what, number, leaves[number].Name, leaf);
      output->SetDataSet(iterator, leaf);
    }
  }
  if (what.Coefficients)
  {
    Arrays::SetFieldStrings(
      fields, Arrays::MaterialNames, MaterialNames(fields, nullptr, what.MaterialName));
  }
}
}

vtkStandardNewMacro(vtkAvianLidarMaterial);

//------------------------------------------------------------------------------
const char* vtkAvianLidarMaterial::GetMaterialName(int material)
{
  const Materials::NamedMaterial* named = Named(material);
  return named ? named->name : nullptr;
}

//------------------------------------------------------------------------------
const char* vtkAvianLidarMaterial::GetMaterialSource(int material)
{
  const Materials::NamedMaterial* named = Named(material);
  return named ? named->source : nullptr;
}

//------------------------------------------------------------------------------
const char* vtkAvianLidarMaterial::GetCoefficientName(int coefficient)
{
  constexpr int count = std::size(avianlidar::MaterialCoefficients);
  return coefficient >= 0 && coefficient < count
    ? avianlidar::MaterialCoefficients[coefficient].name
    : nullptr;
}

//------------------------------------------------------------------------------
double vtkAvianLidarMaterial::GetMaterialCoefficient(int material, int coefficient)
{
  const Materials::NamedMaterial* named = Named(material);
  return named && GetCoefficientName(coefficient)
    ? named->material.*avianlidar::MaterialCoefficients[coefficient].member
    : std::numeric_limits<double>::quiet_NaN();
}

//------------------------------------------------------------------------------
bool vtkAvianLidarMaterial::GetMaterialColor(int material, double color[3])
{
  const Materials::NamedMaterial* named = Named(material);
  if (named)
  {
    std::copy_n(named->colour, 3, color);
  }
  return named != nullptr;
}

//------------------------------------------------------------------------------
int vtkAvianLidarMaterial::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  // A composite is one input, because the pattern needs the names of the blocks.
  info->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarMaterial::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
      vtkDataObject* output = vtkDataObject::GetData(outputVector);
      const Materials::NamedMaterial* named = Named(this->Material);
      if (!named && this->Material != MATERIAL_CUSTOM && this->Material != MATERIAL_UNCHANGED)
      {
        vtkAvianLidarRequire(avianlidar::valueError(
          "Material", this->Material, "0 (Wall) to 8 (Plumage), or -1 (unchanged)"));
      }
      vtkAvianLidarRequire(avianlidar::rangeError(
        "ObjectId", this->ObjectId, -1, VTK_INT_MAX, "at least 0, or -1 (automatic)"));
      Assignment what;
      what.ObjectId = this->ObjectId;
      what.ObjectName = this->NameOfObject;
      if (named)
      {
        what.MaterialName = named->name;
        what.Coefficients = named->material;
      }
      else if (this->Material == MATERIAL_CUSTOM)
      {
        what.MaterialName = "Custom";
        what.Coefficients = { this->Kd, this->Ks, this->Kp, this->Roughness };
      }
      if (what.Coefficients)
      {
        vtkAvianLidarRequire(
          NameCoefficients(avianlidar::checkMaterial(*what.Coefficients)), "Material: ");
      }
      vtkAvianLidarWithin("Input port 0, ", [input]() { RequireNames(input); });
      if (auto* surface = vtkPolyData::SafeDownCast(output))
      {
        vtkAvianLidarWithin(
          "Input port 0, ", [input]() { RequireCells(vtkPolyData::SafeDownCast(input)); });
        surface->ShallowCopy(input);
        if (what.Coefficients)
        {
          AssignMaterial(what, nullptr, surface);
        }
        AssignObject(what, 0, "", surface);
        return;
      }
      std::vector<Leaf> leaves;
      const std::string pattern = this->BlockNamePattern.empty() ? "*" : this->BlockNamePattern;
      FindLeaves(input, "", pattern, false, leaves);
      RequireLeaves(leaves);
      const auto chosen = [](const Leaf& leaf) { return leaf.Chosen; };
      if (!leaves.empty() && std::none_of(leaves.begin(), leaves.end(), chosen))
      {
        vtkWarningMacro("BlockNamePattern '" << vtkAvianLidarText(pattern)
                                             << "' fits no block: no material was set.");
      }
      AssignToTree(what, leaves, vtkDataObjectTree::SafeDownCast(input),
        vtkDataObjectTree::SafeDownCast(output));
    });
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarMaterial, ErrorsAsData, Material, Kd, Ks, Kp, Roughness,
  ObjectId, NameOfObject, BlockNamePattern);
