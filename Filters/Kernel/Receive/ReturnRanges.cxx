// SPDX-License-Identifier: BSD-3-Clause
#include "ReturnRanges.h"

#include <algorithm>

namespace avianlidar
{
ReturnRanges::ReturnRanges(const Sensor& sensor, ReturnMode mode)
  : Instrument(sensor)
  , UnitLength(sensor.rangeUnitLength())
  , AtCentres(mode == ReturnMode::RangeUnits)
{
}

double ReturnRanges::placeIn(std::int64_t unit, double place) const
{
  const double begin = static_cast<double>(unit) * this->UnitLength;
  const double low = std::max(begin, this->Instrument.minimumRange);
  const double high = std::min(begin + this->UnitLength, this->Instrument.rangeGate);
  return low < high ? low + place * (high - low) : begin + place * this->UnitLength;
}

double ReturnRanges::ofNoise(const Received& received, const Return& run) const
{
  if (this->AtCentres)
  {
    return this->placeIn(received.units[run.firstUnit].index, 0.5);
  }
  double weight = 0.0;
  double moment = 0.0;
  for (std::size_t u = run.firstUnit; u < run.lastUnit; ++u)
  {
    const ReceivedUnit& unit = received.units[u];
    weight += unit.energy;
    moment += unit.energy * this->placeIn(unit.index, placeOfNoise(received.key, unit.index));
  }
  return moment / weight;
}

double ReturnRanges::of(const Received& received, const Return& run, const RangeShares& shares,
  const std::vector<double>& lengths) const
{
  if (!run.hasLight || this->AtCentres)
  {
    return run.range;
  }
  // Lengths are taken from the beginning of the first unit, which is near and below all lengths.
  // The sums then have no round-off of the range, nor of a unit that is as long as the scene.
  const double reference =
    2.0 * this->UnitLength * static_cast<double>(received.units[run.firstUnit].index);
  const WeightedSum sum =
    sumShares(shares, [&](std::size_t s) { return lengths[shares.contribution[s]] - reference; });
  return sum.energy > 0.0 ? 0.5 * (reference + sum.moment / sum.energy)
                          : this->ofNoise(received, run);
}

double ReturnRanges::reported(const Return& run, double range) const
{
  return this->AtCentres ? range : run.error.reported(range, this->Instrument);
}
}
