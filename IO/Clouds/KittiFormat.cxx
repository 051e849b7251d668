// SPDX-License-Identifier: BSD-3-Clause
#include "KittiFormat.h"

#include "FieldTable.h"
#include "vtkAvianLidarNames.h"

#include <algorithm>
#include <cmath>

namespace avianlidar::formats
{
namespace
{
constexpr std::uint64_t PointSize = 16;     // of KITTI, bytes
constexpr std::uint64_t LongPointSize = 20; // of nuScenes, bytes
constexpr std::uint64_t LabelSize = 4;
constexpr float GreatestRing = 4096.0f;

/// Returns whether the bytes may be points of nuScenes: intensity and ring behind the coordinates.
bool isNuScenes(ByteSource& points)
{
  bool is = points.size() > 0 && points.size() % LongPointSize == 0;
  const auto isWhole = [](float value)
  { return value >= 0 && value < GreatestRing && value == std::floor(value); };
  for (std::uint64_t i = 0; is && i < points.size() / LongPointSize; ++i)
  {
    const unsigned char* const bytes = points.at(i * LongPointSize, LongPointSize);
    const float intensity = load<float>(bytes + 12);
    is = intensity >= 0 && intensity <= KittiGreatestIntensity && isWhole(load<float>(bytes + 16));
  }
  return is;
}

/// Throws FormatError if another size of a point than four numbers gives smaller steps from point
/// to point. Neighbouring points of a scan are near each other.
void checkStride(ByteSource& points)
{
  constexpr std::uint64_t most = 1 << 14; // greatest number of numbers that are compared
  const std::uint64_t count = std::min<std::uint64_t>(points.size() / sizeof(float), most);
  constexpr std::uint64_t least = 200;
  if (count < least)
  {
    return;
  }
  const std::vector<unsigned char> bytes = points.bytes(0, count * sizeof(float));
  const auto medianChange = [&](std::uint64_t stride)
  {
    std::vector<float> changes;
    for (std::uint64_t i = 0; i + stride < count; ++i)
    {
      const float change = load<float>(bytes.data() + sizeof(float) * (i + stride)) -
        load<float>(bytes.data() + sizeof(float) * i);
      changes.push_back(std::isfinite(change) ? std::abs(change) : 0.0f);
    }
    const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
    std::nth_element(changes.begin(), middle, changes.end());
    return *middle;
  };
  const float ofFour = medianChange(4);
  for (const std::uint64_t stride : { 3, 5, 6, 7 })
  {
    failIf(4.0f * medianChange(stride) < ofFour, "it seems to have ", stride,
      " float32 a point: this is not a scan of KITTI, which has x, y, z and reflectance");
  }
}

/// Throws FormatError unless the fourth numbers of all points may be reflectances (0 to 1) or
/// intensities (0 to 255). In files of other layouts, coordinates are among these numbers.
void checkReflectance(double least, double greatest)
{
  failIf(!(least >= 0.0 && greatest <= KittiGreatestIntensity),
    "the fourth numbers of its points go from ", least, " to ", greatest,
    ", expected reflectances (0 to 1) or intensities (0 to 255): this is not a scan of KITTI, "
    "which has x, y, z and reflectance as float32");
}

/// Reads points of nuScenes, whose axes are those of this project's clouds.
Cloud readNuScenes(ByteSource& points, const KeepGoing& keepGoing)
{
  const std::uint64_t n = points.size() / LongPointSize;
  requireMemoryFor(n, LongPointSize);
  Cloud cloud;
  cloud.points.resize(3 * n);
  std::vector<double> intensity(n);
  std::vector<std::uint16_t> ring(n);
  forEachRecord(points, 0, LongPointSize, n,
    [&](std::uint64_t i, const unsigned char* bytes)
    {
      for (std::uint64_t axis = 0; axis < 3; ++axis)
      {
        cloud.points[3 * i + axis] = load<float>(bytes + 4 * axis);
      }
      intensity[i] = load<float>(bytes + 12);
      ring[i] = static_cast<std::uint16_t>(load<float>(bytes + 16));
      goOn(keepGoing, i, n);
    });
  cloud.columns.push_back({ "intensity", "1", 1, std::move(intensity) });
  cloud.columns.push_back({ "laser_id", "", 1, std::move(ring) });
  cloud.sensor = Point{ 0.0, 0.0, 0.0 };
  dropEmptyCells(cloud);
  return cloud;
}
}

bool mayBeKitti(ByteSource& points)
{
  return points.size() % PointSize == 0 || points.size() % LongPointSize == 0;
}

Cloud readKitti(ByteSource& points, ByteSource* labels, const KeepGoing& keepGoing)
{
  const bool mayBeFour = points.size() % PointSize == 0;
  if (!mayBeFour && !labels && isNuScenes(points))
  {
    return readNuScenes(points, keepGoing);
  }
  failIf(!mayBeFour, "its length is ", points.size(),
    " bytes, expected a multiple of 16, four float32 a point, or points of nuScenes, whose five "
    "float32 end with an intensity (0 to 255) and a ring");
  const std::uint64_t n = points.size() / PointSize;
  const std::uint64_t labelBytes = labels ? labels->size() : n * LabelSize;
  failIf(labelBytes != n * LabelSize, "the labels beside it have ", labelBytes,
    " bytes, expected four for each of its ", n, " points");
  requireMemoryFor(n, PointSize);
  Cloud cloud;
  cloud.points.resize(3 * n);
  std::vector<double> intensity(n);
  double least = 0.0, greatest = 0.0;
  forEachRecord(points, 0, PointSize, n,
    [&](std::uint64_t i, const unsigned char* bytes)
    {
      double* p = cloud.points.data() + 3 * i;
      p[0] = -static_cast<double>(load<float>(bytes + 4));
      p[1] = load<float>(bytes);
      p[2] = load<float>(bytes + 8);
      intensity[i] = load<float>(bytes + 12);
      if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
      {
        least = std::min(least, intensity[i]);
        if (!std::isnan(greatest) && !(intensity[i] <= greatest))
        {
          greatest = intensity[i];
        }
      }
      goOn(keepGoing, i, n);
    });
  const bool isReflectance = least >= 0.0 && greatest <= 1.0;
  if (!isReflectance && !labels && isNuScenes(points))
  {
    return readNuScenes(points, keepGoing);
  }
  checkReflectance(least, greatest);
  checkStride(points);
  if (greatest > 1.0)
  {
    cloud.warnings.push_back(joined("the fourth numbers of its points reach ", greatest,
      ": they are taken for intensities of 0 to 255, not for reflectances of 0 to 1"));
  }
  else
  {
    std::for_each(
      intensity.begin(), intensity.end(), [](double& value) { value *= KittiGreatestIntensity; });
  }
  cloud.columns.push_back({ "intensity", "1", 1, std::move(intensity) });
  cloud.sensor = Point{ 0.0, 0.0, 0.0 };
  if (labels)
  {
    std::vector<std::uint16_t> label(n), instance(n);
    forEachRecord(*labels, 0, LabelSize, n,
      [&](std::uint64_t i, const unsigned char* bytes)
      {
        label[i] = load<std::uint16_t>(bytes);
        instance[i] = load<std::uint16_t>(bytes + 2);
      });
    cloud.columns.push_back({ vtkAvianLidarArrays::SemanticLabel.name, "", 1, std::move(label) });
    cloud.columns.push_back({ vtkAvianLidarArrays::InstanceId.name, "", 1, std::move(instance) });
  }
  dropEmptyCells(cloud);
  return cloud;
}
}
