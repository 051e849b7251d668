// SPDX-License-Identifier: BSD-3-Clause
#include "LeafGaps.h"

#include "BeamAir.h"
#include "Random.h"

#include <cmath>

namespace avianlidar
{
void LeafGaps::begin(
  BeamAir& along, double solidAngle, std::int32_t seed, std::uint64_t beam, std::int32_t revolution)
{
  this->Parts.clear();
  this->Along = &along;
  const BeamAir::Leaves first = along.firstLeaves();
  const double parts = 1.0 + solidAngle * first.range * first.range / first.area;
  if (!(first.area > 0.0) || parts > MostParts)
  {
    return;
  }
  constexpr std::int32_t always = -1; // leaves that stay are the same in every scan
  const auto count = static_cast<std::uint64_t>(std::lround(parts));
  for (std::uint64_t k = 0; k < count; ++k)
  {
    const auto draw = [&](std::uint64_t number, std::int32_t scan)
    { return uniformPair(seed, beam, 2 * k + number, RandomPurpose::Leaves, scan); };
    const bool isRenewed = draw(0, always)[0] < first.renewed;
    const auto [share, turned] = draw(1, isRenewed ? revolution : always);
    // A leaf is met by the cosine at which it is seen, and returns by that cosine.
    this->Parts.push_back({ share, 1.5 * std::sqrt(turned) });
  }
}

double LeafGaps::openAt(double range) const
{
  const double left = this->Along->leftByLeaves(range);
  std::size_t open = 0;
  for (const auto& [share, light] : this->Parts)
  {
    open += share < left ? 1 : 0;
  }
  return open > 0 ? static_cast<double>(open) / (left * static_cast<double>(this->Parts.size()))
                  : 0.0;
}

double LeafGaps::returnedBetween(double from, double to) const
{
  const double before = this->Along->leftByLeaves(from);
  const double after = this->Along->leftByLeaves(to);
  double sum = 0.0;
  for (const auto& [share, light] : this->Parts)
  {
    sum += share < before && !(share < after) ? light : 0.0;
  }
  return sum > 0.0 ? sum / ((before - after) * static_cast<double>(this->Parts.size())) : 0.0;
}
}
