// SPDX-License-Identifier: BSD-3-Clause
#include "BeamAir.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace avianlidar
{
namespace
{
/// Distances from the aperture's middle, over its radius, and shares of its area: Gauss's rule.
constexpr double PlacesOnAperture[][2] = { { 0.21234054, 0.13965396 }, { 0.59053314, 0.45848221 },
  { 0.91141204, 0.40186383 } };

/// Share of the leaves on one of two ways that do not touch the other way. @param x distance
/// between the ways, in diameters of a leaf
double beforeOneWay(double x)
{
  return x < 1.0 ? x * (2.0 - x) : 1.0;
}
}

/// Sum over the parts of a column. @param of function that gives the term of a part
template <class F>
double BeamAir::sumOver(const AirColumn& column, F of) const
{
  double sum = 0.0;
  for (const Part& part : this->partsOf(column))
  {
    sum += of(part);
  }
  return sum;
}

double BeamAir::depth(const AirColumn& column, double range) const
{
  return this->sumOver(
    column, [&](const Part& part) { return part.extinction * part.crossing.upTo(range); });
}

double BeamAir::wayBack(const AirColumn& column, double range) const
{
  std::array<double, std::size(PlacesOnAperture)> depths{};
  bool isFree = true;
  for (const Part& part : this->partsOf(column))
  {
    const double perLeaf = part.perLeaf * this->Scan->apertureRadius();
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
  for (const AirColumn& column : this->columns())
  {
    if (this->isLocal() && (columns == 0 || (columns & column.bits) != 0))
    {
      sum += column.weight * std::exp(-this->depth(column, range)) * this->wayBack(column, range);
      all += column.weight;
    }
  }
  return all > 0.0 ? sum / all : columns != 0 ? this->transmission(range) : 1.0;
}

std::vector<BeamAir::Leaves> BeamAir::leaves() const
{
  std::vector<Leaves> all;
  for (const Part& part : this->Parts)
  {
    const auto& [begin, end, density, fall] = part.crossing;
    const std::uint32_t medium = this->mediumMet(part.seen);
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
  return all;
}

const AirColumn& BeamAir::columnOf(std::uint64_t bits) const
{
  const std::vector<AirColumn>& all = this->columns();
  const auto found = std::find_if(
    all.begin(), all.end(), [=](const AirColumn& column) { return (column.bits & bits) != 0; });
  return found != all.end() ? *found : all.front();
}

double BeamAir::densityAt(const AirColumn& column, std::uint32_t medium, double range) const
{
  return this->sumOver(column,
    [&](const Part& part)
    { return this->mediumMet(part.seen) == medium ? part.crossing.densityAt(range) : 0.0; });
}

double BeamAir::leftByLeaves(const AirColumn& column, double range) const
{
  const double depth = this->sumOver(column,
    [&](const Part& part)
    { return part.perLeaf > 0.0 ? part.extinction * part.crossing.upTo(range) : 0.0; });
  return std::exp(-depth) * this->wayBack(column, range);
}

double BeamAir::leftByLeaves(double range) const
{
  double sum = 0.0;
  for (const AirColumn& column : this->columns())
  {
    sum += column.weight * this->leftByLeaves(column, range);
  }
  return sum;
}

double BeamAir::transmissionBetween(const Vec3& from, const Vec3& to, MediumCrosser& crosser,
  std::vector<MediumCrossing>& found) const
{
  const double length = safeLength(to - from);
  double depth = 0.0;
  for (const PlacedMedium& placed : this->Scan->media())
  {
    found.clear();
    if (length > 0.0 && !placed.fillsScene())
    {
      crosser.find(
        placed.volume, this->Origin + from, (to - from) / length, length, this->Seconds, found);
    }
    for (const MediumCrossing& part : found)
    {
      depth += placed.medium.extinction * part.upTo(length);
    }
  }
  return std::exp(-depth);
}

std::vector<MetSurface> BeamAir::arrange(std::vector<MetSurface> surfaces) const
{
  const auto isNearer = [](const MetSurface& a, const MetSurface& b) { return a.range < b.range; };
  if (surfaces.empty() || this->isLocal())
  {
    std::stable_sort(surfaces.begin(), surfaces.end(), isNearer);
    return surfaces;
  }
  const auto unitOf = [&](double range)
  {
    return static_cast<std::size_t>(
      std::min(static_cast<double>(this->Scan->units()), range / this->Scan->unitLength() + 0.5));
  };
  const auto ends = std::minmax_element(surfaces.begin(), surfaces.end(), isNearer);
  const std::size_t first = unitOf(ends.first->range);
  std::vector<double> weights(unitOf(ends.second->range) - first + 1, 0.0);
  for (const MetSurface& surface : surfaces)
  {
    weights[unitOf(surface.range) - first] += surface.weight;
  }
  surfaces.clear();
  for (std::size_t k = 0; k < weights.size(); ++k)
  {
    if (weights[k] > 0.0)
    {
      surfaces.push_back(
        { this->Scan->unitLength() * static_cast<double>(first + k), weights[k], 0 });
    }
  }
  return surfaces;
}
}
