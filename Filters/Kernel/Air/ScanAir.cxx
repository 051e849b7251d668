// SPDX-License-Identifier: BSD-3-Clause
#include "ScanAir.h"

#include "AirIntegral.h"
#include "BeamShape.h"
#include "Drops.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Points across a cell of the grid, in each direction, for the sum of the cell's share of the
/// pulse.
constexpr int PointsOfCell = 16;
}

ScanAir::ScanAir(const Sensor& sensor, Air air)
  : Instrument(sensor)
  , All(std::move(air))
  , Attenuation(attenuationOf(All.clear, All.media))
  , UnitLength(sensor.rangeUnitLength())
  , SolidAngle(sensor.solidAngle())
  , Gate(unitsInsideGate(sensor.samplingInterval, sensor.rangeGate))
  , Reach(PulseShares(ReceivedPulse(sensor, sensor.samplingInterval)).reach())
  , ApertureRadius(std::sqrt(sensor.receiverAperture / Pi))
{
  const BeamWidth width = BeamShape(sensor).width();
  this->HalfWidths = { width.tangent, width.flatness * width.tangent };
  for (std::uint32_t k = 0; k < this->All.media.size(); ++k)
  {
    const PlacedMedium& one = this->All.media[k];
    if (one.fillsScene() && one.medium.backscatter() > 0.0)
    {
      this->Filling.push_back(k);
      this->Backscatter += one.medium.backscatter();
    }
  }
  this->makeMeans();
  if (haveVolumes(this->All.media))
  {
    this->makeGrid();
  }
}

void ScanAir::makeMeans()
{
  const Sensor& sensor = this->Instrument;
  const double decay = 2.0 * this->Attenuation;
  const bool any = this->Backscatter > 0.0 && sensor.receiverAperture > 0.0;
  const double count = std::min(MostUnits, static_cast<double>(this->Gate));
  for (double unit = 0.0; any && unit < count; unit += 1.0)
  {
    const double from = std::max(unit * this->UnitLength, sensor.minimumRange);
    const double to = (unit + 1.0) * this->UnitLength;
    const double energy = sensor.pulseEnergy * this->Backscatter *
      airIntegral(this->ApertureRadius * std::sqrt(0.5), from, to, decay, 0.0,
        [&](double r) { return this->gathered(r) * std::exp(-decay * r); });
    if (!(energy > 0.0) && from < to)
    {
      break;
    }
    this->Means.push_back(energy);
  }
}

/// Make the cells of the grid that lie in the beam.
void ScanAir::makeGrid()
{
  const BeamShape shape(this->Instrument);
  const double width = 2.0 / AirColumn::Across;
  double all = 0.0;
  for (int cell = 0; cell < AirColumn::Across * AirColumn::Across; ++cell)
  {
    const int i = cell % AirColumn::Across;
    const int j = cell / AirColumn::Across;
    AirColumn column{ 0.0, 0.0, 0.0, std::uint64_t{ 1 } << cell };
    for (int point = 0; point < PointsOfCell * PointsOfCell; ++point)
    {
      const auto at = [=](int number, int part)
      { return -1.0 + width * (number + (part + 0.5) / PointsOfCell); };
      const double x = at(i, point % PointsOfCell);
      const double y = at(j, point / PointsOfCell);
      const double weight = shape.holds(x, y) ? shape.density(x, y) : 0.0;
      column.x += weight * x;
      column.y += weight * y;
      column.weight += weight;
    }
    if (!(column.weight > 0.0))
    {
      continue;
    }
    // Directions are staggered between cells, so that no straight border passes many directions at
    // once. The mean of the cell's part in the beam replaces a direction that would miss the beam.
    const double x = -1.0 + width * (i + std::fmod(0.5 + 0.7320508 * i + 0.6180340 * j, 1.0));
    const double y = -1.0 + width * (j + std::fmod(0.5 + 0.4142136 * i + 0.2360680 * j, 1.0));
    const bool isIn = shape.holds(x, y);
    column.x = isIn ? x : column.x / column.weight;
    column.y = isIn ? y : column.y / column.weight;
    // This sequence fills a square evenly for any order of the cells.
    const auto number = static_cast<double>(this->Grid.size());
    const double angle = 2.0 * Pi * 0.5698402910 * number;
    column.towards = { std::cos(angle), std::sin(angle) };
    column.nearer = std::fmod(0.7548776662 * number, 1.0);
    all += column.weight;
    this->Grid.push_back(column);
  }
  for (AirColumn& column : this->Grid)
  {
    column.weight /= all;
  }
}

/// Solid angle, sr, at most 2 pi, of the aperture seen from a range, m, times the near range share.
double ScanAir::gathered(double range) const
{
  return this->Instrument.nearRangeShare(range) * this->collected(range);
}

/// Solid angle, sr, in which the aperture appears from a range, m.
double ScanAir::collected(double range) const
{
  return std::min(this->Instrument.receiverAperture / (range * range), 2.0 * Pi);
}
}
