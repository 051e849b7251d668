// SPDX-License-Identifier: BSD-3-Clause
#include "AirLight.h"

#include "AirIntegral.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace avianlidar
{
namespace
{
/// Optical depth, there and back, of volumes that hide all media behind them.
constexpr double Opaque = 60.0;
/// Share of the lower limit below which the light of all media in a unit does not matter.
constexpr double Faint = 1e-6;
/// Share of a pulse that may be left by rounding alone.
constexpr double Rounding = 1e-9;
}

void AirLight::begin(const BeamAir& air, const std::vector<MetSurface>& surfaces)
{
  const Sensor& sensor = this->Scan.sensor();
  this->Air = &air;
  this->Surfaces = &surfaces;
  this->Open.assign(air.columns().size(), 1.0);
  this->Dark = this->Scan.gateUnits();
  this->Taken = 0;
  this->TakenTo = 0.0;
  this->Left = 1.0;
  this->Unit = -1;
  const double ofUnit = sensor.pulseEnergy * this->Scan.unitLength();
  this->MostOfUnit = ofUnit * this->Scan.backscatter();
  for (std::size_t k = this->Scan.filling().size(); k < air.mediaMet(); ++k)
  {
    this->MostOfUnit += ofUnit * air.mediumAt(air.mediumMet(k)).backscatter();
  }
}

std::int64_t AirLight::nextLooked(std::int64_t unit, std::int64_t everywhere) const
{
  constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  std::int64_t next = unit < everywhere ? unit : none;
  for (const auto& [first, end] : this->Air->alone())
  {
    next = unit < end ? std::min(next, std::max(unit, first)) : next;
  }
  return next < this->Dark + this->Scan.reach() ? next : none;
}

/// Reduce the columns by all surfaces nearer than a range, m.
void AirLight::takeUpTo(double range)
{
  if (range < this->TakenTo)
  {
    std::fill(this->Open.begin(), this->Open.end(), 1.0);
    this->Taken = 0;
    this->Left = 1.0;
  }
  this->TakenTo = range;
  for (; this->Taken < this->Surfaces->size() && (*this->Surfaces)[this->Taken].range < range;
       ++this->Taken)
  {
    this->takeOne((*this->Surfaces)[this->Taken]);
  }
}

/// Reduce the columns that a surface meets by its share of the pulse. No column becomes negative.
/// The columns together keep the share of the pulse that is left.
void AirLight::takeOne(const MetSurface& surface)
{
  const auto isMet = [&](const AirColumn& column)
  { return surface.columns == 0 || (surface.columns & column.bits) != 0; };
  const std::vector<AirColumn>& columns = this->Air->columns();
  double met = 0.0;
  for (const AirColumn& column : columns)
  {
    met += isMet(column) ? column.weight : 0.0;
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < columns.size(); ++k)
  {
    const double share = met > 0.0 ? surface.weight / met : surface.weight;
    double& open = this->Open[k];
    open = std::max(0.0, open - (met > 0.0 && !isMet(columns[k]) ? 0.0 : share));
    sum += columns[k].weight * open;
  }
  this->Left -= surface.weight;
  const double left = this->Left > Rounding ? this->Left : 0.0;
  for (double& open : this->Open)
  {
    open *= sum > left ? left / sum : 1.0;
  }
}

/// Add the light that a column returns from between two ranges, m.
void AirLight::addColumn(const AirColumn& column, double from, double to)
{
  const double before = this->Air->depth(column, from);
  // The near range share does not bound the light from farther ranges.
  const double light = this->MostOfUnit * this->Scan.collected(from) *
    std::exp(-2.0 * this->Scan.attenuation() * from - before);
  this->Dark =
    light > Faint * this->Scan.sensor().lowerEnergyLimit ? this->Scan.gateUnits() : this->Dark;
  this->Breaks.assign({ from, to });
  for (const BeamAir::Part& part : this->Air->partsOf(column))
  {
    for (const double border : { part.crossing.begin, part.crossing.end })
    {
      if (border > from && border < to)
      {
        this->Breaks.push_back(border);
      }
    }
  }
  std::sort(this->Breaks.begin(), this->Breaks.end());
  for (std::size_t k = 0; k + 1 < this->Breaks.size(); ++k)
  {
    const double begin = this->Breaks[k];
    this->addPiece(
      column, k == 0 ? before : this->Air->depth(column, begin), begin, this->Breaks[k + 1]);
  }
}

/// Add the light of a piece without borders. @param before optical depth of volumes up to `from`
void AirLight::addPiece(const AirColumn& column, double before, double from, double to)
{
  const double middle = 0.5 * (from + to);
  double decay = 2.0 * this->Scan.attenuation(); // upper bound, 1/m
  double change = 0.0;                           // largest slope of the logarithm of a density, 1/m
  this->Here.clear();
  for (BeamAir::Part part : this->Air->partsOf(column))
  {
    MediumCrossing& inside = part.crossing;
    if (middle > inside.begin && middle < inside.end)
    {
      inside = { from, to, inside.densityAt(from), inside.fall };
      decay += part.extinction * (inside.fall == 0.0 ? inside.density : 1.0);
      change = std::max(change, std::fabs(inside.fall));
      this->Here.push_back(part);
    }
  }
  if (before > Opaque || (this->Here.empty() && this->Scan.filling().empty()))
  {
    return;
  }
  const double weight = this->openOf(column) * column.weight;
  const double seen = weight * this->Air->wayBack(column, middle) * this->Scan.sensor().pulseEnergy;
  const auto integralOf = [&](const MediumCrossing& density)
  {
    return airIntegral(this->Scan.apertureRadius() * std::sqrt(0.5), from, to, decay, change,
      [&](double r)
      {
        double depth = before + 2.0 * this->Scan.attenuation() * r;
        for (const BeamAir::Part& part : this->Here)
        {
          depth += part.extinction * part.crossing.upTo(r);
        }
        return this->Scan.gathered(r) * density.densityAt(r) * std::exp(-depth);
      });
  };
  // Media of constant density, and columns of the same decay, share one integral.
  const MediumCrossing everywhere{ from, to, 1.0, 0.0 };
  const std::array<double, 3> wanted{ from, to, decay };
  if (change == 0.0 && this->Known != wanted)
  {
    this->Known = wanted;
    this->OfKnown = airIntegral(this->Scan.apertureRadius() * std::sqrt(0.5), from, to, decay, 0.0,
      [&](double r) { return this->Scan.gathered(r) * std::exp(-decay * (r - from)); });
  }
  const double steady =
    change == 0.0 ? this->OfKnown * std::exp(-before - 2.0 * this->Scan.attenuation() * from) : 0.0;
  const auto add = [&](std::size_t number, const MediumCrossing& crossing)
  {
    const Medium& medium = this->Air->mediumAt(this->Air->mediumMet(number));
    this->Sums[number].mean += seen * medium.backscatter() *
      (change == 0.0 ? crossing.density * steady : integralOf(crossing));
    // Drops count if their middle lies in the beam. Leaves also count if they reach into the beam.
    const double met =
      medium.drops * this->Scan.solidAngle() * (to * to * to - from * from * from) / 3.0 +
      (medium.sharesGaps && medium.drops > 0.0 ? medium.extinction * (to - from) : 0.0);
    this->Sums[number].drops += weight * crossing.densityAt(middle) * met;
  };
  for (std::size_t k = 0; k < this->Scan.filling().size(); ++k)
  {
    add(k, everywhere);
  }
  for (const BeamAir::Part& part : this->Here)
  {
    add(part.seen, part.crossing);
  }
}

const std::vector<AirLight::Share>& AirLight::sharesOf(std::int64_t unit)
{
  if (unit == this->Unit)
  {
    return this->Shares;
  }
  this->Unit = unit;
  this->Shares.clear();
  const double to = this->Scan.unitLength() * static_cast<double>(unit + 1);
  const double from = std::max(to - this->Scan.unitLength(), this->Scan.sensor().minimumRange);
  if (!(this->Scan.sensor().receiverAperture > 0.0) || !(from < to))
  {
    return this->Shares; // the aperture is unknown, or the unit lies before the minimum range
  }
  this->takeUpTo(to - 0.5 * this->Scan.unitLength());
  if (!this->Air->isLocal())
  {
    const double open = unit < this->Scan.units() ? this->Open[0] : 0.0;
    for (std::size_t k = 0; open > 0.0 && k < this->Air->mediaMet(); ++k)
    {
      const Medium& medium = this->Air->mediumAt(this->Air->mediumMet(k));
      this->Shares.push_back({ this->Air->mediumMet(k),
        open * this->Scan.means()[static_cast<std::size_t>(unit)] / this->Scan.backscatter() *
          medium.backscatter(),
        open * this->Scan.solidAngle() * (to * to * to - from * from * from) / 3.0 *
          medium.drops });
    }
    return this->Shares;
  }
  this->Sums.clear();
  for (std::size_t k = 0; k < this->Air->mediaMet(); ++k)
  {
    this->Sums.push_back({ this->Air->mediumMet(k), 0.0, 0.0 });
  }
  this->Dark = std::min(this->Dark, unit);
  for (const AirColumn& column : this->Air->columns())
  {
    if (this->openOf(column) > 0.0)
    {
      this->addColumn(column, from, to);
    }
  }
  std::copy_if(this->Sums.begin(), this->Sums.end(), std::back_inserter(this->Shares),
    [](const Share& share) { return share.mean > 0.0; });
  return this->Shares;
}

double AirLight::followed(std::int64_t unit)
{
  if (!this->Air->isLocal()) // only media that fill the scene
  {
    this->takeUpTo(this->Scan.unitLength() * (static_cast<double>(unit) + 0.5));
    return unit < this->Scan.units()
      ? this->Open[0] * this->Scan.means()[static_cast<std::size_t>(unit)]
      : 0.0;
  }
  double sum = 0.0;
  for (const Share& share : this->sharesOf(unit))
  {
    sum += this->Air->mediumAt(share.medium).isFollowed ? share.mean : 0.0;
  }
  return sum;
}

double AirLight::returnedBy(const MetLeaf& leaf, const AirColumn& column, double share) const
{
  double depth = 0.0;
  for (const BeamAir::Part& part : this->Air->partsOf(column))
  {
    depth += part.perLeaf > 0.0 ? 0.0 : part.extinction * part.crossing.upTo(leaf.range);
  }
  // The mean cosine of the leaves that a ray meets is 2/3.
  return this->Scan.sensor().pulseEnergy * share * this->openOf(column) * 1.5 * leaf.cosine /
    this->Air->mediumAt(leaf.medium).backscatterRatio * this->Scan.gathered(leaf.range) *
    std::exp(-2.0 * this->Scan.attenuation() * leaf.range - depth);
}
}
