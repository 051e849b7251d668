// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleOrder.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
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

/// Compares triangles by their numbers.
class IsBefore
{
public:
  IsBefore(const TriangleMesh& mesh, const std::vector<int>& objectIds,
    const std::vector<int>& materialIds)
    : Mesh(mesh)
    , Objects(objectIds)
    , Materials(materialIds)
  {
    Vec3 lower(std::numeric_limits<double>::infinity());
    Vec3 upper = -lower;
    this->Middles.reserve(mesh.size());
    for (std::uint32_t t = 0; t < mesh.size(); ++t)
    {
      this->Middles.push_back(middleOf(mesh, t));
      lower = glm::min(lower, this->Middles[t]);
      upper = glm::max(upper, this->Middles[t]);
    }
    this->Places.reserve(mesh.size());
    for (const Vec3& middle : this->Middles)
    {
      std::uint64_t place = 0;
      for (int axis = 0; axis < 3; ++axis)
      {
        const double size = upper[axis] - lower[axis];
        const double share = size > 0.0 ? (middle[axis] - lower[axis]) / size : 0.0;
        place |= spread(static_cast<std::uint64_t>(std::min(Steps * share, Steps - 1.0))) << axis;
      }
      this->Places.push_back(place);
    }
  }

  bool operator()(std::uint32_t a, std::uint32_t b) const
  {
    if (this->Objects[a] != this->Objects[b] || this->Places[a] != this->Places[b])
    {
      return std::tie(this->Objects[a], this->Places[a]) <
        std::tie(this->Objects[b], this->Places[b]);
    }
    if (this->Middles[a] != this->Middles[b])
    {
      return isLess(this->Middles[a], this->Middles[b]);
    }
    for (int c = 0; c < 3; ++c)
    {
      if (this->Mesh.corner(a, c) != this->Mesh.corner(b, c))
      {
        return isLess(this->Mesh.corner(a, c), this->Mesh.corner(b, c));
      }
    }
    return std::tie(this->Materials[a], a) < std::tie(this->Materials[b], b);
  }

private:
  const TriangleMesh& Mesh;
  const std::vector<int>&Objects, &Materials;
  std::vector<Vec3> Middles;
  std::vector<std::uint64_t> Places; ///< places on the curve
};
}

std::vector<std::uint32_t> triangleOrder(
  const TriangleMesh& mesh, const std::vector<int>& objectIds, const std::vector<int>& materialIds)
{
  const IsBefore isBefore(mesh, objectIds, materialIds);
  std::vector<std::uint32_t> order(mesh.size());
  std::iota(order.begin(), order.end(), 0u);
  if (std::is_sorted(order.begin(), order.end(), std::cref(isBefore)))
  {
    return {};
  }
  std::sort(order.begin(), order.end(), std::cref(isBefore));
  return order;
}
}
