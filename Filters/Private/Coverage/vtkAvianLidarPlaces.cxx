// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarPlaces.h"

#include "Hash.h"
#include "ScanBeams.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRequire.h"

#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkExtentTranslator.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Vec3;

/// Number of points between two bounds, m. The first point lies on the lower bound.
double CountAlong(const double bounds[2], double spacing)
{
  return std::floor((bounds[1] - bounds[0]) / spacing * (1.0 + 1e-12)) + 1.0;
}

/// Throws if the extent of structured points is bad. VTK accepts any extent, and some extents have
/// a negative number of points.
void CheckExtent(vtkDataSet* points)
{
  vtkInformation* info = points->GetInformation();
  if (!info->Has(vtkDataObject::DATA_EXTENT()))
  {
    return;
  }
  const int* extent = info->Get(vtkDataObject::DATA_EXTENT());
  for (int axis = 0; axis < 3; ++axis)
  {
    const int first = extent[2 * axis];
    const int last = extent[2 * axis + 1];
    if (static_cast<long long>(last) - first < -1)
    {
      vtkAvianLidarRequire("extent from " + std::to_string(first) + " to " + std::to_string(last) +
        " on axis " + std::to_string(axis) +
        ", expected a last point that is not before the first");
    }
  }
}
}

//------------------------------------------------------------------------------
double vtkAvianLidarPlaces::CountOf(vtkDataSet* points)
{
  vtkInformation* info = points->GetInformation();
  if (!info->Has(vtkDataObject::DATA_EXTENT()))
  {
    return static_cast<double>(points->GetNumberOfPoints());
  }
  const int* extent = info->Get(vtkDataObject::DATA_EXTENT());
  double count = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    count *= static_cast<double>(extent[2 * axis + 1]) - extent[2 * axis] + 1.0;
  }
  return count;
}

//------------------------------------------------------------------------------
vtkAvianLidarPlaces::vtkAvianLidarPlaces(vtkDataSet* points)
  : Points(points)
{
  CheckExtent(points);
  for (std::size_t k = 0; k < this->Size(); ++k)
  {
    const std::string wrong = avianlidar::checkPosition(this->At(k));
    vtkAvianLidarRequire(wrong.empty() ? wrong : "point " + std::to_string(k) + ": " + wrong);
  }
  this->ReadRegions();
  this->Ghosts = points->GetPointGhostArray();
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarPlaces::CheckRegion(const double bounds[6], const double spacing[3])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const double least = bounds[2 * axis];
    const double most = bounds[2 * axis + 1];
    if (!avianlidar::checkPosition(Vec3(least, most, 0.0)).empty() || !(least <= most))
    {
      return avianlidar::valueError("Bounds", least <= most ? most : least,
        "finite, up to 1e30 m, and the lower bound no more than the upper");
    }
    if (!(spacing[axis] > 0.0) || !std::isfinite(spacing[axis]))
    {
      return avianlidar::valueError("Spacing", spacing[axis], "above 0 m");
    }
    const double along = CountAlong(bounds + 2 * axis, spacing[axis]);
    if (!(along < std::numeric_limits<int>::max()))
    {
      return avianlidar::valueError(
        "Spacing", spacing[axis], "such that fewer than 2147483647 points lie along an axis");
    }
  }
  return {};
}

//------------------------------------------------------------------------------
void vtkAvianLidarPlaces::ExtentOf(const double bounds[6], const double spacing[3], int extent[6])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    extent[2 * axis] = 0;
    extent[2 * axis + 1] = static_cast<int>(CountAlong(bounds + 2 * axis, spacing[axis])) - 1;
  }
}

//------------------------------------------------------------------------------
vtkAvianLidarPlaces::vtkAvianLidarPlaces(
  const int extent[6], const double origin[3], const double spacing[3])
{
  const bool isEmpty = extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5];
  if (!isEmpty)
  {
    std::copy(extent, extent + 6, this->Extent);
  }
  std::copy(origin, origin + 3, this->Origin);
  std::copy(spacing, spacing + 3, this->Spacing);
}

//------------------------------------------------------------------------------
void vtkAvianLidarPlaces::SetMine(vtkInformation* info)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  if (!info->Has(Pipeline::WHOLE_EXTENT()))
  {
    return;
  }
  int whole[6];
  info->Get(Pipeline::WHOLE_EXTENT(), whole);
  int mine[6];
  std::copy(whole, whole + 6, mine);
  const int pieces = info->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
  if (pieces > 1)
  {
    vtkNew<vtkExtentTranslator> translator;
    translator->PieceToExtentThreadSafe(info->Get(Pipeline::UPDATE_PIECE_NUMBER()), pieces, 0,
      whole, mine, vtkExtentTranslator::BLOCK_MODE, 0);
  }
  if (this->Points)
  {
    vtkInformation* points = this->Points->GetInformation();
    if (!points->Has(vtkDataObject::DATA_EXTENT()))
    {
      return;
    }
    points->Get(vtkDataObject::DATA_EXTENT(), this->Extent);
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const int last = mine[2 * axis + 1];
    this->Mine[2 * axis] = mine[2 * axis];
    this->Mine[2 * axis + 1] = last < whole[2 * axis + 1] ? last - 1 : last;
  }
  this->HasMine = true;
}

//------------------------------------------------------------------------------
std::size_t vtkAvianLidarPlaces::Size() const
{
  return this->Points
    ? static_cast<std::size_t>(this->Points->GetNumberOfPoints())
    : static_cast<std::size_t>(this->Dimension(0)) * this->Dimension(1) * this->Dimension(2);
}

//------------------------------------------------------------------------------
std::array<int, 3> vtkAvianLidarPlaces::IndexOf(std::size_t k) const
{
  const auto nx = static_cast<std::size_t>(this->Dimension(0));
  const auto ny = static_cast<std::size_t>(this->Dimension(1));
  return { this->Extent[0] + static_cast<int>(k % nx),
    this->Extent[2] + static_cast<int>(k / nx % ny),
    this->Extent[4] + static_cast<int>(k / nx / ny) };
}

//------------------------------------------------------------------------------
Vec3 vtkAvianLidarPlaces::At(std::size_t k) const
{
  if (this->Points)
  {
    double p[3];
    this->Points->GetPoint(static_cast<vtkIdType>(k), p);
    return { p[0], p[1], p[2] };
  }
  const std::array<int, 3> index = this->IndexOf(k);
  Vec3 place;
  for (int axis = 0; axis < 3; ++axis)
  {
    place[axis] = this->Origin[axis] + index[axis] * this->Spacing[axis];
  }
  return place;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarPlaces::IsMine(std::size_t k) const
{
  if (this->Ghosts)
  {
    constexpr int others = vtkDataSetAttributes::DUPLICATEPOINT | vtkDataSetAttributes::HIDDENPOINT;
    if ((this->Ghosts->GetValue(static_cast<vtkIdType>(k)) & others) != 0)
    {
      return false;
    }
  }
  if (!this->HasMine)
  {
    return true;
  }
  const std::array<int, 3> index = this->IndexOf(k);
  for (int axis = 0; axis < 3; ++axis)
  {
    if (index[axis] < this->Mine[2 * axis] || index[axis] > this->Mine[2 * axis + 1])
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
std::uint64_t vtkAvianLidarPlaces::Hash() const
{
  using avianlidar::hashOf;
  std::uint64_t hash = hashOf(this->Extent, sizeof(this->Extent), this->Size());
  hash = hashOf(this->Origin, sizeof(this->Origin), hash);
  hash = hashOf(this->Spacing, sizeof(this->Spacing), hash);
  for (std::size_t k = 0; this->Points && k < this->Size(); ++k)
  {
    const Vec3 place = this->At(k);
    hash = hashOf(&place, sizeof(place), hash);
  }
  return hash;
}

//------------------------------------------------------------------------------
void vtkAvianLidarPlaces::ReadRegions()
{
  vtkPointData* arrays = this->Points->GetPointData();
  Arrays::RequireNumeric(arrays, Arrays::RegionId, "point array");
  vtkDataArray* ids = arrays->GetArray(Arrays::RegionId.name);
  Arrays::RequireShape(ids, "point array", 1, this->Points->GetNumberOfPoints());
  Arrays::RequireText(this->Points->GetFieldData(), Arrays::RegionNames);
  if (!ids)
  {
    return;
  }
  auto* texts = Arrays::FindTexts(this->Points->GetFieldData(), Arrays::RegionNames);
  std::map<int, std::size_t> numbers;
  for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i)
  {
    const double id = ids->GetComponent(i, 0);
    vtkAvianLidarRequire(Arrays::IsInt(id)
        ? ""
        : "point array 'region_id' is not a whole number of 32 bits at point " + std::to_string(i));
    numbers[static_cast<int>(id)] = 0;
  }
  this->Names.clear();
  for (auto& [id, number] : numbers)
  {
    number = this->Names.size();
    const bool isNamed = texts && id >= 0 && id < texts->GetNumberOfValues();
    this->Names.push_back(
      isNamed ? static_cast<std::string>(texts->GetValue(id)) : "region " + std::to_string(id));
  }
  for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i)
  {
    this->Regions.push_back(numbers[static_cast<int>(ids->GetComponent(i, 0))]);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarPlaces::ShareRegions(const vtkAvianLidarRanks& ranks)
{
  vtkMultiProcessStream mine;
  mine << static_cast<int>(this->Names.size());
  for (const std::string& name : this->Names)
  {
    mine << name;
  }
  std::vector<std::string> all;
  for (vtkMultiProcessStream& stream : ranks.Gather(mine))
  {
    int count = 0;
    stream >> count;
    for (int i = 0; i < count; ++i)
    {
      std::string name;
      stream >> name;
      if (std::find(all.begin(), all.end(), name) == all.end())
      {
        all.push_back(name);
      }
    }
  }
  std::vector<std::size_t> shared; // shared number of a region, by this rank's number
  for (const std::string& name : this->Names)
  {
    shared.push_back(
      static_cast<std::size_t>(std::find(all.begin(), all.end(), name) - all.begin()));
  }
  this->Regions.resize(this->Size(), 0);
  for (std::size_t& region : this->Regions)
  {
    region = shared[region];
  }
  this->Names = all;
}
