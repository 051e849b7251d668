// SPDX-License-Identifier: BSD-3-Clause
#include "BeamCells.h"

#include "BeamRays.h"
#include "Multiversion.h"
#include "Random.h"
#include "Reflectance.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
constexpr int Lanes = 16;
}

/// Sixteen rays, and what they have met so far.
struct RayBlock
{
  double x[Lanes], y[Lanes];
  double inverse[Lanes]; ///< 1/z of the nearest surface, 1/m
  double seen[Lanes];    ///< its place in the list; -1: none
  double other[Lanes];   ///< below 0: the other half of a quadrilateral
};

namespace
{
constexpr std::uint32_t Sky = 0xffffffffu;
constexpr std::size_t Patterns = 256; ///< of jitter

/// Half the side of the square about the disc: no ray of its rim is lost to rounding.
constexpr double HalfSquare = 1.0;

/// Strips no longer than this part of the range.
constexpr double MostOfRange = 0.02;
constexpr double MostParts = 64.0;

/// Most strips of a beam.
constexpr double MostStrips = 4e6;

/// No more levels for small objects than these beyond the usual.
constexpr int MostLevels = 8;

/// m up to which a cell with small objects gets more rays instead of being divided.
constexpr int MostBlocks = 3;

/// Less than 1 by more than rounding.
constexpr double Unhidden = 1.0 - 1e-12;

/// Squared sine of incidence below which strips are not divided further.
constexpr double LeastSine2 = 1e-8;

/// A lobe whose radius is a smaller part of the beam's is sharp, where it is not beyond this
/// exponent.
constexpr double SharpLobe = 0.25;
constexpr double NothingOfLobe = 30.0;

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
  return areaInQuadrant(x0, x0 + width, y0, y0 + width);
}

/// What sixteen children of a cell see of a triangle.
struct ChildTest
{
  double kept[Lanes];    ///< 1: it may be seen there
  double covered[Lanes]; ///< 1/z, 1/m, of its farthest point, where it covers the child; else 0
};

AVIANLIDAR_MULTIVERSION void testChildren(const PolygonCandidate& candidate, double x0, double y0,
  double width, const double* occluders, ChildTest& result)
{
  const PolygonCandidate& c = candidate;
  const double half = 0.5 * width;
  double kept[Lanes];
  double covered[Lanes];
  double x[Lanes];
  double y[Lanes];
#pragma omp simd
  for (int i = 0; i < Lanes; ++i)
  {
    x[i] = x0 + width * ((i % 4) + 0.5);
    y[i] = y0 + width * ((i / 4) + 0.5);
    kept[i] = 1.0;
    covered[i] = 1.0;
  }
  for (int k = 0; k < c.count; ++k)
  {
    const double a = c.lines[k].x;
    const double b = c.lines[k].y;
    const double d = c.lines[k].z;
    const double reach = half * (std::fabs(a) + std::fabs(b));
#pragma omp simd
    for (int i = 0; i < Lanes; ++i)
    {
      const double side = (a * x[i] + b * y[i]) + d;
      kept[i] = side > -reach ? kept[i] : 0.0;
      covered[i] = side >= reach ? covered[i] : 0.0;
    }
  }
  const double a = c.inverse.x;
  const double b = c.inverse.y;
  const double d = c.inverse.z;
  const double most = c.mostInverse;
  const double reach = half * (std::fabs(a) + std::fabs(b));
#pragma omp simd
  for (int i = 0; i < Lanes; ++i)
  {
    const double middle = (a * x[i] + b * y[i]) + d;
    const double near = middle + reach < most ? middle + reach : most;
    const double far = middle - reach;
    result.kept[i] = near > 0.0 && near >= occluders[i] ? kept[i] : 0.0;
    // Rounding must not hide a surface behind itself.
    const double farthest = Unhidden * (far < near ? far : near);
    result.covered[i] = far > 0.0 && covered[i] > 0.0 ? farthest : 0.0;
  }
}

AVIANLIDAR_MULTIVERSION void testRays(
  const PolygonCandidate& candidate, double number, RayBlock& rays)
{
  const PolygonCandidate& c = candidate;
  double inside[Lanes];
#pragma omp simd
  for (int i = 0; i < Lanes; ++i)
  {
    const double w = (c.inverse.x * rays.x[i] + c.inverse.y * rays.y[i]) + c.inverse.z;
    inside[i] = w > rays.inverse[i] ? w : 0.0;
  }
  for (int k = 0; k < c.count; ++k)
  {
    const double a = c.lines[k].x;
    const double b = c.lines[k].y;
    const double d = c.lines[k].z;
#pragma omp simd
    for (int i = 0; i < Lanes; ++i)
    {
      inside[i] = (a * rays.x[i] + b * rays.y[i]) + d >= 0.0 ? inside[i] : 0.0;
    }
  }
  const double a = c.diagonal.x;
  const double b = c.diagonal.y;
  const double d = c.diagonal.z;
#pragma omp simd
  for (int i = 0; i < Lanes; ++i)
  {
    const double half = (a * rays.x[i] + b * rays.y[i]) + d;
    rays.seen[i] = inside[i] > 0.0 ? number : rays.seen[i];
    rays.other[i] = inside[i] > 0.0 ? half : rays.other[i];
    rays.inverse[i] = inside[i] > 0.0 ? inside[i] : rays.inverse[i];
  }
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

/// Sixteen rays at the end: strips' numbers, ranges, shares of the pulse.
struct RayResults
{
  double perMetre[Lanes], one[Lanes], two[Lanes], height[Lanes];
  double range[Lanes], weight[Lanes];
  double unit[Lanes], strip[Lanes]; ///< strips between borders of units, and all
};

AVIANLIDAR_MULTIVERSION void finishRays(
  const RayBlock& rays, double tangent2, double share, double gate, RayResults& results)
{
#pragma omp simd
  for (int i = 0; i < Lanes; ++i)
  {
    const double radius2 = rays.x[i] * rays.x[i] + rays.y[i] * rays.y[i];
    const double secant2 = 1.0 + tangent2 * radius2;
    const double secant = std::sqrt(secant2);
    const double range = secant / rays.inverse[i];
    results.range[i] = range;
    results.weight[i] = radius2 <= 1.0 ? share / (secant2 * secant) : 0.0;
    results.unit[i] = unitStrip(range, gate, results.perMetre[i], results.one[i], results.two[i]);
    results.strip[i] = results.unit[i] + lobeStrip(sine2At(range, results.height[i]));
  }
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

bool usesCells(const EchoSettings& settings)
{
  return settings.beamSamples == BeamSampleSource::Cells;
}

CellDensity densityOfCells(int raysPerBeam)
{
  // 16 and 256 cells fill the square, of which the disc is pi/4. A second level is worth its lists
  // from about 1,000 rays on.
  constexpr double many = 1000.0;
  const double rays = CellRaysPerRay * raysPerBeam;
  const int levels = rays < many ? 1 : 2;
  const double least = 0.25 * Pi * Lanes * (levels == 1 ? 16.0 : 256.0);
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

/// The objects that are small against the spacing of the rays, by candidate.
void BeamCells::findObjects()
{
  this->ShareOfObject.assign(this->All->size(), 0.0);
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
      for (std::size_t k = first; k < end; ++k)
      {
        this->ShareOfObject[this->Objects[k].second] = share;
      }
    }
  }
}

std::unique_ptr<CellSamples> BeamCells::find(
  std::uint64_t beam, const BeamFrame& frame, const std::vector<PolygonCandidate>& candidates)
{
  if (candidates.size() > MostTrianglesOfCells)
  {
    return nullptr;
  }
  if (this->Jitter.empty())
  {
    this->Jitter.resize(Patterns * 2 * Lanes);
    for (std::size_t i = 0; i < Patterns * Lanes; ++i)
    {
      const auto u =
        uniformPair(this->Setup.settings.seed, i / Lanes, i % Lanes, RandomPurpose::Cells);
      this->Jitter[i / Lanes * 2 * Lanes + i % Lanes] = u[0];
      this->Jitter[i / Lanes * 2 * Lanes + Lanes + i % Lanes] = u[1];
    }
  }
  this->Beam = beam;
  this->All = &candidates;
  this->Tangent2 = frame.tanHalf * frame.tanHalf;
  const double sine = std::sin(0.5 * this->Setup.sensor.halfBeamwidth);
  this->ShareOfArea = this->Tangent2 / (4.0 * Pi * sine * sine);
  this->findObjects();
  this->Of.assign(candidates.size(), Strips());
  ++this->Number;
  this->Used = 0;
  this->TooMany = false;
  this->Touched.clear();
  this->Visible.clear();
  this->Levels.resize(MostLevels + 1);
  std::vector<std::uint32_t> all(candidates.size());
  std::iota(all.begin(), all.end(), 0u);
  this->divide({ -HalfSquare, -HalfSquare, 2.0 * HalfSquare, 0.0, 0 }, all);
  return this->TooMany ? nullptr : this->collect();
}

/// m for a cell: as for all, or so that enough rays fall on each small object in it.
int BeamCells::blocksFor(const Cell& cell, const std::vector<std::uint32_t>& list) const
{
  double smallest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t c : list)
  {
    const double share = this->ShareOfObject[c];
    smallest = share > 0.0 && share < smallest ? share : smallest;
  }
  const double rays = RaysOnObject * cell.width * cell.width * this->ShareOfArea / smallest;
  return std::max(this->Density.blocks, static_cast<int>(std::ceil(std::sqrt(rays / Lanes))));
}

void BeamCells::divide(const Cell& cell, const std::vector<std::uint32_t>& list)
{
  Level& level = this->Levels[cell.level];
  std::fill(level.occluders, level.occluders + Lanes, cell.occluder);
  for (std::vector<std::uint32_t>& one : level.lists)
  {
    one.clear();
  }
  const double width = 0.25 * cell.width;
  ChildTest test;
  for (const std::uint32_t c : list)
  {
    testChildren((*this->All)[c], cell.x, cell.y, width, level.occluders, test);
    for (int i = 0; i < Lanes; ++i)
    {
      if (test.kept[i] != 0.0)
      {
        level.lists[i].push_back(c);
        level.occluders[i] = std::max(level.occluders[i], test.covered[i]);
      }
    }
  }
  for (int i = 0; i < Lanes && !this->TooMany; ++i)
  {
    const Cell child{ cell.x + width * (i % 4), cell.y + width * (i / 4), width, level.occluders[i],
      cell.level + 1 };
    if (level.lists[i].empty() || !(areaInDisc(child.x, child.y, width) > 0.0))
    {
      continue;
    }
    // Lists of this level are of no use to the levels below: theirs are their own.
    const int blocks = this->blocksFor(child, level.lists[i]);
    const bool divides = child.level < this->Density.levels ||
      (child.level < MostLevels && blocks > std::max(MostBlocks, this->Density.blocks));
    divides ? this->divide(child, level.lists[i]) : this->trace(child, level.lists[i], blocks);
  }
}

void BeamCells::trace(const Cell& cell, const std::vector<std::uint32_t>& list, int blocks)
{
  const int m = std::min(blocks, std::max(MostBlocks, this->Density.blocks));
  const double spacing = cell.width / (4.0 * m);
  const double area = areaInDisc(cell.x, cell.y, cell.width);
  const bool rim = area < cell.width * cell.width * (1.0 - 1e-12);
  const auto place = [&](int block, RayBlock& rays)
  {
    std::uint64_t hash = this->Beam + 1;
    for (const std::uint64_t number :
      { static_cast<std::uint64_t>((cell.x + HalfSquare) / cell.width),
        static_cast<std::uint64_t>((cell.y + HalfSquare) / cell.width),
        static_cast<std::uint64_t>(cell.level), static_cast<std::uint64_t>(block) })
    {
      hash = (hash ^ (hash >> 31)) * 0x9e3779b97f4a7c15u + number;
    }
    hash ^= hash >> 31;
    hash *= 0x94d049bb133111ebu;
    const double* const jitter = &this->Jitter[(hash >> 56) * 2 * Lanes];
    const double x0 = cell.x + 4.0 * spacing * (block % m);
    const double y0 = cell.y + 4.0 * spacing * (block / m);
    for (int i = 0; i < Lanes; ++i)
    {
      rays.x[i] = x0 + spacing * ((i % 4) + jitter[i]);
      rays.y[i] = y0 + spacing * ((i / 4) + jitter[Lanes + i]);
    }
  };
  RayBlock rays;
  double perRay = spacing * spacing;
  if (rim)
  {
    int inside = 0;
    for (int block = 0; block < m * m; ++block)
    {
      place(block, rays);
      for (int i = 0; i < Lanes; ++i)
      {
        inside += rays.x[i] * rays.x[i] + rays.y[i] * rays.y[i] <= 1.0 ? 1 : 0;
      }
    }
    if (inside == 0)
    {
      return;
    }
    perRay = area / inside;
  }
  for (int block = 0; block < m * m; ++block)
  {
    place(block, rays);
    for (int i = 0; i < Lanes; ++i)
    {
      rays.inverse[i] = 0.0;
      rays.seen[i] = -1.0;
      rays.other[i] = 0.0;
    }
    for (const std::uint32_t c : list)
    {
      testRays((*this->All)[c], c, rays);
    }
    this->add(rays, perRay * this->ShareOfArea);
  }
}

/// Make room for the strips of a candidate. @return false if there are too many
bool BeamCells::place(std::uint32_t candidate)
{
  const PolygonCandidate& c = (*this->All)[candidate];
  Strips& strips = this->Of[candidate];
  const double root2 = std::sqrt(2.0);
  const double slope = root2 * c.inverse.slope();
  const double slowest = std::max(c.leastInverse, c.inverse.z - slope);
  const double fastest = std::min(c.mostInverse, c.inverse.z + slope);
  const double parts =
    std::clamp(std::ceil(this->UnitLength * fastest / MostOfRange), 1.0, MostParts);
  strips.perMetre = parts / this->UnitLength;
  strips.offsets[0] = beyondFloor(parts * this->Offset);
  strips.offsets[1] = beyondFloor(-parts * this->Offset);
  strips.height = c.height;
  const auto at = [&](double range)
  {
    return unitStrip(range, this->Gate, strips.perMetre, strips.offsets[0], strips.offsets[1]) +
      lobeStrip(sine2At(range, c.height));
  };
  strips.least = at((1.0 - 1e-9) / fastest);
  const double last = at((1.0 + 1e-9) * std::sqrt(1.0 + this->Tangent2) / slowest);
  const double count = last - strips.least + 1.0;
  const double halves = c.other == NoTriangle ? 1.0 : 2.0;
  if (!(this->Used + halves * count <= MostStrips))
  {
    this->TooMany = true;
    return false;
  }
  strips.count = static_cast<std::uint32_t>(count);
  strips.first = this->Used;
  strips.halves = c.other != NoTriangle;
  this->Used += static_cast<std::uint32_t>(halves * count);
  if (this->Sums.size() < this->Used)
  {
    this->Sums.resize(this->Used, Strip{ 0.0, 0.0, 0.0, 0 });
  }
  return true;
}

/// Add sixteen rays to the strips that they meet. @param share of the pulse of each
void BeamCells::add(RayBlock& rays, double share)
{
  RayResults results;
  const Strips* strips[Lanes];
  for (int i = 0; i < Lanes; ++i)
  {
    strips[i] = nullptr;
    results.perMetre[i] = results.one[i] = results.two[i] = results.height[i] = 0.0;
    if (rays.seen[i] >= 0.0)
    {
      const auto candidate = static_cast<std::uint32_t>(rays.seen[i]);
      Strips& of = this->Of[candidate];
      if (of.count == 0 && !this->place(candidate))
      {
        return;
      }
      strips[i] = &of;
      results.perMetre[i] = of.perMetre;
      results.one[i] = of.offsets[0];
      results.two[i] = of.offsets[1];
      results.height[i] = of.height;
    }
    else
    {
      rays.inverse[i] = 1.0; // sky: any number will do
    }
  }
  finishRays(rays, this->Tangent2, share, this->Gate, results);
  const Sensor& sensor = this->Setup.sensor;
  if (sensor.beamProfile == BeamProfile::Gaussian)
  {
    for (int i = 0; i < Lanes; ++i)
    {
      const double radius2 = rays.x[i] * rays.x[i] + rays.y[i] * rays.y[i];
      results.weight[i] *=
        radius2 <= 1.0 ? rayDensity(sensor.beamProfile, sensor.halfBeamwidth, radius2) : 0.0;
    }
  }
  const double* const weight = results.weight;
  std::uint32_t keys[Lanes];
  bool same = true;
  for (int i = 0; i < Lanes; ++i)
  {
    keys[i] = Sky;
    if (strips[i] && weight[i] > 0.0)
    {
      const Strips& of = *strips[i];
      const double number = results.strip[i] - of.least;
      const double last = of.count - 1.0;
      const auto strip = static_cast<std::uint32_t>(number < 0.0 ? 0.0 : std::min(number, last));
      keys[i] = of.first + strip + (rays.other[i] < 0.0 && of.halves ? of.count : 0u);
    }
    same = same && keys[i] == keys[0];
  }
  for (int i = 0; i < Lanes; ++i)
  {
    if (keys[i] != Sky)
    {
      Strip& sum = this->Sums[keys[i]];
      if (sum.beam != this->Number)
      {
        sum = { 0.0, 0.0, 0.0, this->Number };
        this->Touched.push_back(keys[i]);
      }
      sum.weight += weight[i];
      sum.moment += weight[i] * results.range[i];
    }
  }
  if (same)
  {
    return;
  }
  // Each ray and its two neighbours in a square of four: a stratum with two rays, twice. What moves
  // between strips of incidence stays in its unit.
  const auto differ = [&](int a, int b)
  { return strips[a] != strips[b] || results.unit[a] != results.unit[b] || !(weight[b] > 0.0); };
  for (int i = 0; i < Lanes; ++i)
  {
    if (keys[i] != Sky)
    {
      const int differing = (differ(i, i ^ 1) ? 1 : 0) + (differ(i, i ^ 4) ? 1 : 0);
      this->Sums[keys[i]].variance += 0.5 * weight[i] * weight[i] * differing;
    }
  }
}

bool BeamCells::meet(const BeamRays& rays, std::vector<std::uint32_t>& triangles)
{
  triangles.assign(rays.size(), NoTriangle);
  bool any = false;
  for (std::size_t first = 0; first < rays.size(); first += Lanes)
  {
    const std::size_t count = std::min<std::size_t>(Lanes, rays.size() - first);
    RayBlock block;
    for (int i = 0; i < Lanes; ++i)
    {
      const std::size_t ray = first + std::min<std::size_t>(i, count - 1);
      block.x[i] = rays.x[ray];
      block.y[i] = rays.y[ray];
      block.inverse[i] = 0.0;
      block.seen[i] = -1.0;
      block.other[i] = 0.0;
    }
    for (const std::uint32_t c : this->Visible)
    {
      testRays((*this->All)[c], c, block);
    }
    for (std::size_t i = 0; i < count; ++i)
    {
      if (block.seen[i] >= 0.0)
      {
        const PolygonCandidate& c = (*this->All)[static_cast<std::uint32_t>(block.seen[i])];
        triangles[first + i] = block.other[i] < 0.0 && c.other != NoTriangle ? c.other : c.triangle;
        any = true;
      }
    }
  }
  return any;
}

std::unique_ptr<CellSamples> BeamCells::collect()
{
  auto found = std::make_unique<CellSamples>();
  BeamSamples& samples = found->samples;
  std::sort(this->Touched.begin(), this->Touched.end());
  // Candidates in the order of their strips.
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
    const PolygonCandidate& c = (*this->All)[*owner];
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

bool BeamCells::isSharp(const CellSamples& cells) const
{
  const BeamSamples& samples = cells.samples;
  const double tangent = std::tan(this->Setup.sensor.halfBeamwidth);
  bool sharp = false;
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      const double width2 = lobeWidth2(this->Setup.materials[triangle]);
      if (!(width2 > 0.0 && width2 < SharpLobe * SharpLobe * tangent * tangent))
      {
        return;
      }
      for (std::uint32_t i = begin; i < end && !sharp; ++i)
      {
        const double cosine = samples.cosine[i];
        const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
        const double nearest = std::max(0.0, sine - tangent);
        sharp = nearest * nearest < NothingOfLobe * width2;
      }
    });
  return sharp;
}
}
