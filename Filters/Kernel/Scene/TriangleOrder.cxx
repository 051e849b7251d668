// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleOrder.h"

#include "KeySort.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <tuple>

namespace avianlidar
{
namespace
{
constexpr double Steps = 2097152.0; // 2^21

/// The lowest 21 bits, with two zeros before each bit.
std::uint64_t spread(std::uint64_t bits)
{
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

/// The middle of the longest side. Both halves of a quadrilateral have this point on their
/// diagonal.
Vec3 middleOf(const TriangleMesh& mesh, std::uint32_t triangle)
{
  Vec3 middle(0.0);
  double longest = -1.0;
  for (int c = 0; c < 3; ++c)
  {
    const Vec3& p = mesh.corner(triangle, c);
    const Vec3& q = mesh.corner(triangle, (c + 1) % 3);
    const double length = safeLength(q - p);
    if (length > longest)
    {
      longest = length;
      middle = 0.5 * p + 0.5 * q;
    }
  }
  return middle;
}

bool isLess(const Vec3& p, const Vec3& q)
{
  return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
}

/// Keys of triangles: 32 bits of the object, 63 bits of the place on the curve, and 32 bits of the
/// triangle's number.
std::vector<LongKey> keysOf(const std::vector<Vec3>& middles, const std::vector<int>& objectIds)
{
  Vec3 lower(std::numeric_limits<double>::infinity());
  Vec3 upper = -lower;
  for (const Vec3& middle : middles)
  {
    lower = glm::min(lower, middle);
    upper = glm::max(upper, middle);
  }
  std::vector<LongKey> keys(middles.size());
  for (std::uint32_t t = 0; t < keys.size(); ++t)
  {
    const std::uint64_t place = placeOnCurve(middles[t], lower, upper);
    // Negative ids become the lower numbers.
    const std::uint32_t object = static_cast<std::uint32_t>(objectIds[t]) ^ 0x80000000u;
    keys[t] = { place << 33 | t, static_cast<std::uint64_t>(object) << 32 | place >> 31 };
  }
  return keys;
}
}

std::uint64_t placeOnCurve(const Vec3& point, const Vec3& lower, const Vec3& upper)
{
  std::uint64_t place = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double size = upper[axis] - lower[axis];
    const double share = size > 0.0 ? (point[axis] - lower[axis]) / size : 0.0;
    place |= spread(static_cast<std::uint64_t>(std::min(Steps * share, Steps - 1.0))) << axis;
  }
  return place;
}

std::vector<std::uint32_t> triangleOrder(
  const TriangleMesh& mesh, const std::vector<int>& objectIds, const std::vector<int>& materialIds)
{
  std::vector<Vec3> middles(mesh.size());
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    middles[t] = middleOf(mesh, t);
  }
  std::vector<LongKey> keys = keysOf(middles, objectIds);
  sortKeys(keys);
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  std::transform(keys.begin(), keys.end(), std::back_inserter(order),
    [](const LongKey& key) { return numberOf(key.low); });
  const auto isBefore = [&](std::uint32_t a, std::uint32_t b)
  {
    if (middles[a] != middles[b])
    {
      return isLess(middles[a], middles[b]);
    }
    for (int c = 0; c < 3; ++c)
    {
      if (mesh.corner(a, c) != mesh.corner(b, c))
      {
        return isLess(mesh.corner(a, c), mesh.corner(b, c));
      }
    }
    return std::tie(materialIds[a], a) < std::tie(materialIds[b], b);
  };
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end)
  {
    constexpr std::size_t ahead = 32;
    const std::uint32_t next = order[std::min(begin + ahead, keys.size() - 1)];
    __builtin_prefetch(&middles[next]);
    __builtin_prefetch(&mesh.triangles[next]);
    while (++end < keys.size() && keys[end].high == keys[begin].high &&
      keys[end].low >> 33 == keys[begin].low >> 33)
    {
    }
    if (end > begin + 1)
    {
      std::sort(order.begin() + begin, order.begin() + end, isBefore);
    }
  }
  if (std::is_sorted(order.begin(), order.end()))
  {
    return {};
  }
  return order;
}
}
