// SPDX-License-Identifier: BSD-3-Clause
#include "LeafGaps.h"

#include "Random.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
constexpr double Never = std::numeric_limits<double>::infinity();

/// Number of the scan for leaves that are the same in every scan.
constexpr std::int32_t Always = -1;

constexpr std::uint64_t DrawsOfLeaf = 3;

/// Random numbers about an object: its id (modulo MostObjects + 1) is the leading part of their
/// indices. Rays to targets follow FirstOfTargets leaves' numbers.
constexpr int DigitsOfObject = 40;
constexpr int MostObjects = 0xfff;
constexpr std::uint64_t FirstOfTargets = std::uint64_t{ 1 } << 39;

/// Largest number of cells that a sample meets if its points lie in an ellipse.
constexpr double MostCellsOfEllipse = 4.0;

/// Least widening of the space in which leaves are drawn, over the range.
constexpr double LeastGrowth = 1e-9;

/// Bits of the rays whose light a leaf stops on its way back from a range, m.
std::uint64_t shadedAt(const std::vector<DrawnLeaves::Shadow>& shadows, double range)
{
  std::uint64_t shaded = 0;
  for (const DrawnLeaves::Shadow& shadow : shadows)
  {
    const bool isIn = range > shadow.from && range < shadow.to;
    shaded |= std::uint64_t{ isIn } << shadow.ray;
  }
  return shaded;
}
}

DrawnLeaves LeafGaps::draw(const BeamAir& air, const std::vector<BeamAir::Leaves>& leaves,
  std::int32_t seed, std::uint64_t beam, std::int32_t revolution, std::vector<Sample>& samples)
{
  this->Leaves = leaves;
  this->Grid = 0;
  const auto pairOf = [=](std::uint64_t number, std::int32_t scan)
  { return uniformPair(seed, beam, number, RandomPurpose::Leaves, scan); };
  const auto isBefore = [](const Sample& a, const Sample& b)
  { return a.object != b.object ? a.object < b.object : a.unit < b.unit; };
  std::stable_sort(samples.begin(), samples.end(), isBefore);
  const auto [slopeX, slopeY] = air.scan().halfWidths();
  this->Rays.clear();
  this->Going.clear();
  this->Shadows.clear();
  this->Targets.clear();
  this->makeStreams(air, 0.5 * (slopeX + slopeY), air.scan().solidAngle(), 0, revolution);
  const bool isDivided = !this->Streams.empty();
  if (isDivided)
  {
    const auto [turn, shift] = pairOf(0, revolution);
    this->makeRays(air, turn, shift);
  }
  for (std::size_t first = 0, last = 0; first < samples.size(); first = last)
  {
    const int object = samples[first].object;
    while (last < samples.size() && samples[last].object == object)
    {
      ++last;
    }
    const std::uint64_t number = static_cast<std::uint64_t>(object & MostObjects) << DigitsOfObject;
    this->addTargets(air, samples, first, last,
      [&](std::uint64_t k) { return pairOf(number + FirstOfTargets + k, revolution); });
    if (isDivided)
    {
      continue;
    }
    // The leaves about this object alone.
    std::array<double, 2> low{ Never, Never }, high{ -Never, -Never };
    for (const Ray& ray : this->Rays)
    {
      for (std::size_t axis = 0; axis < 2; ++axis)
      {
        low[axis] = std::min(low[axis], ray.slope[axis]);
        high[axis] = std::max(high[axis], ray.slope[axis]);
      }
    }
    const std::array<double, 2> half{ 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]) };
    this->makeStreams(air, 0.5 * (half[0] + half[1]), 4.0 * half[0] * half[1], number, revolution);
    if (!this->Streams.empty())
    {
      this->place(air, { 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]) }, half, pairOf);
      this->open(first, samples);
    }
    this->Rays.clear();
    this->Going.clear();
    this->Targets.clear();
  }
  if (isDivided)
  {
    this->place(air, { 0.0, 0.0 }, { slopeX, slopeY }, pairOf);
    this->open(0, samples);
  }
  DrawnLeaves drawn;
  drawn.Rays.assign(
    this->Rays.begin(), this->Rays.begin() + static_cast<std::ptrdiff_t>(this->Grid));
  drawn.Shadows = this->Shadows;
  return drawn;
}

namespace
{
/// A point of a sample in the beam's plane. @param u, v uniform in (0, 1)
std::array<double, 2> pointOf(const LeafGaps::Sample& sample, double u, double v)
{
  std::array<double, 2> point{};
  const std::bitset<64> cells(sample.bits);
  const auto count = static_cast<double>(cells.count());
  if (count > MostCellsOfEllipse) // any shape, such as a ring
  {
    double before = u * count; // cells before the point's cell, and place in this cell
    std::size_t cell = 0;
    for (; !cells[cell] || before >= 1.0; ++cell)
    {
      before -= cells[cell] ? 1.0 : 0.0;
    }
    constexpr double width = 2.0 / AirColumn::Across;
    point = { width * (static_cast<double>(cell % AirColumn::Across) + before) - 1.0,
      width * (static_cast<double>(cell / AirColumn::Across) + v) - 1.0 };
  }
  else
  {
    const double radius = std::sqrt(u);
    point = { sample.middle[0] + radius * std::cos(2.0 * Pi * v) * sample.half[0],
      sample.middle[1] + radius * std::sin(2.0 * Pi * v) * sample.half[1] };
  }
  const double away = std::max(1.0, std::hypot(point[0], point[1]));
  return { point[0] / away, point[1] / away };
}
}

/// Add rays to the targets of an object. @param draw gives pairs of random numbers
template <class F>
void LeafGaps::addTargets(const BeamAir& air, const std::vector<Sample>& samples, std::size_t first,
  std::size_t last, F draw)
{
  const auto energyOf = [&](std::size_t from, std::size_t to)
  {
    return std::accumulate(samples.data() + from, samples.data() + to, 0.0,
      [](double sum, const Sample& one) { return sum + one.energy; });
  };
  const auto [slopeX, slopeY] = air.scan().halfWidths();
  const double all = energyOf(first, last);
  for (std::uint64_t number = 0; first < last;)
  {
    std::size_t end = first;
    while (end < last && samples[end].unit == samples[first].unit)
    {
      ++end;
    }
    const double energy = energyOf(first, end);
    const double count =
      energy > 0.0 ? std::ceil(std::max(LeastRaysToTarget, RaysToObject * energy / all)) : 0.0;
    double before = 0.0; // energy of the samples before `first`
    for (double k = 0.5; k < count; k += 1.0, number += 2)
    {
      while (first + 1 < end && before + samples[first].energy < k / count * energy)
      {
        before += samples[first++].energy;
      }
      const Sample& sample = samples[first];
      const auto [away, turn] = draw(number);
      const auto [nearer, angle] = draw(number + 1);
      const auto [x, y] = pointOf(sample, away, turn);
      const std::uint64_t cell = AirColumn::at(x, y) & sample.bits;
      const AirColumn& column = air.columnOf(cell != 0 ? cell : sample.bits);
      const double aperture = air.scan().apertureRadius() * std::sqrt(nearer);
      const double left = air.leftByLeaves(column, sample.range);
      this->Going.push_back(this->Rays.size());
      this->Rays.push_back({ { left > 0.0 ? 1.0 / (left * count) : 0.0, air.numberOf(column),
                               { 0, Never, 0.0 }, true },
        { slopeX * x, slopeY * y },
        { aperture * std::cos(2.0 * Pi * angle), aperture * std::sin(2.0 * Pi * angle) },
        sample.range });
    }
    first = end;
    this->Targets.push_back({ end, this->Rays.size() });
  }
}

/// Set the light of all targets. @param first first sample of the first target
void LeafGaps::open(std::size_t first, std::vector<Sample>& samples)
{
  std::size_t ray = this->Grid;
  for (const Target& target : this->Targets)
  {
    double open = 0.0;
    for (; ray < target.ray; ++ray)
    {
      open += this->Rays[ray].isSeen ? this->Rays[ray].share : 0.0;
    }
    for (; first < target.sample; ++first)
    {
      samples[first].open = open;
    }
  }
}

/// Place the leaves of all streams in a pyramid about the rays. @param middle, half tangents
/// @param draw gives a pair of random numbers by number and scan
template <class F>
void LeafGaps::place(const BeamAir& air, const std::array<double, 2>& middle,
  const std::array<double, 2>& half, F draw)
{
  // Leaves are drawn in a rectangle about all ways, as large as a square of this half side.
  const double growth = std::max(LeastGrowth, 0.5 * (half[0] + half[1]));
  const auto halfSide = [=](const Stream& of) { return of.rim + growth * of.range; };
  const auto advance = [&](Stream& of)
  {
    // The volume up to the next leaf has an exponential distribution. The volume is the integral of
    // 4 (rim + growth r)^2.
    of.number += DrawsOfLeaf;
    const double side = halfSide(of);
    const double volume = -std::log(draw(of.number, of.scan)[0]) / of.perVolume;
    of.range = (std::cbrt(side * side * side + 0.75 * growth * volume) - of.rim) / growth;
    of.range = of.range < of.leaves.end ? of.range : Never;
  };
  std::for_each(this->Streams.begin(), this->Streams.end(), advance);
  while (!this->Going.empty())
  {
    Stream& next = *std::min_element(this->Streams.begin(), this->Streams.end(),
      [](const Stream& a, const Stream& b) { return a.range < b.range; });
    if (!(next.range < Never))
    {
      break;
    }
    // One random number has enough digits for two coordinates.
    constexpr double digits = 67108864.0; // 2^26
    const double place = digits * draw(next.number, next.scan)[1];
    const double u = std::floor(place) / digits;
    const double v = place - std::floor(place);
    const double high = next.rim + half[1] * next.range;
    const double wide = halfSide(next) * halfSide(next) / high;
    this->placeOne(air,
      { middle[0] * next.range + (2.0 * u - 1.0) * wide,
        middle[1] * next.range + (2.0 * v - 1.0) * high },
      next, [&](std::uint64_t number) { return draw(next.number + number, next.scan); });
    advance(next);
  }
  for (std::size_t k = 0; k < this->Grid; ++k)
  {
    this->Rays[k].isSeen = (shadedAt(this->Shadows, this->Rays[k].leaf.range) >> k & 1) == 0;
  }
}

/// Make two streams for each medium of leaves that the beam meets. Make no streams if the rays are
/// too far apart. @param growth half width of the rays, tangent @param solidAngle solid angle that
/// contains the rays, sr @param first number before the random numbers
void LeafGaps::makeStreams(const BeamAir& air, double growth, double solidAngle,
  std::uint64_t first, std::int32_t revolution)
{
  this->Streams.clear();
  for (const BeamAir::Leaves& leaves : this->Leaves)
  {
    const Medium& medium = air.mediumAt(leaves.medium);
    const double seenArea = medium.extinction / medium.drops;
    const double radius = std::sqrt(2.0 * seenArea / Pi);
    const double rim = radius + air.scan().apertureRadius();
    const double across = 2.0 * (rim + growth * leaves.begin);
    const double section = solidAngle * leaves.begin * leaves.begin / seenArea; // section in leaves
    const bool isFirst = this->Streams.empty();
    if (section > (isFirst ? MostLeaves : MostLeavesBehind) ||
      (isFirst && across * across > MostLeavesAcross * seenArea))
    {
      this->Streams.clear();
      return;
    }
    for (const auto& [scan, share] :
      { std::pair(Always, 1.0 - medium.renewed), std::pair(revolution, medium.renewed) })
    {
      this->Streams.push_back({ leaves, scan, medium.drops * share, radius, rim,
        first + (std::uint64_t{ leaves.medium } << 24), leaves.begin });
    }
  }
}

/// Make rays that no leaf has stopped yet. @param turn turn of the rays' points about the middle of
/// the aperture, in whole turns @param shift shift of the share of the aperture's area that is
/// nearer to the middle
void LeafGaps::makeRays(const BeamAir& air, double turn, double shift)
{
  const auto [slopeX, slopeY] = air.scan().halfWidths();
  const double cosine = std::cos(2.0 * Pi * turn);
  const double sine = std::sin(2.0 * Pi * turn);
  for (const AirColumn& cell : air.scan().grid())
  {
    const double nearer = cell.nearer + shift;
    const double away =
      air.scan().apertureRadius() * std::sqrt(nearer < 1.0 ? nearer : nearer - 1.0);
    const auto [x, y] = cell.towards;
    this->Going.push_back(this->Rays.size());
    this->Rays.push_back(
      { { cell.weight, air.numberOf(air.columnOf(cell.bits)), { 0, Never, 0.0 }, true },
        { slopeX * cell.x, slopeY * cell.y },
        { away * (cosine * x - sine * y), away * (cosine * y + sine * x) }, Never });
  }
  this->Grid = this->Rays.size();
}

/// Place a leaf. End the rays that meet the leaf, and note the rays whose light the leaf stops on
/// the way back. @param centre position across the beam, m @param draw gives pair 1 or 2 of the
/// leaf's random numbers
template <class F>
void LeafGaps::placeOne(
  const BeamAir& air, const std::array<double, 2>& centre, const Stream& of, F draw)
{
  bool isDrawn = false;
  double least = 0.0; // density of the medium above which the leaf exists
  double cosine = 1.0;
  double along = 0.0;
  double beside = 0.0;
  // Coordinates in which the leaf is the unit disc.
  const auto toLeaf = [&](double x, double y) -> std::array<double, 2> {
    return { x * along + y * beside, (y * along - x * beside) / cosine };
  };
  for (std::size_t i = this->Going.size(); i-- > 0;)
  {
    Ray& ray = this->Rays[this->Going[i]];
    const auto end = [&]
    {
      this->Going[i] = this->Going.back();
      this->Going.pop_back();
    };
    if (of.range >= ray.end)
    {
      end(); // at the target
      continue;
    }
    const double x = ray.slope[0] * of.range - centre[0];
    const double y = ray.slope[1] * of.range - centre[1];
    if (x * x + y * y > of.rim * of.rim)
    {
      continue;
    }
    if (!isDrawn)
    {
      const double turn = Pi * draw(1)[0];
      along = std::cos(turn) / of.radius;
      beside = std::sin(turn) / of.radius;
      least = draw(1)[1];
      cosine = draw(2)[0];
      isDrawn = true;
    }
    // The way back from a range R passes p + s q, s = 1 - r/R. In the leaf, a s^2 + 2 b s + c < 0.
    const auto p = toLeaf(x, y);
    const auto q = toLeaf(ray.aperture[0], ray.aperture[1]);
    const double a = q[0] * q[0] + q[1] * q[1];
    const double b = p[0] * q[0] + p[1] * q[1];
    const double c = p[0] * p[0] + p[1] * p[1] - 1.0;
    const double root = b * b - a * c;
    const double s = 1.0 - of.range / ray.end;
    const bool isMet = c < 0.0 || (ray.end < Never && s * (a * s + 2.0 * b) + c < 0.0);
    if ((!isMet && ray.end < Never) || (!isMet && (b >= 0.0 || root <= 0.0)) ||
      !(least < air.densityAt(air.columns()[ray.column], of.leaves.medium, of.range)))
    {
      continue;
    }
    if (isMet)
    {
      ray.leaf = { of.leaves.medium, of.range, cosine };
      ray.isSeen = false;
      end();
      continue;
    }
    const double enters = c / (std::sqrt(root) - b);
    const double ends = (std::sqrt(root) - b) / a;
    if (enters < 1.0)
    {
      this->Shadows.push_back({ this->Going[i], of.range / (1.0 - enters),
        ends < 1.0 ? of.range / (1.0 - ends) : Never });
    }
  }
}

double DrawnLeaves::openAt(const BeamAir& air, double range) const
{
  const std::uint64_t shaded = shadedAt(this->Shadows, range);
  double open = 0.0;
  for (std::size_t k = 0; k < this->Rays.size(); ++k)
  {
    open += this->Rays[k].leaf.range > range && (shaded >> k & 1) == 0 ? this->Rays[k].share : 0.0;
  }
  return open > 0.0 ? open / air.leftByLeaves(range) : 0.0;
}

double DrawnLeaves::returnedBetween(
  const BeamAir& air, const AirLight& light, double from, double to, std::uint32_t medium) const
{
  double sum = 0.0;
  for (const Ray& ray : this->Rays)
  {
    const MetLeaf& leaf = ray.leaf;
    sum += ray.isSeen && leaf.medium == medium && leaf.range >= from && leaf.range < to
      ? light.returnedBy(leaf, air.columns()[ray.column], ray.share)
      : 0.0;
  }
  return sum;
}
}
