// SPDX-License-Identifier: BSD-3-Clause
#include "RangeStrips.h"

#include "KeySort.h"
#include "Multiversion.h"
#include "ScanAir.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace avianlidar
{
namespace
{
constexpr double MostParts = 1e6;

/// Largest number of strips of a beam.
constexpr double MostStrips = 4e6;

constexpr std::uint32_t None = 0xffffffffu;

/// Squared sine of incidence below which strips are not divided further.
constexpr double LeastSine2 = 1e-8;

/// Half-beamwidth, rad, up to which the middle of a cell gives its solid angle.
constexpr double NarrowBeam = 0.02;

/// floor() for lanes, of magnitudes below 2^51.
AVIANLIDAR_ALWAYS_INLINE double whole(double x)
{
  const double rounded = (x + 0x1.8p52) - 0x1.8p52;
  return rounded > x ? rounded - 1.0 : rounded;
}

/// Number of the strip in which a range lies, between borders of units of both kinds.
AVIANLIDAR_ALWAYS_INLINE double unitStrip(const SurfaceStrips& s, double range)
{
  const double units = (range < s.gate ? range : s.gate) * s.perMetre;
  return whole(units - s.one) + whole(units - s.two);
}

/// Number of the strip of incidence in which a range lies. There are sixteen strips for each
/// doubling of the squared sine, from LeastSine2 on.
AVIANLIDAR_ALWAYS_INLINE double lobeStrip(const SurfaceStrips& s, double range)
{
  const double cosine = s.height / range;
  const double sine2 = cosine < 1.0 ? (1.0 - cosine) * (1.0 + cosine) : 0.0;
  const auto value = static_cast<float>(sine2 + LeastSine2);
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return static_cast<double>(bits >> 19);
}

double numberAt(const SurfaceStrips& s, double range)
{
  return unitStrip(s, range) + lobeStrip(s, range);
}

/// Sixteen rays, and the surfaces that they meet. Integers are doubles for SIMD lanes.
struct Block
{
  double x[CellLanes], y[CellLanes];
  double secant[CellLanes], weight[CellLanes]; ///< secants and weights; weight 0 outside the beam
  double surface[CellLanes];                   ///< number of the surface; -1: none
  double key[CellLanes];                       ///< key of the strip; -1: none
  double unit[CellLanes];   ///< number that rays of one surface between the same borders share
  double moment[CellLanes]; ///< weight times range
  double variance[2][CellLanes], moves[2][CellLanes]; ///< variances and movable parts by neighbour
  int lone;                                           ///< number of rays without a neighbour
};

/// Scales and outline of the beam's plane.
struct PlaneScales
{
  double tangent2, flatness2; ///< BeamFrame::tanHalf squared, and flatness2
  double most;                ///< largest |x| and |y|
  bool isRound;
};

AVIANLIDAR_MULTIVERSION void weigh(
  const CellRays& rays, const PlaneScales& scales, double share, Block& block)
{
  const PlaneScales s = scales;
#pragma omp simd
  for (int i = 0; i < CellLanes; ++i)
  {
    block.x[i] = rays.x[i];
    block.y[i] = rays.y[i];
    block.surface[i] = rays.seen[i];
    const double x2 = block.x[i] * block.x[i];
    const double y2 = block.y[i] * block.y[i];
    const double secant2 = 1.0 + s.tangent2 * (x2 + s.flatness2 * y2);
    const double secant = std::sqrt(secant2);
    const bool isIn =
      (x2 + y2 <= 1.0) & (std::fabs(block.x[i]) <= s.most) & (std::fabs(block.y[i]) <= s.most);
    block.secant[i] = secant;
    block.weight[i] = isIn ? share / (s.isRound ? secant2 * secant : 1.0) : 0.0;
    block.key[i] = -1.0;
    block.unit[i] = -1.0;
  }
}

/// Set keys, units and moments of the rays that meet a surface.
AVIANLIDAR_MULTIVERSION void findStrips(const SurfaceStrips& surface, Block& block)
{
  const SurfaceStrips s = surface;
  const double last = s.count - 1.0;
  constexpr double unitsOfSurface = 4294967296.0;
#pragma omp simd
  for (int i = 0; i < CellLanes; ++i)
  {
    const PlanePoint p{ block.x[i], block.y[i] };
    const double range = block.secant[i] / s.inverse.at(p);
    const double unit = unitStrip(s, range);
    const double strip = unit + lobeStrip(s, range) - s.least;
    const double low = strip < 0.0 ? 0.0 : strip;
    const double half = s.diagonal.at(p) < 0.0 ? s.count : 0.0;
    const double key = (low < last ? low : last) + half + s.first;
    const double own = block.surface[i] == s.number ? block.weight[i] : 0.0;
    block.key[i] = own > 0.0 ? key : block.key[i];
    block.unit[i] = own > 0.0 ? unitsOfSurface * s.number + unit : block.unit[i];
    block.moment[i] = own > 0.0 ? own * range : block.moment[i];
  }
}

/// Set how each ray differs from its two neighbours. Four rays in a square are two strata of two
/// rays. If one neighbour lies outside of the beam, the other neighbour counts twice. @return
/// false, with nothing set, if the weights are even and all rays meet one strip or all rays meet
/// nothing
AVIANLIDAR_MULTIVERSION bool findDifferences(bool uneven, Block& block)
{
  int others = 0;
#pragma omp simd reduction(+ : others)
  for (int i = 0; i < CellLanes; ++i)
  {
    others += block.key[i] != block.key[0] ? 1 : 0;
  }
  if (others == 0 && !uneven)
  {
    return false;
  }
  const double perDifference = uneven ? 0.25 : 0.0;
  int lone = 0;
  for (int n = 0; n < 2; ++n)
  {
    Block other; // copied beforehand, as lanes would gather from `block`
    double across[CellLanes];
    for (int i = 0; i < CellLanes; ++i)
    {
      other.weight[i] = block.weight[i ^ (n == 0 ? 1 : 4)];
      other.unit[i] = block.unit[i ^ (n == 0 ? 1 : 4)];
      other.key[i] = block.key[i ^ (n == 0 ? 1 : 4)];
      across[i] = block.weight[i ^ (n == 0 ? 4 : 1)];
    }
#pragma omp simd reduction(+ : lone)
    for (int i = 0; i < CellLanes; ++i)
    {
      lone += ((block.weight[i] > 0.0) & !(other.weight[i] > 0.0) & !(across[i] > 0.0)) ? 1 : 0;
      const double square = block.weight[i] * block.weight[i] * (across[i] > 0.0 ? 0.5 : 1.0);
      const double off = block.weight[i] - other.weight[i];
      const bool known = other.weight[i] > 0.0;
      const bool apart = block.unit[i] != other.unit[i];
      const double all = known ? square : 0.0;
      const double same = known ? perDifference * off * off : 0.0;
      block.variance[n][i] = apart ? all : same;
      block.moves[n][i] = !apart && block.key[i] != other.key[i] ? all : 0.0;
    }
  }
  block.lone = lone;
  return true;
}

/// Add the variance of rays without a neighbour in the beam. The whole weight of such a ray counts
/// if another of the sixteen rays meets something else.
void addLoneRays(Block& block)
{
  for (int i = 0; i < CellLanes; ++i)
  {
    const auto differs = [&](int k)
    { return block.weight[k] > 0.0 && block.unit[k] != block.unit[i]; };
    const bool lone =
      block.weight[i] > 0.0 && !(block.weight[i ^ 1] > 0.0) && !(block.weight[i ^ 4] > 0.0);
    bool apart = false;
    for (int k = 0; k < CellLanes && lone; ++k)
    {
      apart = apart || differs(k);
    }
    block.variance[0][i] += apart ? block.weight[i] * block.weight[i] : 0.0;
  }
}

/// Sum of sixteen values, in an order that does not depend on the width of lanes.
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

double partsOfStrips(const ScanSetup& setup)
{
  return setup.settings.waveforms ? partsForSamples(setup) : partsOfUnit(setup);
}

RangeStrips::RangeStrips(const ScanSetup& setup)
  : Setup(setup)
  , UnitLength(setup.sensor.rangeUnitLength() / partsOfStrips(setup))
  , Gate(setup.sensor.rangeGate)
  , Offset(
      ReceivedPulse(setup.sensor, setup.sensor.samplingInterval / partsOfStrips(setup)).before())
  , Shape(setup.sensor)
  , HasPlaces(haveVolumes(setup.media))
{
}

void RangeStrips::begin(const BeamFrame& frame, const std::vector<const BeamSurface*>& surfaces)
{
  this->Tangent2 = frame.tanHalf * frame.tanHalf;
  this->Flatness2 = frame.flatness2;
  this->Uneven = this->Setup.sensor.beamProfile == BeamProfile::Gaussian ||
    (this->Shape.isRound() && this->Tangent2 > NarrowBeam * NarrowBeam);
  this->All = &surfaces;
  this->Of.assign(surfaces.size(), None);
  this->Visible.clear();
  this->Sums.clear();
  this->Halves.clear();
  this->Used = 0.0;
}

/// The strips of a surface; null if the surface has too many strips.
const SurfaceStrips* RangeStrips::stripsOf(std::uint32_t surface)
{
  std::uint32_t& place = this->Of[surface];
  if (place != None)
  {
    return &this->Visible[place];
  }
  const BeamSurface& s = *(*this->All)[surface];
  const double slope = Root2 * s.inverse.slope();
  const double slowest = std::max(s.leastInverse, s.inverse.z - slope);
  const double fastest = std::min(s.mostInverse, s.inverse.z + slope);
  const double parts =
    std::clamp(std::ceil(this->UnitLength * fastest / MostOfRange), 1.0, MostParts);
  const double border = parts * this->Offset;
  SurfaceStrips strips{ static_cast<double>(surface), s.inverse, s.diagonal, s.height, this->Gate,
    parts / this->UnitLength, border - whole(border), -border - whole(-border), 0.0, this->Used,
    0.0 };
  strips.least = numberAt(strips, (1.0 - 1e-9) / fastest);
  const double last = numberAt(strips, (1.0 + 1e-9) * std::sqrt(1.0 + this->Tangent2) / slowest);
  strips.count = last - strips.least + 1.0;
  const double used = this->Used + (s.other == NoTriangle ? 1.0 : 2.0) * strips.count;
  if (!(used <= MostStrips))
  {
    return nullptr;
  }
  this->Used = used;
  this->Places.resize(std::max(this->Places.size(), static_cast<std::size_t>(used)));
  place = static_cast<std::uint32_t>(this->Visible.size());
  this->Visible.push_back(strips);
  return &this->Visible.back();
}

/// The sums of a strip.
inline RangeStrips::Strip& RangeStrips::sumOf(double number)
{
  const auto key = static_cast<std::uint32_t>(number);
  std::uint32_t& place = this->Places[key]; // entry that may be left from an earlier beam
  if (place >= this->Sums.size() || this->Sums[place].key != key)
  {
    place = static_cast<std::uint32_t>(this->Sums.size());
    this->Sums.push_back({ 0.0, 0.0, 0.0, 0.0, key, {} });
  }
  return this->Sums[place];
}

bool RangeStrips::addWhole(
  std::uint32_t surface, const PlanePoint& middle, double width, double share)
{
  const bool fits = this->Setup.sensor.beamProfile == BeamProfile::Uniform &&
    this->Tangent2 <= NarrowBeam * NarrowBeam;
  const SurfaceStrips* const of = fits ? this->stripsOf(surface) : nullptr;
  if (!of)
  {
    return false;
  }
  const BeamSurface& s = *(*this->All)[surface];
  const double half = 0.5 * width;
  const double reach = half * (std::fabs(s.inverse.x) + std::fabs(s.inverse.y));
  const double inverse = s.inverse.at(middle);
  const double secant2 = this->secant2At(middle);
  const double secant = std::sqrt(secant2);
  const double bend = this->Tangent2 * width; // upper bound of the relative change of the secant
  const double first = numberAt(*of, (1.0 - bend) * secant / (inverse + reach));
  const double last =
    inverse > reach ? numberAt(*of, (1.0 + bend) * secant / (inverse - reach)) : Infinity;
  const double side = s.diagonal.at(middle);
  const double across = half * (std::fabs(s.diagonal.x) + std::fabs(s.diagonal.y));
  if (first != last || std::fabs(side) <= across)
  {
    return false;
  }
  const double number = std::clamp(first - of->least, 0.0, of->count - 1.0);
  Strip& sum = this->sumOf(of->first + number + (side < 0.0 ? of->count : 0.0));
  const double weight = share / (this->Shape.isRound() ? secant2 * secant : 1.0);
  sum.weight += weight;
  sum.moment += weight * secant / inverse;
  if (this->HasPlaces)
  {
    sum.place.add(AirColumn::in(middle.x, middle.y, half), weight, middle.x, middle.y, half);
  }
  return true;
}

/// Squared secant of the angle between a ray and the axis.
double RangeStrips::secant2At(const PlanePoint& p) const
{
  return 1.0 + this->Tangent2 * (p.x * p.x + this->Flatness2 * (p.y * p.y));
}

/// Add a variance to CellSamples::halves of a strip.
void RangeStrips::addHalves(std::size_t strip, double variance)
{
  if (variance > 0.0)
  {
    this->Halves.resize(std::max(this->Halves.size(), strip + 1));
    this->Halves[strip] += variance;
  }
}

namespace
{
void addPlace(const Block& block, int ray, SamplePlace& place)
{
  place.add(
    AirColumn::at(block.x[ray], block.y[ray]), block.weight[ray], block.x[ray], block.y[ray]);
}
}

bool RangeStrips::add(const CellRays& rays, double share)
{
  Block block;
  const bool isRectangle = this->Shape.width().isRectangle;
  weigh(rays,
    { this->Tangent2, this->Flatness2, isRectangle ? BeamShape::HalfSide : 1.0,
      this->Shape.isRound() },
    share, block);
  if (this->Setup.sensor.beamProfile == BeamProfile::Gaussian)
  {
    for (int i = 0; i < CellLanes; ++i)
    {
      block.weight[i] *= this->Shape.density(block.x[i], block.y[i]);
    }
  }
  std::int32_t last = -1;
  for (int i = 0; i < CellLanes; ++i)
  {
    if (rays.seen[i] < 0 || rays.seen[i] == last || block.key[i] >= 0.0 || !(block.weight[i] > 0.0))
    {
      continue;
    }
    last = rays.seen[i];
    const SurfaceStrips* const strips = this->stripsOf(static_cast<std::uint32_t>(last));
    if (!strips)
    {
      return false;
    }
    findStrips(*strips, block);
  }
  if (!findDifferences(this->Uneven, block))
  {
    if (block.key[0] >= 0.0)
    {
      Strip& sum = this->sumOf(block.key[0]);
      sum.weight += avianlidar::sumOf(block.weight);
      sum.moment += avianlidar::sumOf(block.moment);
      for (int i = 0; this->HasPlaces && i < CellLanes; ++i)
      {
        if (block.key[i] >= 0.0)
        {
          addPlace(block, i, sum.place);
        }
      }
    }
    return true;
  }
  if (block.lone > 0)
  {
    addLoneRays(block);
  }
  for (int i = 0; i < CellLanes; ++i)
  {
    if (block.key[i] >= 0.0)
    {
      Strip& sum = this->sumOf(block.key[i]);
      sum.weight += block.weight[i];
      sum.moment += block.moment[i];
      if (this->HasPlaces)
      {
        addPlace(block, i, sum.place);
      }
      sum.variance = sum.variance + block.variance[0][i] + block.variance[1][i];
      sum.moves = sum.moves + block.moves[0][i] + block.moves[1][i];
      if (block.moves[0][i] + block.moves[1][i] > 0.0)
      {
        const SurfaceStrips& s = this->Visible[this->Of[rays.seen[i]]];
        const auto isOther = [&](int ray) { return block.key[ray] >= s.first + s.count; };
        const double halves = (isOther(i) != isOther(i ^ 1) ? block.moves[0][i] : 0.0) +
          (isOther(i) != isOther(i ^ 4) ? block.moves[1][i] : 0.0);
        this->addHalves(&sum - this->Sums.data(), halves);
      }
    }
  }
  return true;
}

void RangeStrips::addVariance(std::uint32_t surface, const PlanePoint& at, double variance)
{
  const SurfaceStrips& s = this->Visible[this->Of[surface]];
  const double secant = std::sqrt(this->secant2At(at));
  const double number =
    std::clamp(numberAt(s, secant / s.inverse.at(at)) - s.least, 0.0, s.count - 1.0);
  const double half = s.diagonal.at(at) < 0.0 ? s.count : 0.0;
  this->sumOf(s.first + number + half).variance += variance;
}

namespace
{
void addSurface(const BeamSurface& s, VisiblePolygons& surfaces)
{
  PlaneRing ring = octagonAround();
  bool enters = true;
  for (int k = 0; k < s.count && enters; ++k)
  {
    enters = clipRing(ring, s.lines[k]);
  }
  if (enters)
  {
    surfaces.add(s, ring);
  }
}
}

std::unique_ptr<CellSamples> RangeStrips::collect()
{
  auto found = std::make_unique<CellSamples>();
  BeamSamples& samples = found->samples;
  const std::size_t count = this->Sums.size();
  samples.range.resize(count);
  samples.cosine.resize(count);
  samples.weight.resize(count);
  samples.places.resize(this->HasPlaces ? count : 0);
  found->variance.resize(count);
  found->moves.resize(count);
  found->halves.resize(this->Halves.empty() ? 0 : count);
  this->Halves.resize(found->halves.size());
  this->Keys.clear();
  for (std::size_t k = 0; k < count; ++k)
  {
    this->Keys.push_back(keyAbove(this->Sums[k].key, k));
  }
  sortKeys(this->Keys);
  std::size_t k = 0;
  const auto add = [&](std::uint32_t triangle, std::uint32_t other, double height, double end)
  {
    const std::size_t before = k;
    for (; k < count && keyOf(this->Keys[k]) < end; ++k)
    {
      const Strip& sum = this->Sums[numberOf(this->Keys[k])];
      const double range = std::max(height, sum.moment / sum.weight);
      samples.range[k] = range;
      samples.cosine[k] = std::min(1.0, height / range);
      samples.weight[k] = sum.weight;
      if (this->HasPlaces)
      {
        samples.places[k] = sum.place;
      }
      found->variance[k] = sum.variance;
      found->moves[k] = sum.moves;
      if (!found->halves.empty())
      {
        found->halves[k] = this->Halves[numberOf(this->Keys[k])];
      }
      samples.nearest = std::min(samples.nearest, range);
      samples.farthest = std::max(samples.farthest, range);
    }
    if (k > before)
    {
      samples.surfaces.push_back({ triangle, static_cast<std::uint32_t>(k) });
      found->others.push_back(other);
    }
  };
  found->surfaces = std::make_unique<VisiblePolygons>();
  for (const SurfaceStrips& of : this->Visible)
  {
    const BeamSurface& s = *(*this->All)[static_cast<std::size_t>(of.number)];
    addSurface(s, *found->surfaces);
    add(s.triangle, s.other, s.height, of.first + of.count);
    if (s.other != NoTriangle)
    {
      add(s.other, s.triangle, s.height, of.first + 2.0 * of.count);
    }
  }
  return found;
}
}
