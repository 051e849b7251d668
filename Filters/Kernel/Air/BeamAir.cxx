// SPDX-License-Identifier: BSD-3-Clause
#include "BeamAir.h"

#include "BeamShape.h"
#include "Drops.h"

#include <boost/math/quadrature/gauss.hpp>

#include <cmath>
#include <iterator>

namespace avianlidar
{
namespace
{
constexpr std::int64_t NoUnit = std::numeric_limits<std::int64_t>::max();

/// Optical depth, there and back, of volumes that hide all media behind them.
constexpr double Opaque = 60.0;

/// Share of the lower limit below which the light of all media in a unit does not matter.
constexpr double Faint = 1e-6;

/// Share of a pulse that may be left by rounding alone.
constexpr double Rounding = 1e-9;

/// Distances from the aperture's middle, over its radius, and shares of its area: Gauss's rule.
constexpr double PlacesOnAperture[][2] = { { 0.21234054, 0.13965396 }, { 0.59053314, 0.45848221 },
  { 0.91141204, 0.40186383 } };

/// Points across a cell of the grid, in each direction, for the sum of the cell's share of the
/// pulse.
constexpr int PointsOfCell = 16;

/// Axis and eight points of the unit circle. The last four points are the corners of a rectangular
/// beam.
constexpr double H = BeamShape::HalfSide;
constexpr double Rim[][2] = { { 0.0, 0.0 }, { 1.0, 0.0 }, { -1.0, 0.0 }, { 0.0, 1.0 },
  { 0.0, -1.0 }, { H, H }, { H, -H }, { -H, H }, { -H, -H } };

/// Share of the leaves on one of two ways that do not touch the other way. @param x distance
/// between the ways, in diameters of a leaf
double beforeOneWay(double x)
{
  return x < 1.0 ? x * (2.0 - x) : 1.0;
}

/// Integral of f over ranges, m. f falls no faster than exp(-(decay + change) r)/r^2, with a kink.
/// @param reach range of the kink, m: the range to which the aperture gathers half of all light
/// @param decay decay by extinction, 1/m @param change change by densities, 1/m
template <class F>
double airIntegral(double reach, double from, double to, double decay, double change, F f)
{
  // Panels grow by `growth`. No panel is longer than `longestPanel`/(decay + change).
  constexpr double growth = 1.5;
  constexpr double longestPanel = 2.0;
  constexpr double nothingLeft = 700.0; // exponent at which f has vanished
  const double longest = longestPanel / std::max(1e-300, decay + change);
  double sum = 0.0;
  for (double begin = from; begin < to && decay * (begin - from) < nothingLeft;)
  {
    // The step must change `begin` even where extinction acts within the last digit of `begin`.
    const double step = std::max(longest, 1e-15 * begin);
    const double end = std::min({ begin < reach ? reach : growth * begin, begin + step, to });
    // Three points suffice, to 1e-8, on a panel that is short against range and extinction length.
    constexpr double isShort = 0.05;
    sum += end - begin < std::min(isShort * begin, 0.25 * longest)
      ? boost::math::quadrature::gauss<double, 3>::integrate(f, begin, end)
      : boost::math::quadrature::gauss<double, 10>::integrate(f, begin, end);
    begin = end;
  }
  return sum;
}
}

BeamAir::BeamAir(const Sensor& sensor, Air air)
  : Instrument(sensor)
  , All(std::make_shared<const Air>(std::move(air)))
  , Attenuation(attenuationOf(All->clear, All->media))
  , UnitLength(sensor.rangeUnitLength())
  , SolidAngle(sensor.solidAngle())
  , Gate(unitsInsideGate(sensor.samplingInterval, sensor.rangeGate))
  , Reach(PulseShares(sensor.pulseWidth / sensor.samplingInterval).reach())
  , ApertureRadius(std::sqrt(sensor.receiverAperture / Pi))
{
  const BeamWidth width = BeamShape(sensor).width();
  this->HalfWidths = { width.tangent, width.flatness * width.tangent };
  for (std::uint32_t k = 0; k < this->All->media.size(); ++k)
  {
    const PlacedMedium& one = this->All->media[k];
    if (one.fillsScene() && one.medium.backscatter() > 0.0)
    {
      this->Filling.push_back(k);
      this->Backscatter += one.medium.backscatter();
    }
  }
  this->makeMeans();
  this->beginOutside();
}

void BeamAir::makeMeans()
{
  const Sensor& sensor = this->Instrument;
  const double decay = 2.0 * this->Attenuation;
  auto means = std::make_shared<std::vector<double>>();
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
    means->push_back(energy);
  }
  this->Means = std::move(means);
}

/// Make the cells of the grid that lie in the beam.
void BeamAir::makeGrid()
{
  const BeamShape shape(this->Instrument);
  const double width = 2.0 / Across;
  double all = 0.0;
  for (int cell = 0; cell < Across * Across; ++cell)
  {
    const int i = cell % Across;
    const int j = cell / Across;
    Column column{ 0.0, 0.0, 0.0, std::uint64_t{ 1 } << cell };
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
  for (Column& column : this->Grid)
  {
    column.weight /= all;
  }
}

const std::vector<BeamAir::Column>& BeamAir::grid()
{
  if (this->Grid.empty())
  {
    this->makeGrid();
  }
  return this->Grid;
}

void BeamAir::beginOutside()
{
  this->Parts.clear();
  this->findLooked();
  this->take({});
}

void BeamAir::begin(const BeamFrame& frame, double seconds)
{
  this->beginOutside();
  this->Origin = frame.origin;
  this->Seconds = seconds;
  for (std::uint32_t k = 0; k < this->All->media.size(); ++k)
  {
    const PlacedMedium& one = this->All->media[k];
    if (!one.fillsScene() && mayMeet(one.volume, frame, this->Instrument.rangeGate, seconds))
    {
      this->Seen.push_back(k);
    }
  }
  if (this->Seen.size() > this->Filling.size())
  {
    this->divide(frame);
    this->findLooked();
  }
}

void BeamAir::beginRay(const Vec3& origin, const Vec3& direction, double seconds)
{
  this->beginOutside();
  this->Origin = origin;
  this->Seconds = seconds;
  for (std::uint32_t k = 0; k < this->All->media.size(); ++k)
  {
    if (!this->All->media[k].fillsScene())
    {
      this->Seen.push_back(k);
    }
  }
  this->findParts(this->Columns[0], origin, direction);
  this->findLooked();
}

/// Divide a beam into the columns that its volumes require, and find the parts of each column.
void BeamAir::divide(const BeamFrame& frame)
{
  const Vec3* up = nullptr;
  bool isWide = true;
  bool isLayered = true;
  for (std::size_t k = this->Filling.size(); k < this->Seen.size(); ++k)
  {
    const MediumVolume& volume = this->All->media[this->Seen[k]].volume;
    isWide = isWide && isWiderThan(volume, frame, this->Instrument.rangeGate, this->Seconds);
    isLayered = isLayered && !volume.isBounded() && (!up || *up == volume.up);
    up = &volume.up;
  }
  if (isWide)
  {
    this->Columns.clear();
    for (const auto& [x, y] : Rim)
    {
      this->Columns.push_back({ x, y, 1.0, ~std::uint64_t{ 0 } });
    }
    this->findParts(frame);
    if (this->rimAgrees())
    {
      this->Columns.resize(1);
      this->Parts.resize(this->Columns[0].lastPart);
      return;
    }
  }
  this->Columns = this->grid();
  if (isLayered)
  {
    this->mergeRows(frame, *up);
  }
  this->findParts(frame);
}

/// True if rim and axis cross all volumes at the same ranges, to a quarter of a range unit plus a
/// hundredth of the way through. Their optical depths, there and back, must agree within 0.02.
bool BeamAir::rimAgrees() const
{
  const Column& axis = this->Columns[0];
  const double d = this->Instrument.rangeGate;
  const auto isClose = [&](const Part& one, const Part& two)
  {
    const double off = std::max(std::fabs(one.crossing.begin - two.crossing.begin),
      std::fabs(one.crossing.end - two.crossing.end));
    const double length = one.crossing.end - one.crossing.begin;
    return one.seen == two.seen && off < 0.25 * this->UnitLength + 0.01 * length;
  };
  return std::all_of(this->Columns.begin() + 1, this->Columns.end(),
    [&](const Column& column)
    {
      const PartRange inside = this->partsOf(axis);
      const PartRange parts = this->partsOf(column);
      bool agrees = std::equal(inside.begin(), inside.end(), parts.begin(), parts.end(), isClose);
      // Densities may still differ across the beam.
      for (const double range : { 0.125 * d, 0.25 * d, 0.5 * d, d })
      {
        agrees = agrees && std::fabs(this->depth(column, range) - this->depth(axis, range)) < 0.02;
      }
      return agrees;
    });
}

/// Merge columns of similar height into at most eight rows, as layers depend on height alone.
void BeamAir::mergeRows(const BeamFrame& frame, const Vec3& up)
{
  const auto heightOf = [&](const Column& c)
  { return glm::dot(c.x * frame.e1 + c.y * frame.e2, up); };
  std::stable_sort(this->Columns.begin(), this->Columns.end(),
    [&](const Column& a, const Column& b) { return heightOf(a) < heightOf(b); });
  std::size_t rows = 0;
  double before = 0.0;
  for (std::size_t k = 0; k < this->Columns.size(); ++k)
  {
    const Column column = this->Columns[k];
    const bool begins = std::floor(Across * before) > static_cast<double>(rows) - 1.0;
    before += column.weight;
    if (begins)
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

void BeamAir::findParts(const BeamFrame& frame)
{
  this->Parts.clear();
  for (Column& column : this->Columns)
  {
    this->findParts(column, frame.origin, unitVector(frame.direction(column.x, column.y)));
  }
}

void BeamAir::findParts(Column& column, const Vec3& origin, const Vec3& direction)
{
  column.firstPart = this->Parts.size();
  for (std::size_t seen = this->Filling.size(); seen < this->Seen.size(); ++seen)
  {
    const auto& [medium, volume] = this->All->media[this->Seen[seen]];
    this->Found.clear();
    this->Crosser.find(
      volume, origin, direction, this->Instrument.rangeGate, this->Seconds, this->Found);
    // The mean projection of a disc over all directions is half its area.
    const bool isLeaves = medium.sharesGaps && medium.extinction > 0.0;
    const double perLeaf =
      isLeaves ? std::sqrt(Pi * medium.drops / (8.0 * medium.extinction)) : 0.0;
    for (const MediumCrossing& part : this->Found)
    {
      this->Parts.push_back(
        { seen, part, (medium.sharesGaps ? 1.0 : 2.0) * medium.extinction, perLeaf });
    }
  }
  column.lastPart = this->Parts.size();
}

/// Find the units in which media may be perceived by themselves.
void BeamAir::findLooked()
{
  if (!this->isLocal()) // the beam meets no volume
  {
    this->Seen = this->Filling;
    this->Columns.assign(1, { 0.0, 0.0, 1.0, ~std::uint64_t{ 0 } });
  }
  this->Looked.clear();
  this->Dark = this->Gate;
  this->MostOfUnit = this->Instrument.pulseEnergy * this->UnitLength * this->Backscatter;
  if (this->LookedEverywhere > 0)
  {
    this->Looked.emplace_back(0, this->LookedEverywhere);
  }
  for (const Part& part : this->Parts)
  {
    const Medium& medium = this->mediumOf(part);
    const bool isAlone = medium.drops > 0.0 || !medium.isFollowed || !this->Instrument.followsAir();
    if (!isAlone || !(medium.backscatter() > 0.0) || !(this->Instrument.receiverAperture > 0.0))
    {
      continue;
    }
    // Pulses of drops reach into neighbouring units.
    const std::int64_t reach = medium.isFollowed ? this->Reach : 0;
    const auto unitOf = [&](double range)
    { return static_cast<std::int64_t>(std::floor(range / this->UnitLength)); };
    const std::int64_t first = std::max<std::int64_t>(0, unitOf(part.crossing.begin) - reach);
    const std::int64_t end = std::min(this->Gate, unitOf(part.crossing.end) + 1 + reach);
    if (!this->Looked.empty() && first <= this->Looked.back().second &&
      this->Looked.back().first <= end)
    {
      auto& last = this->Looked.back();
      last = { std::min(last.first, first), std::max(last.second, end) };
    }
    else if (first < end)
    {
      this->Looked.emplace_back(first, end);
    }
  }
  for (std::size_t k = this->Filling.size(); k < this->Seen.size(); ++k)
  {
    this->MostOfUnit +=
      this->Instrument.pulseEnergy * this->UnitLength * this->mediumAt(this->Seen[k]).backscatter();
  }
}

std::int64_t BeamAir::nextLooked(std::int64_t unit) const
{
  std::int64_t next = NoUnit;
  for (const auto& [first, end] : this->Looked)
  {
    next = unit < end ? std::min(next, std::max(unit, first)) : next;
  }
  return next < this->Dark + this->Reach ? next : NoUnit;
}

/// Sum over the parts of a column. @param of function that gives the term of a part
template <class F>
double BeamAir::sumOver(const Column& column, F of) const
{
  double sum = 0.0;
  for (const Part& part : this->partsOf(column))
  {
    sum += of(part);
  }
  return sum;
}

/// Optical depth of volumes to a range, m, and back. Leaves count on the way there only.
double BeamAir::depth(const Column& column, double range) const
{
  return this->sumOver(
    column, [&](const Part& part) { return part.extinction * part.crossing.upTo(range); });
}

/// Transmission of leaves on the way back, for light that they transmitted on the way there.
double BeamAir::wayBack(const Column& column, double range) const
{
  std::array<double, std::size(PlacesOnAperture)> depths{};
  bool isFree = true;
  for (const Part& part : this->partsOf(column))
  {
    const double perLeaf = part.perLeaf * this->ApertureRadius;
    if (!(perLeaf > 0.0) || !(part.crossing.begin < range))
    {
      continue;
    }
    isFree = false;
    const double stops = part.extinction * part.crossing.upTo(range);
    const double begin = 1.0 - part.crossing.begin / range;
    const double end = 1.0 - std::min(part.crossing.end, range) / range;
    for (std::size_t k = 0; k < depths.size(); ++k)
    {
      // Simpson's rule is exact at constant density if the ways are closer than a leaf is wide.
      const double x = PlacesOnAperture[k][0] * perLeaf;
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

double BeamAir::transmission(double range, std::uint64_t columns) const
{
  double sum = 0.0;
  double all = 0.0;
  for (const Column& column : this->Columns)
  {
    if (this->isLocal() && (columns == 0 || (columns & column.bits) != 0))
    {
      sum += column.weight * std::exp(-this->depth(column, range)) * this->wayBack(column, range);
      all += column.weight;
    }
  }
  return all > 0.0 ? sum / all : columns != 0 ? this->transmission(range) : 1.0;
}

double BeamAir::transmissionBetween(const Vec3& from, const Vec3& to)
{
  const double length = safeLength(to - from);
  double depth = 0.0;
  for (const PlacedMedium& placed : this->All->media)
  {
    this->Found.clear();
    if (length > 0.0 && !placed.fillsScene())
    {
      this->Crosser.find(placed.volume, this->Origin + from, (to - from) / length, length,
        this->Seconds, this->Found);
    }
    for (const MediumCrossing& part : this->Found)
    {
      depth += placed.medium.extinction * part.upTo(length);
    }
  }
  return std::exp(-depth);
}

void BeamAir::take(std::vector<MetSurface> surfaces)
{
  this->TakenTo = Infinity; // infinity makes takeUpTo() begin anew
  this->Unit = -1;
  this->Surfaces.clear();
  const auto isNearer = [](const MetSurface& a, const MetSurface& b) { return a.range < b.range; };
  if (surfaces.empty() || this->isLocal())
  {
    this->Surfaces = std::move(surfaces);
    std::stable_sort(this->Surfaces.begin(), this->Surfaces.end(), isNearer);
    return;
  }
  // Without columns, all surfaces between the middles of two consecutive units are merged.
  const auto unitOf = [&](double range)
  {
    return static_cast<std::size_t>(
      std::min(static_cast<double>(this->units()), range / this->UnitLength + 0.5));
  };
  const auto ends = std::minmax_element(surfaces.begin(), surfaces.end(), isNearer);
  const std::size_t first = unitOf(ends.first->range);
  this->Breaks.assign(unitOf(ends.second->range) - first + 1, 0.0);
  for (const MetSurface& surface : surfaces)
  {
    this->Breaks[unitOf(surface.range) - first] += surface.weight;
  }
  for (std::size_t k = 0; k < this->Breaks.size(); ++k)
  {
    if (this->Breaks[k] > 0.0)
    {
      this->Surfaces.push_back(
        { this->UnitLength * static_cast<double>(first + k), this->Breaks[k], 0 });
    }
  }
}

/// Reduce the columns by all surfaces nearer than a range, m.
void BeamAir::takeUpTo(double range)
{
  if (range < this->TakenTo)
  {
    for (Column& column : this->Columns)
    {
      column.open = 1.0;
    }
    this->Taken = 0;
    this->Left = 1.0;
  }
  this->TakenTo = range;
  for (; this->Taken < this->Surfaces.size() && this->Surfaces[this->Taken].range < range;
       ++this->Taken)
  {
    this->takeOne(this->Surfaces[this->Taken]);
  }
}

/// Reduce the columns that a surface meets by its share of the pulse. No column becomes negative.
/// The columns together keep the share of the pulse that is left.
void BeamAir::takeOne(const MetSurface& surface)
{
  const auto isMet = [&](const Column& column)
  { return surface.columns == 0 || (surface.columns & column.bits) != 0; };
  double met = 0.0;
  for (const Column& column : this->Columns)
  {
    met += isMet(column) ? column.weight : 0.0;
  }
  double sum = 0.0;
  for (Column& column : this->Columns)
  {
    const double share = met > 0.0 ? surface.weight / met : surface.weight;
    column.open = std::max(0.0, column.open - (met > 0.0 && !isMet(column) ? 0.0 : share));
    sum += column.weight * column.open;
  }
  this->Left -= surface.weight;
  const double left = this->Left > Rounding ? this->Left : 0.0;
  for (Column& column : this->Columns)
  {
    column.open *= sum > left ? left / sum : 1.0;
  }
}

/// Solid angle, sr, at most 2 pi, of the aperture seen from a range, m, times the near range share.
double BeamAir::gathered(double range) const
{
  return this->Instrument.nearRangeShare(range) * this->collected(range);
}

/// Solid angle, sr, in which the aperture appears from a range, m.
double BeamAir::collected(double range) const
{
  return std::min(this->Instrument.receiverAperture / (range * range), 2.0 * Pi);
}

/// Add the light that a column returns from between two ranges, m.
void BeamAir::addColumn(const Column& column, double from, double to)
{
  const double before = this->depth(column, from);
  // The near range share does not bound the light from farther ranges.
  const double light =
    this->MostOfUnit * this->collected(from) * std::exp(-2.0 * this->Attenuation * from - before);
  this->Dark = light > Faint * this->Instrument.lowerEnergyLimit ? this->Gate : this->Dark;
  this->Breaks.assign({ from, to });
  for (const Part& part : this->partsOf(column))
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
      column, k == 0 ? before : this->depth(column, begin), begin, this->Breaks[k + 1]);
  }
}

/// Add the light of a piece without borders. @param before optical depth of volumes up to `from`
void BeamAir::addPiece(const Column& column, double before, double from, double to)
{
  const double middle = 0.5 * (from + to);
  double decay = 2.0 * this->Attenuation; // upper bound, 1/m
  double change = 0.0;                    // largest slope of the logarithm of a density, 1/m
  this->Here.clear();
  for (Part part : this->partsOf(column))
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
  if (before > Opaque || (this->Here.empty() && this->Filling.empty()))
  {
    return;
  }
  const double weight = column.open * column.weight;
  const double seen = weight * this->wayBack(column, middle) * this->Instrument.pulseEnergy;
  const auto integralOf = [&](const MediumCrossing& density)
  {
    return airIntegral(this->ApertureRadius * std::sqrt(0.5), from, to, decay, change,
      [&](double r)
      {
        double depth = before + 2.0 * this->Attenuation * r;
        for (const Part& part : this->Here)
        {
          depth += part.extinction * part.crossing.upTo(r);
        }
        return this->gathered(r) * density.densityAt(r) * std::exp(-depth);
      });
  };
  // Media of constant density, and columns of the same decay, share one integral.
  const MediumCrossing everywhere{ from, to, 1.0, 0.0 };
  const std::array<double, 3> wanted{ from, to, decay };
  if (change == 0.0 && this->Known != wanted)
  {
    this->Known = wanted;
    this->OfKnown = airIntegral(this->ApertureRadius * std::sqrt(0.5), from, to, decay, 0.0,
      [&](double r) { return this->gathered(r) * std::exp(-decay * (r - from)); });
  }
  const double steady =
    change == 0.0 ? this->OfKnown * std::exp(-before - 2.0 * this->Attenuation * from) : 0.0;
  const auto add = [&](std::size_t number, const MediumCrossing& crossing)
  {
    const Medium& medium = this->mediumAt(this->Seen[number]);
    this->Sums[number].mean += seen * medium.backscatter() *
      (change == 0.0 ? crossing.density * steady : integralOf(crossing));
    // Drops count if their middle lies in the beam. Leaves also count if they reach into the beam.
    const double met = medium.drops * this->SolidAngle * (to * to * to - from * from * from) / 3.0 +
      (medium.sharesGaps && medium.drops > 0.0 ? medium.extinction * (to - from) : 0.0);
    this->Sums[number].drops += weight * crossing.densityAt(middle) * met;
  };
  for (std::size_t k = 0; k < this->Filling.size(); ++k)
  {
    add(k, everywhere);
  }
  for (const Part& part : this->Here)
  {
    add(part.seen, part.crossing);
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
  const double to = this->UnitLength * static_cast<double>(unit + 1);
  const double from = std::max(to - this->UnitLength, this->Instrument.minimumRange);
  if (!(this->Instrument.receiverAperture > 0.0) || !(from < to))
  {
    return this->Shares; // the aperture is unknown, or the unit lies before the minimum range
  }
  this->takeUpTo(to - 0.5 * this->UnitLength);
  if (!this->isLocal())
  {
    const double open = unit < this->units() ? this->Columns[0].open : 0.0;
    for (std::size_t k = 0; open > 0.0 && k < this->Seen.size(); ++k)
    {
      const Medium& medium = this->mediumAt(this->Seen[k]);
      this->Shares.push_back({ this->Seen[k],
        open * (*this->Means)[static_cast<std::size_t>(unit)] / this->Backscatter *
          medium.backscatter(),
        open * this->SolidAngle * (to * to * to - from * from * from) / 3.0 * medium.drops });
    }
    return this->Shares;
  }
  this->Sums.clear();
  for (const std::uint32_t number : this->Seen)
  {
    this->Sums.push_back({ number, 0.0, 0.0 });
  }
  this->Dark = std::min(this->Dark, unit);
  for (const Column& column : this->Columns)
  {
    if (column.open > 0.0)
    {
      this->addColumn(column, from, to);
    }
  }
  std::copy_if(this->Sums.begin(), this->Sums.end(), std::back_inserter(this->Shares),
    [](const Share& share) { return share.mean > 0.0; });
  return this->Shares;
}

double BeamAir::followed(std::int64_t unit)
{
  if (!this->isLocal()) // only media that fill the scene
  {
    this->takeUpTo(this->UnitLength * (static_cast<double>(unit) + 0.5));
    return unit < this->units()
      ? this->Columns[0].open * (*this->Means)[static_cast<std::size_t>(unit)]
      : 0.0;
  }
  double sum = 0.0;
  for (const Share& share : this->sharesOf(unit))
  {
    sum += this->mediumAt(share.medium).isFollowed ? share.mean : 0.0;
  }
  return sum;
}

void BeamAir::findLeaves(std::vector<Leaves>& all) const
{
  all.clear();
  for (const Part& part : this->Parts)
  {
    const auto& [begin, end, density, fall] = part.crossing;
    const std::uint32_t medium = this->Seen[part.seen];
    if (!(part.perLeaf > 0.0))
    {
      continue;
    }
    const auto known =
      std::find_if(all.begin(), all.end(), [&](const Leaves& one) { return one.medium == medium; });
    if (known == all.end())
    {
      all.push_back({ medium, begin, end });
      continue;
    }
    known->begin = std::min(known->begin, begin);
    known->end = std::max(known->end, end);
  }
  std::stable_sort(all.begin(), all.end(),
    [](const Leaves& one, const Leaves& two) { return one.begin < two.begin; });
}

const BeamAir::Column& BeamAir::columnOf(std::uint64_t bits) const
{
  const auto found = std::find_if(this->Columns.begin(), this->Columns.end(),
    [=](const Column& column) { return (column.bits & bits) != 0; });
  return found != this->Columns.end() ? *found : this->Columns.front();
}

double BeamAir::densityAt(const Column& column, std::uint32_t medium, double range) const
{
  return this->sumOver(column,
    [&](const Part& part)
    { return this->Seen[part.seen] == medium ? part.crossing.densityAt(range) : 0.0; });
}

double BeamAir::returnedBy(const MetLeaf& leaf, const Column& column, double share) const
{
  const double depth = this->sumOver(column,
    [&](const Part& part)
    { return part.perLeaf > 0.0 ? 0.0 : part.extinction * part.crossing.upTo(leaf.range); });
  // The mean cosine of the leaves that a ray meets is 2/3.
  return this->Instrument.pulseEnergy * share * column.open * 1.5 * leaf.cosine /
    this->mediumAt(leaf.medium).backscatterRatio * this->gathered(leaf.range) *
    std::exp(-2.0 * this->Attenuation * leaf.range - depth);
}

double BeamAir::leftByLeaves(const Column& column, double range) const
{
  const double depth = this->sumOver(column,
    [&](const Part& part)
    { return part.perLeaf > 0.0 ? part.extinction * part.crossing.upTo(range) : 0.0; });
  return std::exp(-depth) * this->wayBack(column, range);
}

double BeamAir::leftByLeaves(double range) const
{
  double sum = 0.0;
  for (const Column& column : this->Columns)
  {
    sum += column.weight * this->leftByLeaves(column, range);
  }
  return sum;
}
}
