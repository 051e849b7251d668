// SPDX-License-Identifier: BSD-3-Clause
#include "BeamCells.h"

#include "KeySort.h"
#include "Multiversion.h"
#include "Random.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr std::size_t Patterns = 256; ///< of jitter

/// Strips no longer than this part of the range.
constexpr double MostOfRange = 0.02;
constexpr double MostParts = 1e6;

/// Most strips of a beam.
constexpr double MostStrips = 4e6;

/// Most levels of division: cells of small objects, and those about the middle of a lobe.
constexpr int MostLevels = 8;
constexpr int LevelsOfFoot = 5;

/// m up to which a cell with small objects gets more rays instead of being divided.
constexpr int MostBlocksOfCell = 3;

/// Most blocks of rays of a beam that are traced through the tree for the sake of small objects: so
/// many in any case, and so many times those of a beam without.
constexpr double MostPlannedBlocks = 20000.0;
constexpr double PlannedPerUsual = 4.0;

/// Squared sine of incidence below which strips are not divided further.
constexpr double LeastSine2 = 1e-8;

/// Half-beamwidth up to which the solid angle of a cell follows from its middle.
constexpr double NarrowBeam = 0.02;

/// Parts of a squared half-beamwidth in which the areas of objects are counted, and an area that
/// is larger than the disc's.
constexpr double PartsOfArea = 1099511627776.0; // 2^40
constexpr double LargeArea = 4.0;
constexpr std::uint64_t LargeParts = std::uint64_t(1) << 42;

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
  const auto sampleOf = [&](std::size_t s) { return shares.contribution(s); };
  const auto perWeight = [&](std::size_t s)
  { return shares.energies[s] / this->samples.weight[sampleOf(s)]; };
  auto surface = this->samples.surfaces.begin();
  double variance = 0.0;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t sample = sampleOf(s);
    if (sample >= this->samples.size())
    {
      break;
    }
    if (!(this->samples.weight[sample] > 0.0))
    {
      continue;
    }
    while (surface->end <= sample)
    {
      ++surface;
    }
    const double energy = perWeight(s);
    variance += energy * energy * this->variance[sample];
    if (s + 1 < shares.count && sampleOf(s + 1) < surface->end)
    {
      const double step = energy - perWeight(s + 1);
      variance += step * step * (this->moves[sample] + this->moves[sampleOf(s + 1)]);
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
  , Seen(*setup.tree)
{
  for (std::uint32_t side = 4; side <= 16; side *= 4)
  {
    for (std::uint32_t k = 0; k < side * side; ++k)
    {
      const double width = 2.0 / side;
      this->Areas.push_back(areaInDisc(width * (k % side) - 1.0, width * (k / side) - 1.0, width));
    }
  }
}

/// Area of a cell in the disc. All beams have the same cells, and few are smaller than these.
double BeamCells::areaOf(int level, std::uint32_t column, std::uint32_t row) const
{
  const std::uint32_t side = 1u << 2 * level;
  const double width = 2.0 / side;
  return level > 2 ? areaInDisc(width * column - 1.0, width * row - 1.0, width)
                   : this->Areas[(level == 1 ? 0 : 16) + row * side + column];
}

void BeamCells::begin(std::uint64_t beam, const BeamFrame& frame)
{
  this->Beam = beam;
  this->Frame = frame;
  this->Tangent2 = frame.tanHalf * frame.tanHalf;
  const double sine = std::sin(0.5 * this->Setup.sensor.halfBeamwidth);
  this->ShareOfArea = this->Tangent2 / (4.0 * Pi * sine * sine);
  this->Objects.clear();
  this->Levels.resize(MostLevels + 1);
  if (this->Jitter.empty())
  {
    this->Jitter.resize(Patterns * 2 * CellLanes);
    for (std::size_t i = 0; i < Patterns * CellLanes; ++i)
    {
      const auto u =
        uniformPair(this->Setup.settings.seed, i / CellLanes, i % CellLanes, RandomPurpose::Cells);
      const std::size_t lane = i % CellLanes;
      float* const block = &this->Jitter[i / CellLanes * 2 * CellLanes];
      block[lane] = static_cast<float>(lane % 4 + u[0]);
      block[CellLanes + lane] = static_cast<float>(lane / 4 + u[1]);
    }
  }
}

void BeamCells::beginStrips(const std::vector<const BeamSurface*>& surfaces)
{
  this->All = &surfaces;
  this->Of.assign(surfaces.size(), Strips());
  this->Sums.clear();
  this->Used = 0;
  this->TooMany = false;
  this->Visible.clear();
}

/// Objects come in stretches. Sums of integers do not depend on the order of the triangles.
void BeamCells::addToObject(int id, double area)
{
  if (this->Objects.empty() || id != this->Objects.back().first)
  {
    this->Objects.emplace_back(id, 0);
  }
  this->Objects.back().second +=
    area < LargeArea ? static_cast<std::uint64_t>(area * PartsOfArea) : LargeParts;
}

/// Sort the stretches, and make one of those of one object.
void BeamCells::sumObjects()
{
  std::sort(this->Objects.begin(), this->Objects.end(),
    [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t last = 0;
  for (std::size_t k = 1; k < this->Objects.size(); ++k)
  {
    if (this->Objects[k].first == this->Objects[last].first)
    {
      this->Objects[last].second += this->Objects[k].second;
    }
    else
    {
      this->Objects[++last] = this->Objects[k];
    }
  }
  this->Objects.resize(last + 1);
}

/// Share of the beam of an object, if it is small against the spacing of the rays; else 0.
float BeamCells::smallShareOf(int id) const
{
  const auto object = std::lower_bound(this->Objects.begin(), this->Objects.end(), id,
    [](const auto& one, int wanted) { return one.first < wanted; });
  const double area = static_cast<double>(object->second) / PartsOfArea;
  const double share = 0.5 * area / Pi; // a body has a front and a back
  const double rays = CellRaysPerRay * this->Setup.settings.raysPerBeam;
  return share > this->LeastShare && share * rays < RaysOnObject ? static_cast<float>(share) : 0.0f;
}

/// The surfaces in single precision. 1/z is scaled by its largest, so that it is a number in any
/// scene.
void BeamCells::setSurfaces()
{
  constexpr float outwards = 1.0f + 1e-6f;
  constexpr double rounding = 4e-7;
  this->HasFeet = false;
  this->HasObjects = false;
  this->Surfaces.resize(this->All->size());
  constexpr double least = 1e-30; // of the farthest, whatever lies at the apex
  const double scale = this->All->empty()
    ? 1.0
    : std::max(1.0 / this->All->front()->mostInverse, least / this->All->back()->mostInverse);
  const double perFoot = 1.0 / this->Tangent2;
  for (std::size_t k = 0; k < this->Surfaces.size(); ++k)
  {
    const BeamSurface& from = *(*this->All)[k];
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
    s.share = this->smallShareOf(this->Setup.objectIds[from.triangle]);
    this->HasObjects = this->HasObjects || s.share > 0.0f;
    const double x = perFoot * w.x / w.z;
    const double y = perFoot * w.y / w.z;
    const bool isIn = std::fabs(x) < 2.0 && std::fabs(y) < 2.0;
    s.foot[0] = isIn ? static_cast<float>(x) : Nowhere;
    s.foot[1] = isIn ? static_cast<float>(y) : Nowhere;
    this->HasFeet = this->HasFeet || isIn;
  }
}

/// Divide the whole disc.
void BeamCells::divideAll(bool plans)
{
  this->Plans = plans;
  this->Whole.resize(this->All->size());
  std::iota(this->Whole.begin(), this->Whole.end(), 0u);
  this->divide({ 0, 0, 0, 0.0f, -1.0, -1.0, 2.0, Pi },
    { this->Whole.data(), static_cast<std::uint32_t>(this->Whole.size()) });
}

std::unique_ptr<CellSamples> BeamCells::find(
  std::uint64_t beam, const BeamFrame& frame, const std::vector<const BeamSurface*>& entering)
{
  this->begin(beam, frame);
  this->beginStrips(entering);
  for (const BeamSurface* s : entering)
  {
    this->addToObject(this->Setup.objectIds[s->triangle], s->area);
  }
  this->sumObjects();
  this->setSurfaces();
  this->divideAll(false);
  return this->TooMany ? nullptr : this->collect();
}

/// Leave the triangles of small objects. An object's area is that of its triangles with a corner or
/// their centre in the disc: any tree hands them out.
void BeamCells::findSmallObjects(std::vector<std::uint32_t>& numbers)
{
  const auto idOf = [&](std::uint32_t triangle) { return this->Setup.objectIds[triangle]; };
  const double rays = CellRaysPerRay * this->Setup.settings.raysPerBeam;
  const auto large = static_cast<std::uint64_t>(4.0 * Pi * RaysOnObject / rays * PartsOfArea);
  for (const std::uint32_t number : numbers)
  {
    if (!this->Objects.empty() && this->Objects.back().first == idOf(number) &&
      this->Objects.back().second > large)
    {
      continue; // not small, whatever else it has
    }
    const Corners t = cornersFrom(*this->Setup.tree->mesh, number, this->Frame.origin);
    const Vec3 centre = (t.a + t.b + t.c) / 3.0;
    const auto isIn = [&](const Vec3& v) { return this->Frame.contains(v); };
    const double range2 = glm::dot(centre, centre);
    const double across = std::fabs(glm::dot(glm::cross(t.b - t.a, t.c - t.a), centre));
    const double area = 0.5 * across / (range2 * std::sqrt(range2) * this->Tangent2);
    this->addToObject(
      idOf(number), isIn(centre) || isIn(t.a) || isIn(t.b) || isIn(t.c) ? area : 0.0);
  }
  this->sumObjects();
  numbers.erase(std::remove_if(numbers.begin(), numbers.end(),
                  [&](std::uint32_t number) { return this->smallShareOf(idOf(number)) == 0.0f; }),
    numbers.end());
}

void BeamCells::leaveSmallObjects(
  std::uint64_t beam, const BeamFrame& frame, std::vector<std::uint32_t>& numbers)
{
  this->begin(beam, frame);
  this->findSmallObjects(numbers);
}

/// Place the rays. Where small objects ask for too many, the smallest are left to the others' rays.
void BeamCells::planAll()
{
  const double usual = CellRaysPerRay * this->Setup.settings.raysPerBeam / CellLanes;
  const double most = std::max(MostPlannedBlocks, PlannedPerUsual * usual);
  do
  {
    this->setSurfaces();
    this->Rays.x.clear();
    this->Rays.y.clear();
    this->Blocks.clear();
    this->Shares.clear();
    this->TooMany = false;
    this->MostBlocks = static_cast<std::size_t>(most);
    this->divideAll(true);
    this->LeastShare *= 4.0;
  } while (this->TooMany && this->HasObjects);
  this->LeastShare = LeastShareOfObject;
  this->TooMany = false;
}

const BeamRays& BeamCells::place(
  std::uint64_t beam, const BeamFrame& frame, std::vector<std::uint32_t>& numbers)
{
  this->leaveSmallObjects(beam, frame, numbers);
  this->Seen.begin(frame);
  this->Seen.add(numbers.data(), numbers.size());
  this->All = &this->Seen.sort();
  this->planAll();
  return this->Rays;
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

std::unique_ptr<CellSamples> BeamCells::find(const std::uint32_t* triangles)
{
  std::vector<std::uint64_t>& hits = this->Keys; // triangle and ray
  hits.clear();
  for (std::size_t i = 0; i < this->Rays.size(); ++i)
  {
    hits.push_back(keyAbove(triangles[i], i));
  }
  sortKeys(hits);
  std::vector<std::uint32_t>& seen = this->Whole;
  seen.clear();
  for (const std::uint64_t hit : hits)
  {
    if (keyOf(hit) != NoTriangle && (seen.empty() || seen.back() != keyOf(hit)))
    {
      seen.push_back(keyOf(hit));
    }
  }
  this->Seen.begin(this->Frame);
  this->Seen.add(seen.data(), seen.size());
  this->beginStrips(this->Seen.sort());
  this->Numbers.clear();
  for (std::size_t k = 0; k < this->All->size(); ++k)
  {
    const BeamSurface& s = *(*this->All)[k];
    this->Numbers.push_back(keyAbove(s.triangle, k));
    if (s.other != NoTriangle)
    {
      this->Numbers.push_back(keyAbove(s.other, k));
    }
  }
  sortKeys(this->Numbers);
  this->OfRays.assign(hits.size(), -1);
  auto known = this->Numbers.begin();
  for (const std::uint64_t hit : hits)
  {
    while (known != this->Numbers.end() && keyOf(*known) < keyOf(hit))
    {
      ++known;
    }
    if (known != this->Numbers.end() && keyOf(*known) == keyOf(hit))
    {
      this->OfRays[numberOf(hit)] = static_cast<std::int32_t>(numberOf(*known));
    }
  }
  const std::int32_t* ray = this->OfRays.data();
  for (std::size_t b = 0; b < this->Blocks.size() && !this->TooMany; ++b)
  {
    CellRays& block = this->Blocks[b];
    for (int i = 0; i < CellLanes; ++i)
    {
      block.seen[i] = isInDisc(block, i) ? *ray++ : -1;
    }
    this->add(block, this->Shares[b]);
  }
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
  double areas[CellLanes];
  for (std::uint32_t i = 0; i < CellLanes; ++i)
  {
    areas[i] = this->areaOf(cell.level + 1, 4 * cell.column + i % 4, 4 * cell.row + i / 4);
    children.occluders[i] = areas[i] > 0.0 ? cell.occluder : FloatInfinity;
    children.counts[i] = 0;
    children.lists[i] = level.numbers.data() + i * list.count;
  }
  distribute(this->Surfaces.data(), list.surfaces, list.count, children);
  for (std::uint32_t i = 0; i < CellLanes && !this->TooMany; ++i)
  {
    if (children.counts[i] > 0 || (this->Plans && areas[i] > 0.0))
    {
      this->solve(
        { cell.level + 1, 4 * cell.column + i % 4, 4 * cell.row + i / 4, children.occluders[i],
          cell.x + width * (i % 4), cell.y + width * (i / 4), width, areas[i] },
        { children.lists[i], children.counts[i] });
    }
  }
}

/// Find what a cell shows.
void BeamCells::solve(const Cell& cell, List list)
{
  if (!this->Plans && cell.occluder > 0.0f && list.count == 1 &&
    this->addWhole(cell, list.surfaces[0]))
  {
    return;
  }
  const int most = std::max(MostBlocksOfCell, this->Density.blocks);
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
  const BeamSurface& s = *(*this->All)[surface];
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

/// Rays of a block of a cell: one in each of sixteen squares. @param pull less than 1: towards the
/// corner that is nearest to the axis
void BeamCells::place(const Cell& cell, int block, int blocks, float pull, CellRays& rays) const
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
  const float* const jitter = &this->Jitter[(hash >> 56) * 2 * CellLanes];
  const auto spacing = static_cast<float>(cell.width / (4.0 * blocks));
  const auto x0 = static_cast<float>(cell.x + cell.width * (block % blocks) / blocks);
  const auto y0 = static_cast<float>(cell.y + cell.width * (block / blocks) / blocks);
  for (int i = 0; i < CellLanes; ++i)
  {
    rays.x[i] = x0 + spacing * jitter[i];
    rays.y[i] = y0 + spacing * jitter[CellLanes + i];
  }
  if (pull < 1.0f)
  {
    const double middle = 0.5 * cell.width; // no cell crosses an axis
    const auto x = static_cast<float>(cell.x + middle < 0.0 ? cell.x + cell.width : cell.x);
    const auto y = static_cast<float>(cell.y + middle < 0.0 ? cell.y + cell.width : cell.y);
    for (int i = 0; i < CellLanes; ++i)
    {
      rays.x[i] = x + pull * (rays.x[i] - x);
      rays.y[i] = y + pull * (rays.y[i] - y);
    }
  }
}

/// Keep a block whose rays are to be traced.
void BeamCells::plan(const CellRays& block, double share)
{
  if (this->HasObjects && this->Blocks.size() >= this->MostBlocks)
  {
    this->TooMany = true;
    return;
  }
  this->Blocks.push_back(block);
  this->Shares.push_back(share);
  for (int i = 0; i < CellLanes; ++i)
  {
    if (isInDisc(block, i))
    {
      this->Rays.x.push_back(block.x[i]);
      this->Rays.y.push_back(block.y[i]);
    }
  }
}

void BeamCells::trace(const Cell& cell, List list, int blocks)
{
  const int count = blocks * blocks;
  double rays = CellLanes * count;
  CellRays block;
  float pull = 1.0f;
  if (cell.area < cell.width * cell.width)
  {
    // Those inside share the cell's area in the disc. If there are none, they are drawn in.
    rays = 0.0;
    for (pull = 2.0f; rays == 0.0;)
    {
      pull *= 0.5f;
      for (int k = 0; k < count; ++k)
      {
        this->place(cell, k, blocks, pull, block);
        for (int i = 0; i < CellLanes; ++i)
        {
          rays += isInDisc(block, i) ? 1.0 : 0.0;
        }
      }
    }
  }
  for (int k = 0; k < count && !this->TooMany; ++k)
  {
    this->place(cell, k, blocks, pull, block);
    const double share = cell.area / rays * this->ShareOfArea;
    if (this->Plans)
    {
      this->plan(block, share);
      continue;
    }
    see(this->Surfaces.data(), list.surfaces, list.count, block);
    this->add(block, share);
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
  const BeamSurface& s = *(*this->All)[surface];
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
  this->Visible.push_back(surface);
  this->Places.resize(std::max<std::size_t>(this->Places.size(), this->Used));
  return true;
}

/// The sums of a strip.
inline BeamCells::Strip& BeamCells::sumOf(std::uint32_t key)
{
  std::uint32_t& place = this->Places[key]; // of an earlier beam, perhaps
  if (place >= this->Sums.size() || this->Sums[place].key != key)
  {
    place = static_cast<std::uint32_t>(this->Sums.size());
    this->Sums.push_back({ 0.0, 0.0, 0.0, 0.0, key });
  }
  return this->Sums[place];
}

namespace
{
/// Sixteen rays that end, and what they meet. Numbers are doubles for the sake of lanes.
struct Block
{
  double x[CellLanes], y[CellLanes];
  double secant[CellLanes], weight[CellLanes]; ///< 0 beyond the rim
  double surface[CellLanes];                   ///< -1: none
  double key[CellLanes];                       ///< of the strip; -1: none
  double unit[CellLanes];                      ///< the same for rays of one surface in one unit
  double moment[CellLanes];                    ///< weight times range
  double variance[2][CellLanes], moves[2][CellLanes]; ///< by each of two neighbours
};

AVIANLIDAR_MULTIVERSION void weigh(
  const CellRays& rays, double tangent2, double share, Block& block)
{
#pragma omp simd
  for (int i = 0; i < CellLanes; ++i)
  {
    block.x[i] = rays.x[i];
    block.y[i] = rays.y[i];
    block.surface[i] = rays.seen[i];
    const double radius2 = block.x[i] * block.x[i] + block.y[i] * block.y[i];
    const double secant2 = 1.0 + tangent2 * radius2;
    const double secant = std::sqrt(secant2);
    block.secant[i] = secant;
    block.weight[i] = radius2 <= 1.0 ? share / (secant2 * secant) : 0.0;
    block.key[i] = -1.0;
    block.unit[i] = -1.0;
  }
}

/// What the strips of a surface depend on.
struct SurfaceStrips
{
  double number; ///< of the surface
  PlaneLine inverse, diagonal;
  double gate, perMetre, one, two, height, least;
  double last;        ///< number of the last strip, from the first on
  double first, half; ///< keys of the first, and of the first of the other half from there on
};

/// Keys, units and moments of the rays that meet a surface.
AVIANLIDAR_MULTIVERSION void findStrips(const SurfaceStrips& surface, Block& block)
{
  const SurfaceStrips s = surface;
  constexpr double unitsOfSurface = 4294967296.0;
#pragma omp simd
  for (int i = 0; i < CellLanes; ++i)
  {
    const double x = block.x[i];
    const double y = block.y[i];
    const double range = block.secant[i] / ((s.inverse.x * x + s.inverse.y * y) + s.inverse.z);
    const double unit = unitStrip(range, s.gate, s.perMetre, s.one, s.two);
    const double strip = unit + lobeStrip(sine2At(range, s.height)) - s.least;
    const double low = strip < 0.0 ? 0.0 : strip;
    const double side = (s.diagonal.x * x + s.diagonal.y * y) + s.diagonal.z;
    const double key = (low < s.last ? low : s.last) + (side < 0.0 ? s.half : 0.0) + s.first;
    const double own = block.surface[i] == s.number ? block.weight[i] : 0.0;
    block.key[i] = own > 0.0 ? key : block.key[i];
    block.unit[i] = own > 0.0 ? unitsOfSurface * s.number + unit : block.unit[i];
    block.moment[i] = own > 0.0 ? own * range : block.moment[i];
  }
}

/// Whether all meet one strip, or nothing. If not, how each ray differs from its two neighbours in
/// a square of four: a stratum with two rays, twice. Nothing is beyond the rim.
AVIANLIDAR_MULTIVERSION bool findDifferences(Block& block)
{
  int others = 0;
#pragma omp simd reduction(+ : others)
  for (int i = 0; i < CellLanes; ++i)
  {
    others += block.key[i] != block.key[0] ? 1 : 0;
  }
  if (others == 0)
  {
    return false;
  }
  for (int n = 0; n < 2; ++n)
  {
    const int step = n == 0 ? 1 : 4;
    double weight[CellLanes], unit[CellLanes], key[CellLanes];
    for (int i = 0; i < CellLanes; ++i)
    {
      weight[i] = block.weight[i ^ step];
      unit[i] = block.unit[i ^ step];
      key[i] = block.key[i ^ step];
    }
#pragma omp simd
    for (int i = 0; i < CellLanes; ++i)
    {
      const double square = weight[i] > 0.0 ? 0.5 * block.weight[i] * block.weight[i] : 0.0;
      const bool apart = block.unit[i] != unit[i];
      block.variance[n][i] = apart ? square : 0.0;
      block.moves[n][i] = !apart && block.key[i] != key[i] ? square : 0.0;
    }
  }
  return true;
}

/// The sum of sixteen, in an order that does not depend on the width of lanes.
double sumOf(const double* values)
{
  double part[CellLanes];
  std::copy(values, values + CellLanes, part);
  for (int half = CellLanes / 2; half > 0; half /= 2)
  {
    for (int i = 0; i < half; ++i)
    {
      part[i] += part[i + half];
    }
  }
  return part[0];
}
}

/// Add sixteen rays to the strips that they meet. @param share of the pulse of each
void BeamCells::add(const CellRays& rays, double share)
{
  Block block;
  weigh(rays, this->Tangent2, share, block);
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
  std::int32_t last = -1;
  for (int i = 0; i < CellLanes; ++i)
  {
    if (rays.seen[i] == last || block.key[i] >= 0.0 || !(block.weight[i] > 0.0))
    {
      continue;
    }
    last = rays.seen[i];
    if (last < 0)
    {
      continue;
    }
    const auto number = static_cast<std::uint32_t>(last);
    if (!this->begin(number))
    {
      return;
    }
    const BeamSurface& s = *(*this->All)[number];
    const Strips& of = this->Of[number];
    findStrips({ block.surface[i], s.inverse, s.diagonal, this->Gate, of.perMetre, of.offsets[0],
                 of.offsets[1], s.height, of.least, of.count - 1.0, static_cast<double>(of.first),
                 s.other == NoTriangle ? 0.0 : static_cast<double>(of.count) },
      block);
  }
  if (!findDifferences(block))
  {
    if (block.key[0] >= 0.0)
    {
      Strip& sum = this->sumOf(static_cast<std::uint32_t>(block.key[0]));
      sum.weight += avianlidar::sumOf(block.weight);
      sum.moment += avianlidar::sumOf(block.moment);
    }
    return;
  }
  for (int i = 0; i < CellLanes; ++i)
  {
    if (block.key[i] >= 0.0)
    {
      Strip& sum = this->sumOf(static_cast<std::uint32_t>(block.key[i]));
      sum.weight += block.weight[i];
      sum.moment += block.moment[i];
      sum.variance = sum.variance + block.variance[0][i] + block.variance[1][i];
      sum.moves = sum.moves + block.moves[0][i] + block.moves[1][i];
    }
  }
}

std::unique_ptr<CellSamples> BeamCells::collect()
{
  auto found = std::make_unique<CellSamples>();
  BeamSamples& samples = found->samples;
  const std::size_t count = this->Sums.size();
  samples.range.resize(count);
  samples.cosine.resize(count);
  samples.weight.resize(count);
  found->variance.resize(count);
  found->moves.resize(count);
  this->Keys.clear();
  for (std::size_t k = 0; k < count; ++k)
  {
    this->Keys.push_back(keyAbove(this->Sums[k].key, k));
  }
  sortKeys(this->Keys);
  std::size_t k = 0;
  const auto add = [&](std::uint32_t triangle, double height, std::uint32_t end)
  {
    const std::size_t before = k;
    for (; k < count && keyOf(this->Keys[k]) < end; ++k)
    {
      const Strip& sum = this->Sums[numberOf(this->Keys[k])];
      const double range = std::max(height, sum.moment / sum.weight);
      samples.range[k] = range;
      samples.cosine[k] = std::min(1.0, height / range);
      samples.weight[k] = sum.weight;
      found->variance[k] = sum.variance;
      found->moves[k] = sum.moves;
      samples.nearest = std::min(samples.nearest, range);
      samples.farthest = std::max(samples.farthest, range);
    }
    if (k > before)
    {
      samples.surfaces.push_back({ triangle, static_cast<std::uint32_t>(k) });
    }
  };
  for (const std::uint32_t number : this->Visible)
  {
    const BeamSurface& s = *(*this->All)[number];
    const Strips& of = this->Of[number];
    add(s.triangle, s.height, of.first + of.count);
    if (s.other != NoTriangle)
    {
      add(s.other, s.height, of.first + 2 * of.count);
    }
  }
  return found;
}
}
