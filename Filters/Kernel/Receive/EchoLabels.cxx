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
bool EchoLabels::meetsOneThing(const BeamLight& light) const
{
  const BeamSamples& samples = *light.samples();
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
    std::all_of(light.paths.begin(), light.paths.end(), isFirst);
}

void EchoLabels::findAngles(const BeamLight& light, const RangeShares& shares)
{
  const BeamSamples& samples = *light.samples();
  this->Angles.resize(shares.count);
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::uint32_t c = shares.contribution[s];
    const SecondaryPath* const path = light.pathOf(c);
    const double cosine = path ? path->cosIncidence : samples.cosine[c];
    this->Angles[s] = std::min(1.0, cosine);
  }
  anglesOfAll(this->Angles.data(), this->Angles.size());
}

/// Sum the energies by object and material.
void EchoLabels::findLargest(const BeamLight& light, const RangeShares& shares)
{
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
  auto surface = light.samples()->surfaces.begin();
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::uint32_t c = shares.contribution[s];
    const SecondaryPath* const path = light.pathOf(c);
    while (!path && c >= surface->end)
    {
      ++surface;
    }
    book(path ? path->triangle : surface->triangle, shares.energies[s]);
  }
  this->Sums.add(object, material, run);
}

void EchoLabels::label(const BeamLight& light, const RangeShares& shares, Echo& echo)
{
  const BeamSamples* const samples = light.samples();
  echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
  if (!samples)
  {
    return;
  }
  this->findAngles(light, shares);
  const WeightedSum sum = sumShares(shares, [&](std::size_t s) { return this->Angles[s]; });
  if (!(sum.energy > 0.0))
  {
    return; // a false alarm
  }
  if (this->meetsOneThing(light))
  {
    echo.objectId = this->Setup.objectId(samples->surfaces[0].triangle);
    echo.materialId = this->Setup.materialId(samples->surfaces[0].triangle);
    echo.labelShare = 1.0;
  }
  else
  {
    this->findLargest(light, shares);
    const LabelSums::Sum& largest = this->Sums.largest();
    echo.objectId = largest.object;
    echo.materialId = largest.material;
    echo.labelShare = largest.energy / this->Sums.total();
  }
  echo.incidenceAngle = sum.moment / sum.energy;
  const WeightedSum ofPaths = sumShares(
    shares, [&](std::size_t s) { return light.pathOf(shares.contribution[s]) ? 1.0 : 0.0; });
  echo.secondaryShare = ofPaths.moment / sum.energy;
}
}
