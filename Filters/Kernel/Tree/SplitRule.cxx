// SPDX-License-Identifier: BSD-3-Clause
#include "SplitRule.h"

#include "PrincipalAxes.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
Vec3 twiceCenter(const LaneBox& box)
{
  const Lanes center = box.twiceCenter();
  return { center[0], center[1], center[2] };
}

std::size_t splitInHalves(const LaneBox* from, LaneBox* to, std::size_t count)
{
  std::copy(from, from + count, to);
  return count / 2;
}

std::size_t splitAtMedian(LaneBox* from, LaneBox* to, std::size_t count, int axis)
{
  const std::size_t middle = count / 2;
  // The number settles ties, so that the two sets do not depend on the library's selection
  // algorithm.
  std::nth_element(from, from + middle, from + count,
    [axis](const LaneBox& a, const LaneBox& b)
    {
      const float ca = a.twiceCenter()[axis];
      const float cb = b.twiceCenter()[axis];
      return ca < cb || (ca == cb && a.triangle() < b.triangle());
    });
  return splitInHalves(from, to, count);
}

std::size_t splitAtPrincipalPlane(const LaneBox* from, LaneBox* to, std::size_t count)
{
  const Vec3 reference = twiceCenter(from[0]);
  Vec3 mean(0.0);
  for (std::size_t i = 0; i < count; ++i)
  {
    mean += twiceCenter(from[i]) - reference;
  }
  mean /= static_cast<double>(count);
  SecondMoments moments;
  for (std::size_t i = 0; i < count; ++i)
  {
    moments.add((twiceCenter(from[i]) - reference) - mean);
  }
  const Vec3 normal = principalAxes(moments.sums)[0];
  const LaneBox* const middle = std::partition_copy(from, from + count, to,
    std::reverse_iterator<LaneBox*>(to + count),
    [&](const LaneBox& box) {
      return glm::dot((twiceCenter(box) - reference) - mean, normal) < 0.0;
    }).first;
  const std::size_t first = static_cast<std::size_t>(middle - to);
  return first > 0 && first < count ? first : splitInHalves(from, to, count);
}

AVIANLIDAR_MULTIVERSION std::size_t splitBySurfaceArea(
  const LaneBox* from, LaneBox* to, std::size_t count, const LaneBox& centers)
{
  BinMapping mapping;
  mapping.set(centers, count);
  Bins bins;
  bins.clear(mapping.bins);
  bins.add(mapping, from, count);
  const BinChoice choice = bins.choose(mapping);
  if (choice.axis < 0)
  {
    return 0;
  }
  const std::size_t first = bins.below(choice);
  part(mapping, choice, from, count, to, 0, first);
  return first;
}
}

std::size_t splitTriangles(SplitRule rule, LaneBox* from, LaneBox* to, std::size_t count,
  const LaneBox& centers, std::uint32_t depth)
{
  switch (rule)
  {
    case SplitRule::Median:
      return splitAtMedian(from, to, count, static_cast<int>(depth % 3));
    case SplitRule::PrincipalPlane:
      return splitAtPrincipalPlane(from, to, count);
    case SplitRule::SurfaceAreaHeuristic:
    {
      const std::size_t first = splitBySurfaceArea(from, to, count, centers);
      return first > 0 ? first : splitInHalves(from, to, count);
    }
    case SplitRule::Halves:
      break;
  }
  return splitInHalves(from, to, count);
}
}
