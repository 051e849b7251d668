// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceLeaf.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace
{
bool OnlyTriangles(vtkPolyData* poly)
{
  return poly->GetNumberOfStrips() == 0 && poly->GetNumberOfVerts() == 0 &&
    poly->GetNumberOfLines() == 0 &&
    (poly->GetPolys()->IsHomogeneous() == 3 || poly->GetNumberOfPolys() == 0);
}

/// Ids must be whole numbers that fit an int.
std::string CheckIds(vtkDataArray* ids)
{
  if (!ids || vtkIntArray::SafeDownCast(ids))
  {
    return {};
  }
  const vtkAvianLidarColumn column(ids);
  const vtkIdType count = ids->GetNumberOfTuples();
  for (vtkIdType i = 0; i < count; ++i)
  {
    const double id = column[i];
    if (!(id >= std::numeric_limits<int>::min() && id <= std::numeric_limits<int>::max()))
    {
      return std::string("cell ") + std::to_string(i) + ": cell array '" + ids->GetName() +
        "' is not a whole number of 32 bits";
    }
  }
  return {};
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
std::string vtkAvianLidarSurfaceLeaf::Complaint(const std::string& what) const
{
  return "surfaces" + (this->name.empty() ? "" : ", block '" + this->name + "'") + ": " + what;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarSurfaceLeaf::AdviceOnPoints() const
{
  constexpr double farForSinglePrecision = 32768.0; // m
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
  std::ostringstream text;
  text.precision(3);
  text << this->Complaint("points in single precision lie up to ") << farthest
       << " m from the origin, where neighbours are " << std::ldexp(1.0, std::ilogb(farthest) - 23)
       << " m apart. Give points in double precision, or coordinates near the lidar.";
  return text.str();
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarSurfaceLeaf::Check() const
{
  for (vtkCellArray* cells : { this->data->GetPolys(), this->data->GetStrips() })
  {
    const std::string wrong = vtkAvianLidarCellsComplaint(cells, this->data->GetNumberOfPoints());
    if (!wrong.empty())
    {
      return wrong;
    }
  }
  const vtkAvianLidarSurfaceArrays a(this->data);
  const int present = (a.kd != nullptr) + (a.ks != nullptr) + (a.kp != nullptr);
  if (present != 0 && present != 3)
  {
    return "of the cell arrays kd, ks, kp only some are there, expected all three or none";
  }
  vtkDataArray* ghosts = a.ghosts;
  for (vtkDataArray* array : { a.object, a.material, a.kd, a.ks, a.kp, ghosts })
  {
    const std::string wrong =
      vtkAvianLidarArrays::CheckShape(array, "cell array", 1, this->data->GetNumberOfCells());
    if (!wrong.empty())
    {
      return wrong;
    }
  }
  const std::string wrong = CheckIds(a.object);
  return wrong.empty() ? CheckIds(a.material) : wrong;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarSurfaceLeaf::Triangulated() const
{
  if (OnlyTriangles(this->data))
  {
    return this->data;
  }
  vtkNew<vtkTriangleFilter> filter;
  filter->PassVertsOff();
  filter->PassLinesOff();
  filter->SetInputData(this->data);
  filter->Update();
  return filter->GetOutput();
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaceArrays::vtkAvianLidarSurfaceArrays(vtkPolyData* poly)
{
  vtkCellData* cells = poly->GetCellData();
  this->object = cells->GetArray(vtkAvianLidarArrays::ObjectId.name);
  this->material = cells->GetArray(vtkAvianLidarArrays::MaterialId.name);
  this->kd = cells->GetArray(vtkAvianLidarArrays::Kd.name);
  this->ks = cells->GetArray(vtkAvianLidarArrays::Ks.name);
  this->kp = cells->GetArray(vtkAvianLidarArrays::Kp.name);
  this->ghosts =
    vtkUnsignedCharArray::SafeDownCast(cells->GetArray(vtkDataSetAttributes::GhostArrayName()));
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
