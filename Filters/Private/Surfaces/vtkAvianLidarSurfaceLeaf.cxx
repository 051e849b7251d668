// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceLeaf.h"

#include "Figures.h"
#include "Hash.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarTriangles.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace
{
/// Throws unless the coefficients of polygons and strips are valid. Ghosts and cells without
/// triangles are not checked.
void RequireMaterials(vtkPolyData* poly, const vtkAvianLidarSurfaceArrays& arrays)
{
  if (!arrays.HasMaterials())
  {
    return;
  }
  const vtkAvianLidarMaterialColumns materials(arrays);
  avianlidar::Material good; // last good material, as neighbouring cells often have the same
  vtkIdType cell = poly->GetNumberOfVerts() + poly->GetNumberOfLines();
  for (vtkCellArray* cells : { poly->GetPolys(), poly->GetStrips() })
  {
    for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i, ++cell)
    {
      avianlidar::Material material;
      materials.Read(cell, material);
      if (material == good)
      {
        continue;
      }
      const std::string wrong = avianlidar::checkMaterial(material);
      if (wrong.empty())
      {
        good = material;
      }
      else if (cells->GetCellSize(i) >= 3 && !arrays.IsGhost(cell))
      {
        vtkAvianLidarRequire(wrong, "cell " + std::to_string(cell) + ": ");
      }
    }
  }
}

/// True for data without polygons and strips, but with the point arrays of a beam source.
bool AreBeams(vtkPolyData* poly)
{
  vtkPointData* arrays = poly->GetPointData();
  return poly->GetNumberOfPolys() == 0 && poly->GetNumberOfStrips() == 0 &&
    arrays->HasArray(vtkAvianLidarArrays::Direction.name) &&
    arrays->HasArray(vtkAvianLidarArrays::BeamId.name);
}

/// Throws unless all ids are whole numbers that an int holds.
void RequireIds(vtkDataArray* ids)
{
  if (!ids || vtkIntArray::SafeDownCast(ids))
  {
    return;
  }
  const vtkAvianLidarColumn column(ids);
  const vtkIdType count = ids->GetNumberOfTuples();
  for (vtkIdType i = 0; i < count; ++i)
  {
    if (!vtkAvianLidarArrays::IsInt(column[i]))
    {
      vtkAvianLidarRequire(std::string("cell ") + std::to_string(i) + ": cell array '" +
        ids->GetName() + "' is not a whole number of 32 bits");
    }
  }
}
}

//------------------------------------------------------------------------------
std::vector<vtkAvianLidarSurfaceLeaf> vtkAvianLidarSurfaceLeaf::Collect(
  vtkDataObject* input, std::string& problem)
{
  std::vector<vtkAvianLidarSurfaceLeaf> leaves;
  if (auto* poly = vtkPolyData::SafeDownCast(input))
  {
    leaves.push_back({ poly, "" });
    return leaves;
  }
  auto* composite = vtkCompositeDataSet::SafeDownCast(input);
  if (!composite)
  {
    problem = "the surfaces are neither vtkPolyData nor a composite of it";
    return leaves;
  }
  auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
  std::size_t number = 0;
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    std::string name = NameOfBlock(number++);
    bool named = false;
    if (iterator->HasCurrentMetaData() &&
      iterator->GetCurrentMetaData()->Has(vtkCompositeDataSet::NAME()))
    {
      name = iterator->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME());
      named = true;
    }
    auto* poly = vtkPolyData::SafeDownCast(iterator->GetCurrentDataObject());
    if (!poly)
    {
      problem = "surfaces: block '" + name + "' is not vtkPolyData (use Extract Surface first)";
      return leaves;
    }
    leaves.push_back({ poly, name, iterator->GetCurrentFlatIndex(), named });
  }
  return leaves;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarSurfaceLeaf::Message(const std::string& what) const
{
  return "surfaces" + (this->name.empty() ? "" : ", block '" + this->name + "'") + ": " + what;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarSurfaceLeaf::WarningOnPoints() const
{
  constexpr double farForSinglePrecision = 32768.0; // largest coordinate without a warning, m
  vtkPoints* points = this->data->GetPoints();
  if (!points || points->GetDataType() != VTK_FLOAT || points->GetNumberOfPoints() == 0)
  {
    return {};
  }
  double bounds[6];
  points->GetBounds(bounds);
  double farthest = 0.0;
  for (const double bound : bounds)
  {
    farthest = std::max(farthest, std::abs(bound));
  }
  if (farthest < farForSinglePrecision)
  {
    return {};
  }
  using avianlidar::figures;
  return this->Message("points in single precision lie up to ") + figures(farthest, 3) +
    " m from the origin, where neighbours are " +
    figures(std::ldexp(1.0, std::ilogb(farthest) - 23), 3) +
    " m apart. Give points in double precision, or coordinates near the lidar.";
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarSurfaceLeaf::Check(const vtkAvianLidarSurfaceArrays& a) const
try
{
  namespace names = vtkAvianLidarArrays;
  vtkAvianLidarRequire(this->name.empty() && AreBeams(this->data)
      ? "these are beams, expected polygons in metres, as of a scene reader or a collision tree "
        "(in ParaView: Edit > Change Input)"
      : "");
  for (vtkCellArray* cells : { this->data->GetVerts(), this->data->GetLines() })
  {
    // Vertices and lines are dropped, but cell arrays begin with the values of vertices and lines.
    vtkAvianLidarRequire(vtkAvianLidarOffsetsError(cells));
  }
  for (vtkCellArray* cells : { this->data->GetPolys(), this->data->GetStrips() })
  {
    vtkAvianLidarRequire(vtkAvianLidarCellsError(cells, this->data->GetNumberOfPoints()));
  }
  if (a.notNumeric)
  {
    names::RequireNumeric(this->data->GetCellData(), { a.notNumeric, "" }, "cell array");
  }
  for (const names::Name& text : names::SurfaceTexts)
  {
    names::RequireText(this->data->GetFieldData(), text);
  }
  bool somePresent = false;
  bool someAbsent = false;
  for (std::size_t k = 0; k < std::size(a.coefficients); ++k)
  {
    somePresent = somePresent || a.coefficients[k];
    someAbsent =
      someAbsent || !(a.coefficients[k] || avianlidar::MaterialCoefficients[k].isOptional);
  }
  vtkAvianLidarRequire(somePresent && someAbsent
      ? "of a material's cell arrays only some are there, expected all of " +
        avianlidar::namesOfCoefficients() + " or none of a material"
      : "");
  std::vector<vtkDataArray*> arrays = a.Numbers();
  arrays.push_back(a.ghosts);
  for (vtkDataArray* array : arrays)
  {
    names::RequireShape(array, "cell array", 1, this->data->GetNumberOfCells());
  }
  RequireIds(a.object);
  RequireIds(a.material);
  RequireMaterials(this->data, a);
  return {};
}
catch (const std::runtime_error& error)
{
  return error.what();
}

//------------------------------------------------------------------------------
bool vtkAvianLidarSurfaceLeaf::IsTriangulated() const
{
  vtkPolyData* poly = this->data;
  return poly->GetNumberOfStrips() == 0 && poly->GetNumberOfVerts() == 0 &&
    poly->GetNumberOfLines() == 0 &&
    (poly->GetPolys()->IsHomogeneous() == 3 || poly->GetNumberOfPolys() == 0);
}

//------------------------------------------------------------------------------
std::size_t vtkAvianLidarSurfaceLeaf::NumberOfTriangles() const
{
  vtkIdType triangles = 0;
  for (vtkCellArray* cells : { this->data->GetPolys(), this->data->GetStrips() })
  {
    // A polygon or a strip of n points has n - 2 triangles.
    triangles +=
      std::max<vtkIdType>(0, cells->GetNumberOfConnectivityIds() - 2 * cells->GetNumberOfCells());
  }
  return static_cast<std::size_t>(triangles);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarSurfaceLeaf::Triangulated(std::string& warning) const
{
  warning.clear();
  if (this->IsTriangulated())
  {
    return this->data;
  }
  vtkSmartPointer<vtkPolyData> triangles = vtkAvianLidarTriangles(this->data, &warning);
  warning = warning.empty() ? warning : this->Message(warning);
  return triangles;
}

//------------------------------------------------------------------------------
std::uint64_t vtkAvianLidarSurfaceLeaf::HashOfNames(vtkFieldData* fields, std::uint64_t seed)
{
  for (const auto& name : vtkAvianLidarArrays::SurfaceTexts)
  {
    vtkAbstractArray* array = fields ? fields->GetAbstractArray(name.name) : nullptr;
    auto* names = vtkStringArray::SafeDownCast(array);
    constexpr vtkIdType none = -1;
    constexpr vtkIdType noText = -2; // an error, which changes the hash
    const vtkIdType count = names ? names->GetNumberOfValues() : array ? noText : none;
    seed = avianlidar::hashOf(&count, sizeof(count), seed);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const std::string& text = names->GetValue(i);
      seed = avianlidar::hashOf(text.data(), text.size(), seed);
    }
  }
  return seed;
}

//------------------------------------------------------------------------------
std::uint64_t vtkAvianLidarSurfaceLeaf::HashOf(vtkPolyData* poly)
{
  namespace Content = vtkAvianLidarContent;
  const vtkAvianLidarSurfaceArrays arrays(poly);
  std::uint64_t hash = HashOfNames(poly->GetFieldData(), 0);
  hash = Content::HashOf(arrays.ghosts, Content::HashOfGeometry(poly, hash));
  // An array without numbers is an error, which changes the hash.
  const std::string_view odd = arrays.notNumeric ? arrays.notNumeric : "";
  hash = avianlidar::hashOf(odd.data(), odd.size(), hash);
  for (vtkDataArray* array : arrays.Numbers())
  {
    hash = Content::HashOf(array, hash);
  }
  return hash;
}
//------------------------------------------------------------------------------
vtkAvianLidarSurfaceArrays::vtkAvianLidarSurfaceArrays(vtkPolyData* poly)
{
  namespace names = vtkAvianLidarArrays;
  const auto find = [&](const char* name)
  {
    vtkAbstractArray* any = poly->GetCellData()->GetAbstractArray(name);
    auto* array = vtkDataArray::SafeDownCast(any);
    this->notNumeric = any && !array && !this->notNumeric ? name : this->notNumeric;
    return array;
  };
  this->object = find(names::ObjectId.name);
  this->material = find(names::MaterialId.name);
  for (std::size_t k = 0; k < std::size(this->coefficients); ++k)
  {
    this->coefficients[k] = find(avianlidar::MaterialCoefficients[k].name);
  }
  this->ghosts = vtkUnsignedCharArray::SafeDownCast(
    poly->GetCellData()->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()));
}

//------------------------------------------------------------------------------
std::vector<vtkDataArray*> vtkAvianLidarSurfaceArrays::Numbers() const
{
  std::vector<vtkDataArray*> numbers{ this->object, this->material };
  numbers.insert(numbers.end(), std::begin(this->coefficients), std::end(this->coefficients));
  return numbers;
}

//------------------------------------------------------------------------------
vtkAvianLidarColumn::vtkAvianLidarColumn(vtkDataArray* array)
  : Any(array)
{
  auto* doubles = vtkDoubleArray::SafeDownCast(array);
  auto* ints = vtkIntArray::SafeDownCast(array);
  this->Doubles = doubles ? doubles->GetPointer(0) : nullptr;
  this->Ints = ints ? ints->GetPointer(0) : nullptr;
}

//------------------------------------------------------------------------------
vtkAvianLidarMaterialColumns::vtkAvianLidarMaterialColumns(const vtkAvianLidarSurfaceArrays& arrays)
{
  for (std::size_t k = 0; k < std::size(this->Columns); ++k)
  {
    this->Columns[k] = vtkAvianLidarColumn(arrays.coefficients[k]);
  }
}
