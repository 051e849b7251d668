// SPDX-License-Identifier: BSD-3-Clause
#include "PatchPreTest.h"

#include "VisiblePatch.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// True if two planes are nearly the same.
bool isLike(const PatchPlane& plane, const PatchPlane& other)
{
  constexpr double same = 1e-6;
  return glm::dot(other.normal, plane.normal) > 1.0 - same &&
    std::fabs(other.height - plane.height) <= same * plane.size;
}

/// True if that of `first` and so many planes more hold what all rays hit, but for a few.
bool allButFewOn(const TriangleMesh& mesh, const Vec3& origin, std::uint32_t first,
  const std::uint32_t* triangles, std::size_t count, std::size_t mostPlanes)
{
  if (first == NoTriangle)
  {
    return false;
  }
  const std::size_t mostOff = mostRaysOff(count);
  PatchPlane planes[MostPatchPlanes] = { patchPlane(mesh, first, origin) };
  std::size_t seen = 1;
  std::uint32_t on[MostPatchTriangles] = { first };
  std::size_t known = 1;
  std::size_t off = 0;
  for (std::size_t i = 0; i < count && off <= mostOff; ++i)
  {
    if (std::find(on, on + known, triangles[i]) != on + known)
    {
      continue;
    }
    if (triangles[i] != NoTriangle && known < MostPatchTriangles)
    {
      const PatchPlane other = patchPlane(mesh, triangles[i], origin);
      const bool is = std::any_of(
        planes, planes + seen, [&](const PatchPlane& plane) { return isLike(plane, other); });
      if (is || seen < mostPlanes)
      {
        if (!is)
        {
          planes[seen++] = other;
        }
        on[known++] = triangles[i];
        continue;
      }
    }
    ++off;
  }
  return off <= mostOff;
}
}

PatchPreTest mayFill(const TriangleMesh& mesh, const Vec3& origin, const std::uint32_t* triangles,
  std::size_t count, std::size_t mostPlanes)
{
  const auto off = static_cast<std::size_t>(std::count(triangles, triangles + count, NoTriangle));
  if (off > mostRaysOff(count))
  {
    return { NoTriangle, false };
  }
  const std::uint32_t ends[] = { triangles[0], triangles[count - 1] };
  for (const std::uint32_t first : ends)
  {
    if (allButFewOn(mesh, origin, first, triangles, count, 1))
    {
      return { first, false };
    }
  }
  const std::uint32_t first = ends[0] != NoTriangle ? ends[0] : ends[1];
  const bool several =
    mostPlanes > 1 && allButFewOn(mesh, origin, first, triangles, count, mostPlanes);
  return { several ? first : NoTriangle, several };
}
}
