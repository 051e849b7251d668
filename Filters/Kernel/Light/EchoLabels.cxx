// SPDX-License-Identifier: BSD-3-Clause
#include "EchoLabels.h"

#include "LaneMath.h"
#include "LaneSums.h"

#include <algorithm>
#include <limits>
#include <utility>

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

/// Not 0 if one of the triangles is of another object or material than the first.
AVIANLIDAR_MULTIVERSION unsigned differences(
  const std::uint32_t* triangles, std::size_t count, const int* objects, const int* materials)
{
  const int object = objects[triangles[0]];
  const int material = materials[triangles[0]];
  unsigned different = 0;
#pragma omp simd reduction(| : different)
  for (std::size_t i = 0; i < count; ++i)
  {
    different |= static_cast<unsigned>(objects[triangles[i]] ^ object) |
      static_cast<unsigned>(materials[triangles[i]] ^ material);
  }
  return different;
}
}

/// True if all that the beam meets is of one object and material.
bool EchoLabels::meetsOneThing(
  const PrimaryHits& hits, const std::vector<SecondaryPath>& paths) const
{
  const int* const objects = this->Setup.objectIds.data();
  const int* const materials = this->Setup.materialIds.data();
  const std::uint32_t first = hits.triangle[0];
  return differences(hits.triangle.data(), hits.size(), objects, materials) == 0 &&
    std::all_of(paths.begin(), paths.end(),
      [&](const SecondaryPath& path)
      {
        return path.triangle == first ||
          (objects[path.triangle] == objects[first] &&
            materials[path.triangle] == materials[first]);
      });
}

/// Of the contributions that have shares, at least.
void EchoLabels::findAngles(
  const RangeShares& shares, const PrimaryHits& hits, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = hits.size();
  this->Angles.resize(direct + paths.size());
  if (shares.which)
  {
    for (std::size_t s = 0; s < shares.count; ++s)
    {
      const std::uint32_t c = shares.which[s];
      const double cosine = c < direct ? hits.cosine[c] : paths[c - direct].cosIncidence;
      this->Angles[c] = lanes::acos(std::min(1.0, cosine));
    }
    return;
  }
  std::copy(hits.cosine.begin(), hits.cosine.end(), this->Angles.begin());
  for (std::size_t p = 0; p < paths.size(); ++p)
  {
    this->Angles[direct + p] = std::min(1.0, paths[p].cosIncidence);
  }
  anglesOfAll(this->Angles.data(), this->Angles.size());
}

/// Energies by object and material.
void EchoLabels::findLargest(
  const RangeShares& shares, const PrimaryHits& hits, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = hits.size();
  const int* const objects = this->Setup.objectIds.data();
  const int* const materials = this->Setup.materialIds.data();
  this->Sums.clear();
  // Neighbouring paths mostly meet the same: their energies are summed before they are booked.
  std::uint32_t triangle = NoTriangle;
  int object = 0;
  int material = 0;
  double run = 0.0;
  const auto book = [&](std::uint32_t met, double energy)
  {
    if (met != triangle)
    {
      triangle = met;
      if (objects[met] != object || materials[met] != material)
      {
        if (run > 0.0)
        {
          this->Sums.add(object, material, run);
        }
        run = 0.0;
        object = objects[met];
        material = materials[met];
      }
    }
    run += energy;
  };
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t c = shares.contribution(s);
    if (shares.energies[s] > 0.0)
    {
      book(c < direct ? hits.triangle[c] : paths[c - direct].triangle, shares.energies[s]);
    }
  }
  this->Sums.add(object, material, run);
}

void EchoLabels::label(const RangeShares& shares, const PrimaryHits* lit,
  const std::vector<SecondaryPath>& paths, Echo& echo)
{
  echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
  if (!lit)
  {
    return;
  }
  this->findAngles(shares, *lit, paths);
  const WeightedSum sum = sumShares(shares, this->Angles.data(), 0.0);
  if (!(sum.energy > 0.0))
  {
    return; // a false alarm
  }
  if (this->meetsOneThing(*lit, paths))
  {
    echo.objectId = std::as_const(this->Setup.objectIds)[lit->triangle[0]];
    echo.materialId = std::as_const(this->Setup.materialIds)[lit->triangle[0]];
    echo.labelShare = 1.0;
  }
  else
  {
    this->findLargest(shares, *lit, paths);
    const LabelSums::Sum& largest = this->Sums.largest();
    echo.objectId = largest.object;
    echo.materialId = largest.material;
    echo.labelShare = largest.energy / this->Sums.total();
  }
  echo.incidenceAngle = sum.moment / sum.energy;
  echo.secondaryShare = paths.empty() ? 0.0 : sumSharesFrom(shares, lit->size()) / sum.energy;
}
}
