// SPDX-License-Identifier: BSD-3-Clause
#include "EchoLabels.h"

#include "LaneMath.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
AVIANLIDAR_MULTIVERSION void anglesOfAll(double* cosines, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    cosines[i] = lanes::acos(cosines[i]);
  }
}
}

/// True if everything that the beam meets has one object and one material.
bool EchoLabels::meetsOneThing(
  const BeamSamples& samples, const std::vector<SecondaryPath>& paths) const
{
  if (samples.surfaces.empty())
  {
    return false;
  }
  const std::uint32_t first = samples.surfaces[0].triangle;
  const int object = this->Setup.objectId(first);
  const int material = this->Setup.materialId(first);
  const auto isFirst = [&](const auto& met)
  {
    return this->Setup.objectId(met.triangle) == object &&
      this->Setup.materialId(met.triangle) == material;
  };
  return std::all_of(samples.surfaces.begin(), samples.surfaces.end(), isFirst) &&
    std::all_of(paths.begin(), paths.end(), isFirst);
}

void EchoLabels::findAngles(
  const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = samples.size();
  this->Angles.resize(shares.count);
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::uint32_t c = shares.contribution[s];
    const double cosine = c < direct ? samples.cosine[c] : paths[c - direct].cosIncidence;
    this->Angles[s] = std::min(1.0, cosine);
  }
  anglesOfAll(this->Angles.data(), this->Angles.size());
}

/// Sum the energies by object and material.
void EchoLabels::findLargest(
  const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = samples.size();
  this->Sums.clear();
  // Neighbouring paths mostly meet the same surface: their energies are summed before they are
  // added to the list.
  std::uint32_t triangle = NoTriangle;
  int object = 0;
  int material = 0;
  double run = 0.0;
  const auto book = [&](std::uint32_t met, double energy)
  {
    if (met != triangle)
    {
      triangle = met;
      const int itsObject = this->Setup.objectId(met);
      const int itsMaterial = this->Setup.materialId(met);
      if (itsObject != object || itsMaterial != material)
      {
        if (run > 0.0)
        {
          this->Sums.add(object, material, run);
        }
        run = 0.0;
        object = itsObject;
        material = itsMaterial;
      }
    }
    run += energy;
  };
  auto surface = samples.surfaces.begin();
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t c = shares.contribution[s];
    while (c < direct && c >= surface->end)
    {
      ++surface;
    }
    book(c < direct ? surface->triangle : paths[c - direct].triangle, shares.energies[s]);
  }
  this->Sums.add(object, material, run);
}

void EchoLabels::label(const BeamLight& light, const RangeShares& shares, Echo& echo)
{
  const BeamSamples* const samples = light.samples();
  const std::vector<SecondaryPath>& paths = light.paths;
  echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
  if (!samples)
  {
    return;
  }
  this->findAngles(shares, *samples, paths);
  const WeightedSum sum = sumShares(shares, [&](std::size_t s) { return this->Angles[s]; });
  if (!(sum.energy > 0.0))
  {
    return; // a false alarm
  }
  if (this->meetsOneThing(*samples, paths))
  {
    echo.objectId = this->Setup.objectId(samples->surfaces[0].triangle);
    echo.materialId = this->Setup.materialId(samples->surfaces[0].triangle);
    echo.labelShare = 1.0;
  }
  else
  {
    this->findLargest(shares, *samples, paths);
    const LabelSums::Sum& largest = this->Sums.largest();
    echo.objectId = largest.object;
    echo.materialId = largest.material;
    echo.labelShare = largest.energy / this->Sums.total();
  }
  echo.incidenceAngle = sum.moment / sum.energy;
  const WeightedSum ofPaths = sumShares(
    shares, [&](std::size_t s) { return shares.contribution[s] < samples->size() ? 0.0 : 1.0; });
  echo.secondaryShare = ofPaths.moment / sum.energy;
}
}
