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

void EchoLabels::label(const std::vector<RangeShare>& shares, const PrimaryHits* lit,
  const std::vector<SecondaryPath>& paths, Echo& echo)
{
  if (shares.empty())
  {
    echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const PrimaryHits& hits = *lit;
  const std::size_t direct = hits.size();
  this->Angles.resize(shares.size());
  for (std::size_t s = 0; s < shares.size(); ++s)
  {
    const std::uint32_t path = shares[s].contribution;
    const double cosine = path < direct ? hits.cosine[path] : paths[path - direct].cosIncidence;
    this->Angles[s] = std::min(1.0, cosine);
  }
  anglesOfAll(this->Angles.data(), this->Angles.size());
  this->Sums.clear();
  const int* const objects = this->Setup.objectIds.data();
  const int* const materials = this->Setup.materialIds.data();
  double all = 0.0;
  double secondary = 0.0;
  double angle = 0.0;
  // Neighbouring paths mostly meet the same: their energies are summed before they are booked.
  int object = 0;
  int material = 0;
  double run = 0.0;
  for (std::size_t s = 0; s < shares.size(); ++s)
  {
    const RangeShare& share = shares[s];
    const bool isDirect = share.contribution < direct;
    const std::uint32_t met =
      isDirect ? hits.triangle[share.contribution] : paths[share.contribution - direct].triangle;
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
    run += share.energy;
    all += share.energy;
    secondary += isDirect ? 0.0 : share.energy;
    angle += share.energy * this->Angles[s];
  }
  this->Sums.add(object, material, run);
  const LabelSums::Sum& largest = this->Sums.largest();
  echo.objectId = largest.object;
  echo.materialId = largest.material;
  echo.labelShare = std::min(1.0, largest.energy / all);
  echo.incidenceAngle = angle / all;
  echo.secondaryShare = secondary / all;
}
}
