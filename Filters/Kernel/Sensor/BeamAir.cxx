// SPDX-License-Identifier: BSD-3-Clause
#include "BeamAir.h"

#include "RangeUnits.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr std::int64_t NoUnit = std::numeric_limits<std::int64_t>::max();

/// Optical depth, there and back, behind which nothing is looked for.
constexpr double Opaque = 60.0;

/// Of the lower limit: media return less than that from behind what counts as opaque.
constexpr double Faint = 1e-6;

/// Of a pulse: less is left of it by rounding alone.
constexpr double Rounding = 1e-9;

/// Places on the aperture, over its radius, and their shares of its area: Gauss's rule.
constexpr double PlacesOnAperture[][2] = { { 0.21234054, 0.13965396 }, { 0.59053314, 0.45848221 },
  { 0.91141204, 0.40186383 } };

/// The share of leaves before one of two ways that are not before the other. @param x distance of
/// the ways over a leaf's diameter
double beforeOneWay(double x)
{
  return x < 1.0 ? x * (2.0 - x) : 1.0;
}

/// Points across a cell of the grid, each way, by which its share of the pulse is known.
constexpr int PointsOfCell = 16;
}

BeamAir::BeamAir(const Sensor& sensor, double attenuation, const std::vector<Medium>& everywhere,
  const std::vector<PlacedMedium>& placed, std::int64_t looked)
  : Instrument(sensor)
  , Attenuation(attenuation)
  , UnitLength(sensor.rangeUnitLength())
  , SolidAngle(sensor.solidAngle())
  , Everywhere(everywhere)
  , Placed(placed)
  , LookedEverywhere(looked)
  , ApertureRadius(std::sqrt(sensor.receiverAperture / Pi))
{
  const BeamWidth width = BeamShape(sensor).width();
  this->HalfWidths = { width.tangent, width.flatness * width.tangent };
}

/// The cells of the grid in the beam.
void BeamAir::makeGrid()
{
  const BeamShape shape(this->Instrument);
  const double width = 2.0 / Across;
  double all = 0.0;
  for (int cell = 0; cell < Across * Across; ++cell)
  {
    Column column{ 0.0, 0.0, 0.0, std::uint64_t{ 1 } << cell, {}, 0.0 };
    for (int point = 0; point < PointsOfCell * PointsOfCell; ++point)
    {
      const auto at = [=](int number, int part)
      { return -1.0 + width * (number + (part + 0.5) / PointsOfCell); };
      const double x = at(cell % Across, point % PointsOfCell);
      const double y = at(cell / Across, point / PointsOfCell);
      const double weight = shape.holds(x, y) ? shape.density(x, y) : 0.0;
      column.x += weight * x;
      column.y += weight * y;
      column.weight += weight;
    }
    if (column.weight > 0.0)
    {
      // Points of rows and columns of cells lie at different places, so that no straight border
      // passes many at once; in cells at the rim, in their middle.
      const int i = cell % Across;
      const int j = cell / Across;
      const double x = -1.0 + width * (i + std::fmod(0.5 + 0.7320508 * i + 0.6180340 * j, 1.0));
      const double y = -1.0 + width * (j + std::fmod(0.5 + 0.4142136 * i + 0.2360680 * j, 1.0));
      const bool isIn = shape.holds(x, y);
      column.x = isIn ? x : column.x / column.weight;
      column.y = isIn ? y : column.y / column.weight;
      // A sequence that fills the square evenly, in any order of the cells.
      const auto number = static_cast<double>(this->Grid.size());
      const double angle = 2.0 * Pi * 0.5698402910 * number;
      column.towards = { std::cos(angle), std::sin(angle) };
      column.nearer = std::fmod(0.7548776662 * number, 1.0);
      all += column.weight;
      this->Grid.push_back(column);
    }
  }
  for (Column& column : this->Grid)
  {
    column.weight /= all;
  }
}

const Medium& BeamAir::mediumAt(std::uint32_t number) const
{
  return number < this->Everywhere.size() ? this->Everywhere[number]
                                          : this->Placed[number - this->Everywhere.size()].medium;
}

void BeamAir::begin(const BeamFrame& frame, double seconds)
{
  this->Origin = frame.origin;
  this->Seconds = seconds;
  this->beginEverywhere();
  this->Surfaces = {};
  for (std::uint32_t k = 0; k < this->Placed.size(); ++k)
  {
    if (mayMeet(this->Placed[k].volume, frame, this->Instrument.rangeGate, seconds))
    {
      this->Met.push_back(k);
    }
  }
  if (this->Met.empty())
  {
    return;
  }
  this->chooseColumns(frame);
  this->Parts.clear();
  this->Ends.clear();
  for (const Column& column : this->Columns)
  {
    this->findParts(frame.origin, unitVector(frame.direction(column.x, column.y)));
  }
  this->chooseLooked();
}

/// Whether the rim of a beam crosses all media where its axis does, to a quarter of a range unit
/// and a hundredth of the way through, and as deep, to 0.02 of optical depth there and back.
bool BeamAir::rimAgrees(const BeamFrame& frame)
{
  this->Parts.clear();
  this->Ends.clear();
  constexpr double h = BeamShape::HalfSide; // of a rectangle its corners
  constexpr double rim[][2] = { { 0.0, 0.0 }, { 1.0, 0.0 }, { -1.0, 0.0 }, { 0.0, 1.0 },
    { 0.0, -1.0 }, { h, h }, { h, -h }, { -h, h }, { -h, -h } };
  for (const auto& [x, y] : rim)
  {
    this->findParts(frame.origin, unitVector(frame.direction(x, y)));
  }
  const std::size_t count = this->Ends[0];
  bool agrees = this->Parts.size() == count * std::size(rim);
  for (std::size_t p = count; p < this->Parts.size() && agrees; ++p)
  {
    const Part& one = this->Parts[p % count];
    const Part& two = this->Parts[p];
    const double off = std::max(std::fabs(one.crossing.begin - two.crossing.begin),
      std::fabs(one.crossing.end - two.crossing.end));
    const double length = one.crossing.end - one.crossing.begin;
    agrees = one.medium == two.medium && off < 0.25 * this->UnitLength + 0.01 * length;
  }
  // Nor does the density differ across it.
  const double d = this->Instrument.rangeGate;
  for (std::size_t k = 1; k < this->Ends.size() && agrees; ++k)
  {
    for (const double range : { 0.125 * d, 0.25 * d, 0.5 * d, d })
    {
      agrees = agrees && std::fabs(this->depth(k, range) - this->depth(0, range)) < 0.02;
    }
  }
  return agrees;
}

/// As many columns as the media met ask for.
void BeamAir::chooseColumns(const BeamFrame& frame)
{
  const Vec3* up = nullptr;
  bool isWide = true;
  bool isLayered = true;
  for (const std::uint32_t k : this->Met)
  {
    const MediumVolume& volume = this->Placed[k].volume;
    isWide = isWide && isWiderThan(volume, frame, this->Instrument.rangeGate);
    isLayered = isLayered && !volume.isBounded() && (!up || *up == volume.up);
    up = &volume.up;
  }
  if (isWide && this->rimAgrees(frame))
  {
    this->Columns.assign(1, this->Axis);
    return;
  }
  this->Columns = this->grid();
  if (!isLayered)
  {
    return;
  }
  // Of layers heights alone count: columns of about one height are one.
  const auto heightOf = [&](const Column& c)
  { return glm::dot(c.x * frame.e1 + c.y * frame.e2, *up); };
  std::stable_sort(this->Columns.begin(), this->Columns.end(),
    [&](const Column& a, const Column& b) { return heightOf(a) < heightOf(b); });
  std::size_t rows = 0;
  double before = 0.0;
  for (std::size_t k = 0; k < this->Columns.size(); ++k)
  {
    const Column column = this->Columns[k];
    const bool begins = std::floor(Across * before) > static_cast<double>(rows) - 1.0;
    before += column.weight;
    if (begins || k == 0)
    {
      this->Columns[rows++] = column;
      continue;
    }
    Column& row = this->Columns[rows - 1];
    const double weight = row.weight + column.weight;
    row.x = (row.weight * row.x + column.weight * column.x) / weight;
    row.y = (row.weight * row.y + column.weight * column.y) / weight;
    row.weight = weight;
    row.bits |= column.bits;
  }
  this->Columns.resize(rows);
}

void BeamAir::beginRay(const Vec3& origin, const Vec3& direction, double seconds)
{
  this->Origin = origin;
  this->Seconds = seconds;
  this->beginEverywhere();
  this->Met.resize(this->Placed.size());
  std::iota(this->Met.begin(), this->Met.end(), 0u);
  this->Surfaces = {};
  this->Columns.assign(1, this->Axis);
  this->Parts.clear();
  this->Ends.clear();
  this->findParts(origin, direction);
  this->chooseLooked();
}

/// Add a column.
void BeamAir::findParts(const Vec3& origin, const Vec3& direction)
{
  for (std::uint32_t met = 0; met < this->Met.size(); ++met)
  {
    const std::uint32_t medium = this->Met[met];
    this->Found.clear();
    this->Crosser.find(this->Placed[medium].volume, origin, direction, this->Instrument.rangeGate,
      this->Seconds, this->Found);
    // Seen from all sides a disc is half as large as from its front.
    const Medium& of = this->Placed[medium].medium;
    const double perLeaf =
      of.sharesGaps && of.extinction > 0.0 ? std::sqrt(Pi * of.drops / (8.0 * of.extinction)) : 0.0;
    for (const MediumCrossing& part : this->Found)
    {
      this->Parts.push_back({ medium, met, part, perLeaf });
    }
  }
  this->Ends.push_back(this->Parts.size());
}

/// Find the units in which media return light that may be perceived, and forget the beam if it
/// meets none.
void BeamAir::chooseLooked()
{
  if (this->Parts.empty())
  {
    this->Met.clear();
    return;
  }
  this->OpenOf.assign(this->Columns.size(), 1.0);
  this->Taken = 0;
  this->TakenTo = 0.0;
  this->Left = 1.0;
  this->Unit = -1;
  if (!(this->Instrument.receiverAperture > 0.0))
  {
    return;
  }
  const std::int64_t gate =
    unitsInsideGate(this->Instrument.samplingInterval, this->Instrument.rangeGate);
  double backscatter = 0.0;
  const auto look = [&](const Medium& medium, std::int64_t first, std::int64_t end)
  {
    if (medium.backscatter() > 0.0 && first < std::min(gate, end) &&
      (medium.drops > 0.0 || !medium.isFollowed || !this->Instrument.followsAir()))
    {
      this->Looked.emplace_back(first, std::min(gate, end));
    }
    backscatter += medium.backscatter();
  };
  const PulseShares pulse(this->Instrument.pulseWidth / this->Instrument.samplingInterval);
  for (const Part& part : this->Parts)
  {
    // Pulses of drops reach beyond.
    const std::int64_t reach = this->mediumOf(part).isFollowed ? pulse.reach() : 0;
    const auto unitOf = [&](double range)
    { return static_cast<std::int64_t>(std::floor(range / this->UnitLength)); };
    look(this->mediumOf(part), std::max<std::int64_t>(0, unitOf(part.crossing.begin) - reach),
      unitOf(part.crossing.end) + 1 + reach);
  }
  for (const Medium& medium : this->Everywhere)
  {
    look(medium, 0, this->LookedEverywhere);
  }
  if (this->Looked.empty())
  {
    return;
  }
  std::sort(this->Looked.begin(), this->Looked.end());
  std::size_t count = 1;
  for (const auto& [first, end] : this->Looked)
  {
    auto& last = this->Looked[count - 1].second;
    if (first > last)
    {
      this->Looked[count++] = { first, end };
    }
    else
    {
      last = std::max(last, end);
    }
  }
  this->Looked.resize(count);
  // Nothing is seen through what is opaque: media there return too little for the lower limit.
  const double most = this->Instrument.pulseEnergy * backscatter * this->UnitLength;
  const auto isOpaque = [&](std::int64_t unit)
  {
    const double range = this->UnitLength * static_cast<double>(unit);
    const double light =
      most * std::min(this->Instrument.receiverAperture / (range * range), 2.0 * Pi);
    const double enough =
      std::clamp(std::log(light / (Faint * this->Instrument.lowerEnergyLimit)), 0.0, Opaque);
    for (std::size_t column = 0; column < this->Columns.size(); ++column)
    {
      if (2.0 * this->Attenuation * range + this->depth(column, range) < enough)
      {
        return false;
      }
    }
    return true;
  };
  std::int64_t low = this->Looked.front().first;
  std::int64_t opaque = this->Looked.back().second;
  for (std::int64_t high = opaque; low + 1 < high;)
  {
    const std::int64_t middle = low + (high - low) / 2;
    const bool isBeyond = isOpaque(middle);
    (isBeyond ? high : low) = middle;
    opaque = isBeyond ? middle : opaque;
  }
  while (this->Looked.back().first >= opaque)
  {
    this->Looked.pop_back();
  }
  this->Looked.back().second = std::min(this->Looked.back().second, opaque);
}

/// Optical depth of media that do not fill the scene, there and back; of leaves, there.
double BeamAir::depth(std::size_t column, double range) const
{
  double sum = 0.0;
  for (std::size_t p = column > 0 ? this->Ends[column - 1] : 0; p < this->Ends[column]; ++p)
  {
    const Part& part = this->Parts[p];
    sum += this->waysOf(part) * this->mediumOf(part).extinction * part.crossing.upTo(range);
  }
  return sum;
}

/// What leaves let through on the way back of what they let through on the way there.
double BeamAir::wayBack(std::size_t column, double range) const
{
  std::array<double, std::size(PlacesOnAperture)> depths{};
  bool isFree = true;
  for (std::size_t p = column > 0 ? this->Ends[column - 1] : 0; p < this->Ends[column]; ++p)
  {
    const Part& part = this->Parts[p];
    if (!(part.perLeaf * this->ApertureRadius > 0.0) || !(part.crossing.begin < range))
    {
      continue;
    }
    isFree = false;
    const double stops = this->mediumOf(part).extinction * part.crossing.upTo(range);
    const double begin = 1.0 - part.crossing.begin / range;
    const double end = 1.0 - std::min(part.crossing.end, range) / range;
    for (std::size_t k = 0; k < depths.size(); ++k)
    {
      // Simpson's rule: exact as long as the ways are nearer to each other than a leaf's width.
      const double x = PlacesOnAperture[k][0] * this->ApertureRadius * part.perLeaf;
      depths[k] += stops / 6.0 *
        (beforeOneWay(x * begin) + 4.0 * beforeOneWay(0.5 * x * (begin + end)) +
          beforeOneWay(x * end));
    }
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < depths.size() && !isFree; ++k)
  {
    sum += PlacesOnAperture[k][1] * std::exp(-depths[k]);
  }
  return isFree ? 1.0 : sum;
}

double BeamAir::transmission(double range, std::uint64_t columns)
{
  double sum = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; this->isLocal() && k < this->Columns.size(); ++k)
  {
    const Column& column = this->Columns[k];
    if (columns == 0 || (columns & column.bits) != 0)
    {
      sum += column.weight * std::exp(-this->depth(k, range)) * this->wayBack(k, range);
      all += column.weight;
    }
  }
  return all > 0.0 ? sum / all : columns != 0 ? this->transmission(range) : 1.0;
}

double BeamAir::transmissionBetween(const Vec3& from, const Vec3& to)
{
  const double length = safeLength(to - from);
  if (!(length > 0.0))
  {
    return 1.0;
  }
  double depth = 0.0;
  for (const PlacedMedium& placed : this->Placed)
  {
    this->Found.clear();
    this->Crosser.find(
      placed.volume, this->Origin + from, (to - from) / length, length, this->Seconds, this->Found);
    for (const MediumCrossing& part : this->Found)
    {
      depth += placed.medium.extinction * part.upTo(length);
    }
  }
  return std::exp(-depth);
}

void BeamAir::take(const SurfacesInAir& surfaces)
{
  this->Surfaces = surfaces;
  this->Open.clear();
  this->Unit = -1;
  if (surfaces.count == 0)
  {
    return;
  }
  if (this->isLocal())
  {
    this->Order.resize(surfaces.count);
    std::iota(this->Order.begin(), this->Order.end(), 0u);
    std::stable_sort(this->Order.begin(), this->Order.end(),
      [&](std::uint32_t a, std::uint32_t b) { return surfaces.ranges[a] < surfaces.ranges[b]; });
    return;
  }
  // The units by whose middle surfaces have taken something.
  const double most = std::min(AirEcho::MostUnits,
    static_cast<double>(
      unitsInsideGate(this->Instrument.samplingInterval, this->Instrument.rangeGate)));
  const auto unitOf = [&](double range)
  { return static_cast<std::int64_t>(std::min(most, range / this->UnitLength + 0.5)); };
  const auto [nearest, farthest] =
    std::minmax_element(surfaces.ranges, surfaces.ranges + surfaces.count);
  this->FirstTaken = unitOf(*nearest);
  this->Open.assign(static_cast<std::size_t>(unitOf(*farthest) - this->FirstTaken + 1), 0.0);
  for (std::size_t i = 0; i < surfaces.count; ++i)
  {
    this->Open[static_cast<std::size_t>(unitOf(surfaces.ranges[i]) - this->FirstTaken)] +=
      surfaces.weights[i];
  }
  double left = 1.0;
  for (double& share : this->Open)
  {
    left -= share;
    share = left > Rounding ? left : 0.0;
  }
}

void BeamAir::setOpen(std::int64_t first, std::vector<double> open)
{
  this->FirstTaken = first;
  this->Open = std::move(open);
}

double BeamAir::open(std::int64_t unit) const
{
  if (this->Open.empty() || unit < this->FirstTaken)
  {
    return 1.0;
  }
  return this
    ->Open[std::min(static_cast<std::size_t>(unit - this->FirstTaken), this->Open.size() - 1)];
}

double BeamAir::weightOf(std::uint64_t columns) const
{
  double sum = 0.0;
  for (const Column& column : this->Columns)
  {
    sum += (columns & column.bits) != 0 ? column.weight : 0.0;
  }
  return sum;
}

/// Take off what surfaces meet up to a range, m.
void BeamAir::takeUpTo(double range)
{
  if (range < this->TakenTo)
  {
    this->OpenOf.assign(this->Columns.size(), 1.0);
    this->Taken = 0;
    this->Left = 1.0;
  }
  this->TakenTo = range;
  for (; this->Taken < this->Surfaces.count; ++this->Taken)
  {
    const std::uint32_t i = this->Order[this->Taken];
    if (!(this->Surfaces.ranges[i] < range))
    {
      break;
    }
    this->takeOne(
      this->Surfaces.weights[i], this->Surfaces.columns ? this->Surfaces.columns[i] : 0);
  }
}

/// Take a share of the pulse off some columns. No column has less than nothing, and all together
/// have what is left.
void BeamAir::takeOne(double weight, std::uint64_t columns)
{
  const double of = columns != 0 ? this->weightOf(columns) : 1.0;
  double sum = 0.0;
  for (std::size_t k = 0; k < this->Columns.size(); ++k)
  {
    const bool isMet = of <= 0.0 || columns == 0 || (columns & this->Columns[k].bits) != 0;
    this->OpenOf[k] =
      std::max(0.0, this->OpenOf[k] - (isMet ? weight / (of > 0.0 ? of : 1.0) : 0.0));
    sum += this->Columns[k].weight * this->OpenOf[k];
  }
  this->Left -= weight;
  const double left = this->Left > Rounding ? this->Left : 0.0;
  for (double& open : this->OpenOf)
  {
    open *= sum > left ? left / sum : 1.0;
  }
}

/// Solid angle, sr, from which light of a range, m, is gathered, less what misses the detector.
double BeamAir::gathered(double range) const
{
  return this->Instrument.nearRangeShare(range) *
    std::min(this->Instrument.receiverAperture / (range * range), 2.0 * Pi);
}

/// Add what a column sends back from between two ranges, m, that no border of a medium divides.
void BeamAir::addShares(std::size_t column, double open, double from, double to)
{
  const Sensor& sensor = this->Instrument;
  const double middle = 0.5 * (from + to);
  double decay = 2.0 * this->Attenuation; // 1/m, at most
  double slope = decay;                   // of the depth, where no density changes
  double change = 0.0;                    // of densities, 1/m
  this->Here.clear();
  for (std::size_t p = column > 0 ? this->Ends[column - 1] : 0; p < this->Ends[column]; ++p)
  {
    const Part& part = this->Parts[p];
    if (middle > part.crossing.begin && middle < part.crossing.end)
    {
      this->Here.push_back(part);
      const double extinction = this->waysOf(part) * this->mediumOf(part).extinction;
      decay += extinction;
      slope += extinction * part.crossing.density;
      change = std::max(change, std::fabs(part.crossing.fall));
    }
  }
  if (this->Here.empty() && this->Everywhere.empty())
  {
    return;
  }
  const double before = this->depth(column, from);
  if (before > Opaque)
  {
    return;
  }
  const double weight = open * this->Columns[column].weight;
  const double seen = weight * this->wayBack(column, middle);
  const auto light = [&](double r)
  {
    double depth = before + 2.0 * this->Attenuation * r;
    for (const Part& part : this->Here)
    {
      depth += this->waysOf(part) * this->mediumOf(part).extinction *
        (part.crossing.upTo(r) - part.crossing.upTo(from));
    }
    return this->gathered(r) * std::exp(-depth);
  };
  // Where no density changes, all media share one integral, and columns of one slope, too.
  const Steady wanted{ from, to, slope };
  if (change == 0.0 && this->Known != wanted)
  {
    this->Known = wanted;
    this->OfKnown = airIntegral(sensor, from, to, slope,
      [&](double r) { return this->gathered(r) * std::exp(-slope * (r - from)); });
  }
  const double steady =
    change == 0.0 ? this->OfKnown * std::exp(-before - 2.0 * this->Attenuation * from) : 0.0;
  const auto add = [&](std::size_t number, const Medium& medium, const MediumCrossing* part)
  {
    const auto densityAt = [&](double r) { return part ? part->densityAt(r) : 1.0; };
    if (medium.backscatter() > 0.0)
    {
      this->Means[number] += seen * sensor.pulseEnergy * medium.backscatter() *
        (change == 0.0 ? densityAt(middle) * steady
                       : airIntegral(
                           sensor, from, to, decay,
                           [&](double r) { return light(r) * densityAt(r); }, change));
    }
    if (medium.drops > 0.0)
    {
      // Those whose middle lies in the beam, and leaves that reach into it.
      const double met =
        medium.drops * this->SolidAngle * (to * to * to - from * from * from) / 3.0 +
        (medium.sharesGaps ? medium.extinction * (to - from) : 0.0);
      this->Drops[number] += weight * densityAt(middle) * met;
    }
  };
  for (std::size_t k = 0; k < this->Everywhere.size(); ++k)
  {
    add(k, this->Everywhere[k], nullptr);
  }
  for (const Part& part : this->Here)
  {
    add(this->Everywhere.size() + part.met, this->mediumOf(part), &part.crossing);
  }
}

const std::vector<BeamAir::Share>& BeamAir::sharesOf(std::int64_t unit)
{
  if (unit == this->Unit)
  {
    return this->Shares;
  }
  this->Unit = unit;
  this->Shares.clear();
  const auto everywhere = static_cast<std::uint32_t>(this->Everywhere.size());
  const std::size_t media = everywhere + this->Met.size();
  this->Means.assign(media, 0.0);
  this->Drops.assign(media, 0.0);
  if (!(this->Instrument.receiverAperture > 0.0))
  {
    return this->Shares; // nothing is known of what comes back
  }
  const double from = this->UnitLength * static_cast<double>(unit);
  const double to = from + this->UnitLength;
  if (!(this->Instrument.minimumRange < to))
  {
    return this->Shares;
  }
  this->takeUpTo(0.5 * (from + to));
  for (std::size_t column = 0; column < this->Columns.size(); ++column)
  {
    if (!(this->OpenOf[column] > 0.0))
    {
      continue;
    }
    this->Breaks.assign({ std::max(from, this->Instrument.minimumRange), to });
    for (std::size_t p = column > 0 ? this->Ends[column - 1] : 0; p < this->Ends[column]; ++p)
    {
      for (const double border : { this->Parts[p].crossing.begin, this->Parts[p].crossing.end })
      {
        if (border > this->Breaks[0] && border < to)
        {
          this->Breaks.push_back(border);
        }
      }
    }
    std::sort(this->Breaks.begin(), this->Breaks.end());
    for (std::size_t k = 0; k + 1 < this->Breaks.size(); ++k)
    {
      this->addShares(column, this->OpenOf[column], this->Breaks[k], this->Breaks[k + 1]);
    }
  }
  for (std::uint32_t k = 0; k < media; ++k)
  {
    if (this->Means[k] > 0.0)
    {
      const std::uint32_t number = k < everywhere ? k : everywhere + this->Met[k - everywhere];
      this->Shares.push_back({ number, this->Means[k], this->Drops[k] });
    }
  }
  return this->Shares;
}

void BeamAir::findLeaves(std::vector<Leaves>& all) const
{
  all.clear();
  const auto first = static_cast<std::uint32_t>(this->Everywhere.size());
  for (const Part& part : this->Parts)
  {
    const Medium& medium = this->mediumOf(part);
    if (!medium.sharesGaps || !(medium.drops > 0.0))
    {
      continue;
    }
    const Leaves found{ first + part.medium, part.crossing.begin, part.crossing.end };
    const auto known = std::find_if(
      all.begin(), all.end(), [&](const Leaves& one) { return one.medium == found.medium; });
    if (known == all.end())
    {
      all.push_back(found);
      continue;
    }
    known->begin = std::min(known->begin, found.begin);
    known->end = std::max(known->end, found.end);
  }
  std::stable_sort(all.begin(), all.end(),
    [](const Leaves& one, const Leaves& two) { return one.begin < two.begin; });
}

const std::vector<BeamAir::Column>& BeamAir::grid()
{
  if (this->Grid.empty())
  {
    this->makeGrid();
  }
  return this->Grid;
}

std::size_t BeamAir::columnOf(const Column& cell) const
{
  const auto found = std::find_if(this->Columns.begin(), this->Columns.end(),
    [&](const Column& column) { return (column.bits & cell.bits) != 0; });
  return static_cast<std::size_t>(found - this->Columns.begin());
}

double BeamAir::densityAt(std::size_t column, std::uint32_t medium, double range) const
{
  double density = 0.0;
  for (std::size_t p = column > 0 ? this->Ends[column - 1] : 0; p < this->Ends[column]; ++p)
  {
    const Part& part = this->Parts[p];
    density +=
      this->Everywhere.size() + part.medium == medium ? part.crossing.densityAt(range) : 0.0;
  }
  return density;
}

double BeamAir::returnedBy(const MetLeaf& leaf, std::size_t column, double share) const
{
  double depth = 2.0 * this->Attenuation * leaf.range;
  for (std::size_t p = column > 0 ? this->Ends[column - 1] : 0; p < this->Ends[column]; ++p)
  {
    const Part& part = this->Parts[p];
    const Medium& medium = this->mediumOf(part);
    depth += medium.sharesGaps ? 0.0 : 2.0 * medium.extinction * part.crossing.upTo(leaf.range);
  }
  // Seen leaves have a mean cosine of 2/3.
  return this->Instrument.pulseEnergy * share * this->OpenOf[column] * 1.5 * leaf.cosine /
    this->mediumAt(leaf.medium).backscatterRatio * this->gathered(leaf.range) * std::exp(-depth);
}

double BeamAir::leftByLeaves(double range) const
{
  double sum = 0.0;
  for (std::size_t column = 0; column < this->Columns.size(); ++column)
  {
    double depth = 0.0;
    for (std::size_t p = column > 0 ? this->Ends[column - 1] : 0; p < this->Ends[column]; ++p)
    {
      const Medium& medium = this->mediumOf(this->Parts[p]);
      depth += medium.sharesGaps && medium.drops > 0.0
        ? medium.extinction * this->Parts[p].crossing.upTo(range)
        : 0.0;
    }
    sum += this->Columns[column].weight * std::exp(-depth) * this->wayBack(column, range);
  }
  return sum;
}

double BeamAir::followed(const AirEcho& echo, std::int64_t unit)
{
  if (!this->isLocal())
  {
    return echo.mean(unit) * this->open(unit);
  }
  double sum = 0.0;
  for (const Share& share : this->sharesOf(unit))
  {
    sum += this->mediumAt(share.medium).isFollowed ? share.mean : 0.0;
  }
  return sum;
}

std::int64_t BeamAir::nextLooked(std::int64_t unit) const
{
  const auto next = std::upper_bound(this->Looked.begin(), this->Looked.end(), unit,
    [](std::int64_t at, const auto& units) { return at < units.second; });
  return next == this->Looked.end() ? NoUnit : std::max(unit, next->first);
}
}
