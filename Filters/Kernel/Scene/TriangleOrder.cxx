// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleOrder.h"

#include "KeySort.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace avianlidar
{
namespace
{
constexpr double Steps = 2097152.0; // 2^21

struct Entry
{
  std::uint64_t place; ///< on the curve
  int object;
  std::uint32_t triangle;
};

/// The lowest 21 bits, two zeros before each.
std::uint64_t spread(std::uint64_t bits)
{
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

/// The middle of the longest side. Both halves of a quadrilateral have it on their diagonal.
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

bool isBefore(
  const TriangleMesh& mesh, const std::vector<int>& materialIds, const Entry& a, const Entry& b)
{
  if (a.object != b.object || a.place != b.place)
  {
    return std::tie(a.object, a.place) < std::tie(b.object, b.place);
  }
  const Vec3 middleOfA = middleOf(mesh, a.triangle);
  const Vec3 middleOfB = middleOf(mesh, b.triangle);
  if (middleOfA != middleOfB)
  {
    return isLess(middleOfA, middleOfB);
  }
  for (int c = 0; c < 3; ++c)
  {
    if (mesh.corner(a.triangle, c) != mesh.corner(b.triangle, c))
    {
      return isLess(mesh.corner(a.triangle, c), mesh.corner(b.triangle, c));
    }
  }
  return std::tie(materialIds[a.triangle], a.triangle) <
    std::tie(materialIds[b.triangle], b.triangle);
}
}

std::vector<std::uint32_t> triangleOrder(
  const TriangleMesh& mesh, const std::vector<int>& objectIds, const std::vector<int>& materialIds)
{
  Vec3 lower(std::numeric_limits<double>::infinity());
  Vec3 upper = -lower;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Vec3 middle = middleOf(mesh, t);
    lower = glm::min(lower, middle);
    upper = glm::max(upper, middle);
  }
  std::vector<Entry> entries(mesh.size());
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Vec3 middle = middleOf(mesh, t);
    std::uint64_t place = 0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double size = upper[axis] - lower[axis];
      const double share = size > 0.0 ? (middle[axis] - lower[axis]) / size : 0.0;
      place |= spread(static_cast<std::uint64_t>(std::min(Steps * share, Steps - 1.0))) << axis;
    }
    entries[t] = { place, objectIds[t], t };
  }
  const auto before = [&](const Entry& a, const Entry& b)
  { return isBefore(mesh, materialIds, a, b); };
  std::vector<std::uint32_t> order;
  if (std::is_sorted(entries.begin(), entries.end(), before))
  {
    return order;
  }
  // By the high bits of places with fast integers, then by object, then the few that are left.
  constexpr std::uint64_t low = 0xffffffff;
  std::vector<std::uint64_t> keys;
  keys.reserve(entries.size());
  for (const Entry& entry : entries)
  {
    keys.push_back((entry.place << 1 & ~low) | entry.triangle);
  }
  sortKeys(keys);
  order.reserve(entries.size());
  for (const std::uint64_t key : keys)
  {
    order.push_back(numberOf(key));
  }
  std::stable_sort(order.begin(), order.end(),
    [&](std::uint32_t a, std::uint32_t b) { return objectIds[a] < objectIds[b]; });
  const auto isTie = [&](std::uint32_t a, std::uint32_t b)
  {
    return objectIds[a] == objectIds[b] && ((entries[a].place ^ entries[b].place) << 1 & ~low) == 0;
  };
  for (auto begin = order.begin(); begin != order.end();)
  {
    const auto end =
      std::find_if(begin, order.end(), [&](std::uint32_t t) { return !isTie(*begin, t); });
    if (end - begin > 1)
    {
      std::sort(begin, end,
        [&](std::uint32_t a, std::uint32_t b) { return before(entries[a], entries[b]); });
    }
    begin = end;
  }
  return order;
}
}
