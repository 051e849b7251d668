// SPDX-License-Identifier: BSD-3-Clause
#include "LeafGaps.h"

#include "Random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr double Never = std::numeric_limits<double>::infinity();

/// Number of the scan for leaves that are the same in every scan.
constexpr std::int32_t Always = -1;

constexpr std::uint64_t DrawsOfLeaf = 3;
}

void LeafGaps::begin(
  BeamAir& along, double solidAngle, std::int32_t seed, std::uint64_t beam, std::int32_t revolution)
{
  this->clear();
  this->Along = &along;
  const auto [slopeX, slopeY] = along.halfWidths();
  // Leaves are drawn in a rectangle about all ways, as large as a square of this half side.
  const double growth = 0.5 * (slopeX + slopeY);
  const auto halfSide = [=](const Stream& of) { return of.rim + growth * of.range; };
  const auto draw = [=](const Stream& of, std::uint64_t number)
  { return uniformPair(seed, beam, of.number + number, RandomPurpose::Leaves, of.scan); };
  const auto advance = [&](Stream& of)
  {
    // The volume up to the next leaf has an exponential distribution. The volume is the integral of
    // 4 (rim + growth r)^2.
    of.number += DrawsOfLeaf;
    const double side = halfSide(of);
    const double volume = -std::log(draw(of, 0)[0]) / of.perVolume;
    of.range = (std::cbrt(side * side * side + 0.75 * growth * volume) - of.rim) / growth;
    of.range = of.range < of.leaves.end ? of.range : Never;
  };
  this->makeStreams(growth, solidAngle, revolution);
  if (this->Streams.empty())
  {
    return;
  }
  const auto [turn, shift] = uniformPair(seed, beam, 0, RandomPurpose::Leaves, revolution);
  this->makeRays(turn, shift);
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
    const double place = digits * draw(next, 0)[1];
    const double u = std::floor(place) / digits;
    const double v = place - std::floor(place);
    const double high = next.rim + slopeY * next.range;
    const double wide = halfSide(next) * halfSide(next) / high;
    this->place({ (2.0 * u - 1.0) * wide, (2.0 * v - 1.0) * high }, next,
      [&](std::uint64_t number) { return draw(next, number); });
    advance(next);
  }
  for (std::size_t k = 0; k < this->Rays.size(); ++k)
  {
    this->Rays[k].isSeen = (this->shadedAt(this->Rays[k].leaf.range) >> k & 1) == 0;
  }
}

/// Make two streams for each medium of leaves that the beam meets. Make no streams if the beam is
/// too wide.
void LeafGaps::makeStreams(double growth, double solidAngle, std::int32_t revolution)
{
  this->Streams.clear();
  this->Along->findLeaves(this->Leaves);
  for (const BeamAir::Leaves& leaves : this->Leaves)
  {
    const Medium& medium = this->Along->mediumAt(leaves.medium);
    const double seenArea = medium.extinction / medium.drops;
    const double radius = std::sqrt(2.0 * seenArea / Pi);
    const double rim = radius + this->Along->apertureRadius();
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
        std::uint64_t{ leaves.medium } << 24, leaves.begin });
    }
  }
}

/// Make rays that no leaf has stopped yet. @param turn turn of the rays' points about the middle of
/// the aperture, in whole turns @param shift shift of the share of the aperture's area that is
/// nearer to the middle
void LeafGaps::makeRays(double turn, double shift)
{
  this->Shadows.clear();
  this->Going.clear();
  const auto [slopeX, slopeY] = this->Along->halfWidths();
  const double cosine = std::cos(2.0 * Pi * turn);
  const double sine = std::sin(2.0 * Pi * turn);
  for (const BeamAir::Column& cell : this->Along->grid())
  {
    const double nearer = cell.nearer + shift;
    const double away =
      this->Along->apertureRadius() * std::sqrt(nearer < 1.0 ? nearer : nearer - 1.0);
    const auto [x, y] = cell.towards;
    this->Going.push_back(this->Rays.size());
    this->Rays.push_back({ { slopeX * cell.x, slopeY * cell.y },
      { away * (cosine * x - sine * y), away * (cosine * y + sine * x) }, cell.weight,
      &this->Along->columnOf(cell), { 0, Never, 0.0 }, true });
  }
}

/// Place a leaf. End the rays that meet the leaf, and note the rays whose light the leaf stops on
/// the way back. @param centre position across the beam, m @param draw gives pair 1 or 2 of the
/// leaf's random numbers
template <class F>
void LeafGaps::place(const std::array<double, 2>& centre, const Stream& of, F draw)
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
    const bool isMet = c < 0.0;
    if ((!isMet && (b >= 0.0 || root <= 0.0)) ||
      !(least < this->Along->densityAt(*ray.column, of.leaves.medium, of.range)))
    {
      continue;
    }
    if (isMet)
    {
      ray.leaf = { of.leaves.medium, of.range, cosine };
      this->Going[i] = this->Going.back();
      this->Going.pop_back();
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

/// Bits of the rays whose light a leaf stops on its way back from a range, m.
std::uint64_t LeafGaps::shadedAt(double range) const
{
  std::uint64_t shaded = 0;
  for (const Shadow& shadow : this->Shadows)
  {
    const bool isIn = range > shadow.from && range < shadow.to;
    shaded |= std::uint64_t{ isIn } << shadow.ray;
  }
  return shaded;
}

double LeafGaps::openAt(double range) const
{
  const std::uint64_t shaded = this->shadedAt(range);
  double open = 0.0;
  for (std::size_t k = 0; k < this->Rays.size(); ++k)
  {
    open += this->Rays[k].leaf.range > range && (shaded >> k & 1) == 0 ? this->Rays[k].share : 0.0;
  }
  return open > 0.0 ? open / this->Along->leftByLeaves(range) : 0.0;
}

double LeafGaps::returnedBetween(double from, double to, std::uint32_t medium) const
{
  double sum = 0.0;
  for (const Ray& ray : this->Rays)
  {
    const MetLeaf& leaf = ray.leaf;
    sum += ray.isSeen && leaf.medium == medium && leaf.range >= from && leaf.range < to
      ? this->Along->returnedBy(leaf, *ray.column, ray.share)
      : 0.0;
  }
  return sum;
}
}
