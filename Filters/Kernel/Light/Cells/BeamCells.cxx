// SPDX-License-Identifier: BSD-3-Clause
#include "BeamCells.h"

#include "Multiversion.h"
#include "Random.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
constexpr std::size_t Patterns = 256; ///< of jitter

/// Strips no longer than this part of the range.
constexpr double MostOfRange = 0.02;
constexpr double MostParts = 64.0;

/// Most strips of a beam.
constexpr double MostStrips = 4e6;

/// Most levels of division: cells of small objects, and those about the middle of a lobe.
constexpr int MostLevels = 8;
constexpr int LevelsOfFoot = 5;

/// m up to which a cell with small objects gets more rays instead of being divided.
constexpr int MostBlocks = 3;

/// Squared sine of incidence below which strips are not divided further.
constexpr double LeastSine2 = 1e-8;

/// Half-beamwidth up to which the solid angle of a cell follows from its middle.
constexpr double NarrowBeam = 0.02;

/// A place that no cell holds.
constexpr float Nowhere = 1e30f;

double beyondFloor(double x)
{
  return x - std::floor(x);
}

/// Area of the unit disc within x0 <= x <= x1, y0 <= y <= y1, all of them at least 0.
double areaInQuadrant(double x0, double x1, double y0, double y1)
{
  const auto reach = [](double y) { return y < 1.0 ? std::sqrt((1.0 - y) * (1.0 + y)) : 0.0; };
  const double whole = std::clamp(reach(y1), x0, x1);
  const double end = std::clamp(reach(y0), x0, x1);
  const auto under = [&](double x)
  { return 0.5 * (x * reach(x) + std::asin(std::min(1.0, x))) - y0 * x; };
  return (whole - x0) * (y1 - y0) + (under(end) - under(whole));
}

/// Area of the disc within a square that does not cross an axis.
double areaInDisc(double x, double y, double width)
{
  const double x0 = std::min(std::fabs(x), std::fabs(x + width));
  const double y0 = std::min(std::fabs(y), std::fabs(y + width));
  const double x1 = x0 + width;
  const double y1 = y0 + width;
  if (x1 * x1 + y1 * y1 <= 1.0)
  {
    return width * width;
  }
  if (x0 * x0 + y0 * y0 >= 1.0)
  {
    return 0.0;
  }
  return areaInQuadrant(x0, x0 + width, y0, y0 + width);
}

/// Number of a strip of incidence, by its squared sine: sixteen for each doubling, from LeastSine2
/// on.
AVIANLIDAR_ALWAYS_INLINE double lobeStrip(double sine2)
{
  const auto value = static_cast<float>(sine2 + LeastSine2);
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return static_cast<double>(bits >> 19);
}

/// The greatest integer not above a number of magnitude below 2^51: floor(), also in lanes.
AVIANLIDAR_ALWAYS_INLINE double whole(double x)
{
  const double rounded = (x + 0x1.8p52) - 0x1.8p52;
  return rounded > x ? rounded - 1.0 : rounded;
}

/// Number of the strip between borders of units in which a range lies. Borders of one kind divide
/// the strips of the other.
AVIANLIDAR_ALWAYS_INLINE double unitStrip(
  double range, double gate, double perMetre, double one, double two)
{
  const double units = (range < gate ? range : gate) * perMetre;
  return whole(units - one) + whole(units - two);
}

AVIANLIDAR_ALWAYS_INLINE double sine2At(double range, double height)
{
  const double cosine = height / range;
  return cosine < 1.0 ? (1.0 - cosine) * (1.0 + cosine) : 0.0;
}

}

double CellSamples::errorOf(const RangeShares& shares) const
{
  double variance = 0.0;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t sample = shares.contribution(s);
    if (sample >= this->samples.size())
    {
      break;
    }
    const double weight = this->samples.weight[sample];
    if (weight > 0.0)
    {
      const double energy = shares.energies[s] / weight;
      variance += energy * energy * this->variance[sample];
    }
  }
  return std::sqrt(variance);
}

CellDensity densityOfCells(int raysPerBeam)
{
  // 16 and 256 cells fill the square, of which the disc is pi/4. A second level is worth its lists
  // from about 1,000 rays on.
  constexpr double many = 1000.0;
  const double rays = CellRaysPerRay * raysPerBeam;
  const int levels = rays < many ? 1 : 2;
  const double least = 0.25 * Pi * CellLanes * (levels == 1 ? 16.0 : 256.0);
  return { levels, std::max(1, static_cast<int>(std::lround(std::sqrt(rays / least)))) };
}

BeamCells::BeamCells(const ScanSetup& setup)
  : Setup(setup)
  , Density(densityOfCells(setup.settings.raysPerBeam))
  , UnitLength(setup.sensor.rangeUnitLength())
  , Gate(setup.sensor.rangeGate + UnitLength + 0.5 * SpeedOfLight * setup.sensor.pulseWidth)
  , Offset(0.5 * setup.sensor.pulseWidth / setup.sensor.samplingInterval)
{
}

/// The objects that are small against the spacing of the rays, by surface.
void BeamCells::findObjects()
{
  this->HasObjects = false;
  this->Objects.clear();
  for (std::uint32_t c = 0; c < this->All->size(); ++c)
  {
    this->Objects.emplace_back(this->Setup.objectIds[(*this->All)[c].triangle], c);
  }
  std::sort(this->Objects.begin(), this->Objects.end());
  const double rays = CellRaysPerRay * this->Setup.settings.raysPerBeam;
  for (std::size_t first = 0, end = 0; first < this->Objects.size(); first = end)
  {
    double area = 0.0;
    for (end = first;
         end < this->Objects.size() && this->Objects[end].first == this->Objects[first].first;
         ++end)
    {
      area += (*this->All)[this->Objects[end].second].area;
    }
    // A body has a front and a back.
    const double share = 0.5 * area / Pi;
    if (share > LeastShareOfObject && share * rays < RaysOnObject)
    {
      this->HasObjects = true;
      for (std::size_t k = first; k < end; ++k)
      {
        this->Surfaces[this->Objects[k].second].share = static_cast<float>(share);
      }
    }
  }
}

/// The surfaces in single precision. 1/z is scaled by its largest, so that it is a number in any
/// scene.
void BeamCells::setSurfaces(const BeamFrame& frame)
{
  constexpr float outwards = 1.0f + 1e-6f;
  constexpr double rounding = 4e-7;
  this->HasFeet = false;
  this->Surfaces.resize(this->All->size());
  const double scale = 1.0 / this->All->front().mostInverse;
  const double perFoot = 1.0 / (frame.tanHalf * frame.tanHalf);
  for (std::size_t k = 0; k < this->Surfaces.size(); ++k)
  {
    const BeamSurface& from = (*this->All)[k];
    CellSurface& s = this->Surfaces[k];
    for (int i = 0; i < 4; ++i)
    {
      const PlaneLine line = i < from.count ? from.lines[i] : PlaneLine{ 0.0, 0.0, 1.0 };
      s.lines[i][0] = static_cast<float>(line.x);
      s.lines[i][1] = static_cast<float>(line.y);
      s.lines[i][2] = static_cast<float>(line.z);
      s.slopes[i] = std::fabs(s.lines[i][0]) + std::fabs(s.lines[i][1]);
    }
    const PlaneLine& w = from.inverse;
    s.inverse[0] = static_cast<float>(scale * w.x);
    s.inverse[1] = static_cast<float>(scale * w.y);
    s.inverse[2] = static_cast<float>(scale * w.z);
    s.inverseSlope = std::fabs(s.inverse[0]) + std::fabs(s.inverse[1]);
    s.most = outwards * static_cast<float>(scale * from.mostInverse);
    s.slack =
      static_cast<float>(rounding * scale * (std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z)));
    s.share = 0.0f;
    const double x = perFoot * w.x / w.z;
    const double y = perFoot * w.y / w.z;
    const bool isIn = std::fabs(x) < 2.0 && std::fabs(y) < 2.0;
    s.foot[0] = isIn ? static_cast<float>(x) : Nowhere;
    s.foot[1] = isIn ? static_cast<float>(y) : Nowhere;
    this->HasFeet = this->HasFeet || isIn;
  }
}

std::unique_ptr<CellSamples> BeamCells::find(
  std::uint64_t beam, const BeamFrame& frame, const std::vector<BeamSurface>& entering)
{
  if (entering.empty() || entering.size() > MostTrianglesOfCells)
  {
    return nullptr;
  }
  if (this->Jitter.empty())
  {
    this->Jitter.resize(Patterns * 2 * CellLanes);
    for (std::size_t i = 0; i < Patterns * CellLanes; ++i)
    {
      const auto u =
        uniformPair(this->Setup.settings.seed, i / CellLanes, i % CellLanes, RandomPurpose::Cells);
      this->Jitter[i / CellLanes * 2 * CellLanes + i % CellLanes] = u[0];
      this->Jitter[i / CellLanes * 2 * CellLanes + CellLanes + i % CellLanes] = u[1];
    }
  }
  this->Beam = beam;
  this->All = &entering;
  this->Tangent2 = frame.tanHalf * frame.tanHalf;
  const double sine = std::sin(0.5 * this->Setup.sensor.halfBeamwidth);
  this->ShareOfArea = this->Tangent2 / (4.0 * Pi * sine * sine);
  this->setSurfaces(frame);
  this->findObjects();
  this->Of.assign(entering.size(), Strips());
  ++this->Number;
  this->Used = 0;
  this->TooMany = false;
  this->Touched.clear();
  this->Levels.resize(MostLevels + 1);
  std::vector<std::uint32_t>& all = this->Visible;
  all.resize(entering.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto count = static_cast<std::uint32_t>(all.size());
  this->divide({ 0, 0, 0, 0.0f, -1.0, -1.0, 2.0, Pi }, { all.data(), count });
  return this->TooMany ? nullptr : this->collect();
}

/// m for a cell: as for all, or so that enough rays fall on each small object in it.
int BeamCells::blocksFor(const Cell& cell, List list) const
{
  if (!this->HasObjects)
  {
    return this->Density.blocks;
  }
  float smallest = std::numeric_limits<float>::infinity();
  for (std::uint32_t k = 0; k < list.count; ++k)
  {
    const float share = this->Surfaces[list.surfaces[k]].share;
    smallest = share > 0.0f && share < smallest ? share : smallest;
  }
  const double rays = RaysOnObject * cell.width * cell.width * this->ShareOfArea / smallest;
  return std::max(this->Density.blocks, static_cast<int>(std::ceil(std::sqrt(rays / CellLanes))));
}

/// True if the middle of a specular lobe lies in a cell or near it.
bool BeamCells::mayHoldFoot(const Cell& cell, List list) const
{
  const double x = cell.x + 0.5 * cell.width;
  const double y = cell.y + 0.5 * cell.width;
  return this->HasFeet &&
    std::any_of(list.surfaces, list.surfaces + list.count,
      [&](std::uint32_t number)
      {
        const CellSurface& s = this->Surfaces[number];
        return std::fabs(s.foot[0] - x) < cell.width && std::fabs(s.foot[1] - y) < cell.width;
      });
}

void BeamCells::divide(const Cell& cell, List list)
{
  Level& level = this->Levels[cell.level];
  CellChildren& children = level.children;
  const double width = 0.25 * cell.width;
  children.x = static_cast<float>(cell.x);
  children.y = static_cast<float>(cell.y);
  children.width = static_cast<float>(width);
  level.numbers.resize(std::max<std::size_t>(level.numbers.size(), CellLanes * list.count));
  for (std::uint32_t i = 0; i < CellLanes; ++i)
  {
    children.occluders[i] = cell.occluder;
    children.counts[i] = 0;
    children.lists[i] = level.numbers.data() + i * list.count;
  }
  distribute(this->Surfaces.data(), list.surfaces, list.count, children);
  for (std::uint32_t i = 0; i < CellLanes && !this->TooMany; ++i)
  {
    Cell child{ cell.level + 1, 4 * cell.column + i % 4, 4 * cell.row + i / 4,
      children.occluders[i], cell.x + width * (i % 4), cell.y + width * (i / 4), width, 0.0 };
    child.area = areaInDisc(child.x, child.y, width);
    if (children.counts[i] > 0 && child.area > 0.0)
    {
      this->solve(child, { children.lists[i], children.counts[i] });
    }
  }
}

/// Find what a cell shows.
void BeamCells::solve(const Cell& cell, List list)
{
  if (cell.occluder > 0.0f && list.count == 1 && this->addWhole(cell, list.surfaces[0]))
  {
    return;
  }
  const int most = std::max(MostBlocks, this->Density.blocks);
  const int blocks = this->blocksFor(cell, list);
  const bool divides = cell.level < this->Density.levels ||
    (cell.level < MostLevels && blocks > most) ||
    (cell.level < LevelsOfFoot && this->mayHoldFoot(cell, list));
  divides ? this->divide(cell, list) : this->trace(cell, list, std::min(blocks, most));
}

/// Add a cell that one surface covers. @return false if it takes more than one sample
bool BeamCells::addWhole(const Cell& cell, std::uint32_t surface)
{
  const bool rim = cell.area < cell.width * cell.width;
  if (rim || this->Setup.sensor.beamProfile != BeamProfile::Uniform ||
    this->Tangent2 > NarrowBeam * NarrowBeam || !this->begin(surface))
  {
    return false;
  }
  const BeamSurface& s = (*this->All)[surface];
  const double half = 0.5 * cell.width;
  const PlanePoint middle{ cell.x + half, cell.y + half };
  const double reach = half * (std::fabs(s.inverse.x) + std::fabs(s.inverse.y));
  const double inverse = s.inverse.at(middle);
  const double radius2 = middle.x * middle.x + middle.y * middle.y;
  const double secant2 = 1.0 + this->Tangent2 * radius2;
  const double secant = std::sqrt(secant2);
  const Strips& of = this->Of[surface];
  const double bend = this->Tangent2 * cell.width; // of the secant, more than its change
  const double first = of.numberAt((1.0 - bend) * secant / (inverse + reach), this->Gate, s.height);
  const double last = inverse > reach
    ? of.numberAt((1.0 + bend) * secant / (inverse - reach), this->Gate, s.height)
    : Infinity;
  const bool halves = s.other != NoTriangle;
  const double side = halves ? s.diagonal.at(middle) : 1.0;
  const double across = halves ? half * (std::fabs(s.diagonal.x) + std::fabs(s.diagonal.y)) : 0.0;
  if (first != last || std::fabs(side) <= across)
  {
    return false;
  }
  const double number = std::clamp(first - of.least, 0.0, of.count - 1.0);
  Strip& sum =
    this->sumOf(of.first + static_cast<std::uint32_t>(number) + (side < 0.0 ? of.count : 0u));
  const double weight = cell.area * this->ShareOfArea / (secant2 * secant);
  sum.weight += weight;
  sum.moment += weight * secant / inverse;
  return true;
}

/// Rays of a block of a cell: one in each of sixteen squares.
void BeamCells::place(const Cell& cell, int block, int blocks, CellRays& rays) const
{
  std::uint64_t hash = this->Beam + 1;
  for (const std::uint64_t number :
    { static_cast<std::uint64_t>(cell.column), static_cast<std::uint64_t>(cell.row),
      static_cast<std::uint64_t>(cell.level), static_cast<std::uint64_t>(block) })
  {
    hash = (hash ^ (hash >> 31)) * 0x9e3779b97f4a7c15u + number;
  }
  hash ^= hash >> 31;
  hash *= 0x94d049bb133111ebu;
  const double* const jitter = &this->Jitter[(hash >> 56) * 2 * CellLanes];
  const double spacing = cell.width / (4.0 * blocks);
  const double x0 = cell.x + 4.0 * spacing * (block % blocks);
  const double y0 = cell.y + 4.0 * spacing * (block / blocks);
  for (int i = 0; i < CellLanes; ++i)
  {
    rays.x[i] = static_cast<float>(x0 + spacing * ((i % 4) + jitter[i]));
    rays.y[i] = static_cast<float>(y0 + spacing * ((i / 4) + jitter[CellLanes + i]));
  }
}

namespace
{
bool isInDisc(const CellRays& rays, int i)
{
  const double x = rays.x[i];
  const double y = rays.y[i];
  return x * x + y * y <= 1.0;
}
}

void BeamCells::trace(const Cell& cell, List list, int blocks)
{
  const int count = blocks * blocks;
  double rays = CellLanes * count;
  CellRays block;
  if (cell.area < cell.width * cell.width)
  {
    rays = 0.0; // those inside share the cell's area in the disc
    for (int k = 0; k < count; ++k)
    {
      this->place(cell, k, blocks, block);
      for (int i = 0; i < CellLanes; ++i)
      {
        rays += isInDisc(block, i) ? 1.0 : 0.0;
      }
    }
    if (rays == 0.0)
    {
      return;
    }
  }
  for (int k = 0; k < count && !this->TooMany; ++k)
  {
    this->place(cell, k, blocks, block);
    see(this->Surfaces.data(), list.surfaces, list.count, block);
    this->add(block, cell.area / rays * this->ShareOfArea);
  }
}

double BeamCells::Strips::unitAt(double range, double gate) const
{
  return unitStrip(range, gate, this->perMetre, this->offsets[0], this->offsets[1]);
}

/// Number of the strip in which a range lies. @param height distance of the plane, m
double BeamCells::Strips::numberAt(double range, double gate, double height) const
{
  return this->unitAt(range, gate) + lobeStrip(sine2At(range, height));
}

/// Make room for the strips of a surface. @return false if there are too many
bool BeamCells::begin(std::uint32_t surface)
{
  Strips& strips = this->Of[surface];
  if (strips.count > 0)
  {
    return true;
  }
  const BeamSurface& s = (*this->All)[surface];
  const double slope = Root2 * s.inverse.slope();
  const double slowest = std::max(s.leastInverse, s.inverse.z - slope);
  const double fastest = std::min(s.mostInverse, s.inverse.z + slope);
  const double parts =
    std::clamp(std::ceil(this->UnitLength * fastest / MostOfRange), 1.0, MostParts);
  strips.perMetre = parts / this->UnitLength;
  strips.offsets[0] = beyondFloor(parts * this->Offset);
  strips.offsets[1] = beyondFloor(-parts * this->Offset);
  strips.least = strips.numberAt((1.0 - 1e-9) / fastest, this->Gate, s.height);
  const double last =
    strips.numberAt((1.0 + 1e-9) * std::sqrt(1.0 + this->Tangent2) / slowest, this->Gate, s.height);
  const double count = last - strips.least + 1.0;
  const double halves = s.other == NoTriangle ? 1.0 : 2.0;
  if (!(this->Used + halves * count <= MostStrips))
  {
    this->TooMany = true;
    return false;
  }
  strips.count = static_cast<std::uint32_t>(count);
  strips.first = this->Used;
  this->Used += static_cast<std::uint32_t>(halves * count);
  if (this->Sums.size() < this->Used)
  {
    this->Sums.resize(this->Used, Strip{ 0.0, 0.0, 0.0, 0 });
  }
  return true;
}

/// The sums of a strip.
BeamCells::Strip& BeamCells::sumOf(std::uint32_t key)
{
  Strip& sum = this->Sums[key];
  if (sum.beam != this->Number)
  {
    sum = { 0.0, 0.0, 0.0, this->Number };
    this->Touched.push_back(key);
  }
  return sum;
}

/// Sixteen rays that end: ranges, shares of the pulse, and the strips of their surfaces.
struct BeamCells::Block
{
  double x[CellLanes], y[CellLanes];
  double secant[CellLanes], weight[CellLanes];
  double range[CellLanes];
  double unit[CellLanes];  ///< strips between borders of units
  double strip[CellLanes]; ///< all strips, from the first of the surface on
  double side[CellLanes];  ///< below 0: the other half of a quadrilateral
};

namespace
{
AVIANLIDAR_MULTIVERSION void weigh(
  const double* x, const double* y, double tangent2, double share, double* secants, double* weights)
{
#pragma omp simd
  for (int i = 0; i < CellLanes; ++i)
  {
    const double radius2 = x[i] * x[i] + y[i] * y[i];
    const double secant2 = 1.0 + tangent2 * radius2;
    const double secant = std::sqrt(secant2);
    secants[i] = secant;
    weights[i] = radius2 <= 1.0 ? share / (secant2 * secant) : 0.0;
  }
}

/// What the strips of a surface depend on.
struct StripNumbers
{
  double gate, perMetre, one, two, height;
};

/// Ranges and strips of rays on one surface.
AVIANLIDAR_MULTIVERSION void findStrips(const double* x, const double* y, const double* secants,
  const PlaneLine& inverse, const PlaneLine& diagonal, const StripNumbers& numbers, double* ranges,
  double* units, double* strips, double* sides)
{
  const PlaneLine w = inverse;
  const PlaneLine d = diagonal;
  const StripNumbers s = numbers;
#pragma omp simd
  for (int i = 0; i < CellLanes; ++i)
  {
    const double range = secants[i] / ((w.x * x[i] + w.y * y[i]) + w.z);
    ranges[i] = range;
    const double unit = unitStrip(range, s.gate, s.perMetre, s.one, s.two);
    units[i] = unit;
    strips[i] = unit + lobeStrip(sine2At(range, s.height));
    sides[i] = (d.x * x[i] + d.y * y[i]) + d.z;
  }
}
}

/// Add sixteen rays to the strips that they meet. @param share of the pulse of each
void BeamCells::add(const CellRays& rays, double share)
{
  Block block;
  for (int i = 0; i < CellLanes; ++i)
  {
    block.x[i] = rays.x[i];
    block.y[i] = rays.y[i];
  }
  weigh(block.x, block.y, this->Tangent2, share, block.secant, block.weight);
  const Sensor& sensor = this->Setup.sensor;
  if (sensor.beamProfile == BeamProfile::Gaussian)
  {
    for (int i = 0; i < CellLanes; ++i)
    {
      const double radius2 = block.x[i] * block.x[i] + block.y[i] * block.y[i];
      block.weight[i] *=
        radius2 <= 1.0 ? rayDensity(sensor.beamProfile, sensor.halfBeamwidth, radius2) : 0.0;
    }
  }
  std::uint32_t left = (1u << CellLanes) - 1u;
  bool even = true;        // all in one strip
  double units[CellLanes]; // of each ray's own surface
  std::uint32_t keys[CellLanes];
  std::uint32_t met = 0;
  while (left != 0)
  {
    const std::int32_t surface = rays.seen[__builtin_ctz(left)];
    std::uint32_t own = 0;
    for (int i = 0; i < CellLanes; ++i)
    {
      own |= rays.seen[i] == surface ? 1u << i : 0u;
    }
    left &= ~own;
    if (surface < 0)
    {
      continue;
    }
    const auto number = static_cast<std::uint32_t>(surface);
    if (!this->begin(number))
    {
      return;
    }
    const BeamSurface& s = (*this->All)[number];
    const Strips& of = this->Of[number];
    findStrips(block.x, block.y, block.secant, s.inverse, s.diagonal,
      { this->Gate, of.perMetre, of.offsets[0], of.offsets[1], s.height }, block.range, block.unit,
      block.strip, block.side);
    const bool halves = s.other != NoTriangle;
    Strip* sum = nullptr;
    std::uint32_t last = 0;
    double weight = 0.0;
    double moment = 0.0;
    const auto flush = [&]()
    {
      if (sum)
      {
        sum->weight += weight;
        sum->moment += moment;
      }
      weight = moment = 0.0;
    };
    for (std::uint32_t rest = own; rest != 0; rest &= rest - 1)
    {
      const int i = __builtin_ctz(rest);
      if (!(block.weight[i] > 0.0))
      {
        continue;
      }
      const double strip = block.strip[i] - of.least;
      const std::uint32_t key = of.first +
        static_cast<std::uint32_t>(strip < 0.0 ? 0.0 : std::min(strip, of.count - 1.0)) +
        (halves && block.side[i] < 0.0 ? of.count : 0u);
      if (!sum || key != last)
      {
        flush();
        sum = &this->sumOf(key);
        last = key;
      }
      weight += block.weight[i];
      moment += block.weight[i] * block.range[i];
      keys[i] = key;
      units[i] = block.unit[i];
      met |= 1u << i;
    }
    flush();
  }
  if (met == 0)
  {
    return;
  }
  const std::uint32_t one = keys[__builtin_ctz(met)];
  for (int i = 0; i < CellLanes; ++i)
  {
    even = even && (met >> i & 1u) != 0u && keys[i] == one;
  }
  if (even)
  {
    return;
  }
  // Each ray and its two neighbours in a square of four: a stratum with two rays, twice. What moves
  // between strips of incidence stays in its unit.
  const auto differ = [&](int a, int b)
  { return (met >> b & 1u) == 0u || rays.seen[a] != rays.seen[b] || units[a] != units[b]; };
  for (std::uint32_t rest = met; rest != 0; rest &= rest - 1)
  {
    const int i = __builtin_ctz(rest);
    const int differing = (differ(i, i ^ 1) ? 1 : 0) + (differ(i, i ^ 4) ? 1 : 0);
    if (differing > 0)
    {
      this->Sums[keys[i]].variance += 0.5 * block.weight[i] * block.weight[i] * differing;
    }
  }
}

std::unique_ptr<CellSamples> BeamCells::collect()
{
  auto found = std::make_unique<CellSamples>();
  BeamSamples& samples = found->samples;
  std::sort(this->Touched.begin(), this->Touched.end());
  // Surfaces in the order of their strips.
  std::vector<std::uint32_t>& order = this->Visible;
  order.clear();
  for (std::uint32_t c = 0; c < this->Of.size(); ++c)
  {
    if (this->Of[c].count > 0)
    {
      order.push_back(c);
    }
  }
  std::sort(order.begin(), order.end(),
    [this](std::uint32_t a, std::uint32_t b) { return this->Of[a].first < this->Of[b].first; });
  const std::size_t count = this->Touched.size();
  samples.range.reserve(count);
  samples.cosine.reserve(count);
  samples.weight.reserve(count);
  found->variance.reserve(count);
  auto owner = order.begin();
  for (const std::uint32_t key : this->Touched)
  {
    while (owner + 1 != order.end() && this->Of[*(owner + 1)].first <= key)
    {
      ++owner;
    }
    const BeamSurface& c = (*this->All)[*owner];
    const Strips& strips = this->Of[*owner];
    const Strip& sum = this->Sums[key];
    const std::uint32_t triangle = key - strips.first >= strips.count ? c.other : c.triangle;
    const double range = std::max(c.height, sum.moment / sum.weight);
    samples.range.push_back(range);
    samples.cosine.push_back(std::min(1.0, c.height / range));
    samples.weight.push_back(sum.weight);
    found->variance.push_back(sum.variance);
    if (samples.surfaces.empty() || samples.surfaces.back().triangle != triangle)
    {
      samples.surfaces.push_back({ triangle, 0 });
    }
    samples.surfaces.back().end = static_cast<std::uint32_t>(samples.range.size());
    samples.nearest = std::min(samples.nearest, range);
    samples.farthest = std::max(samples.farthest, range);
  }
  return found;
}
}
