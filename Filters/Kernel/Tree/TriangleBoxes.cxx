// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleBoxes.h"

#include <sys/mman.h>

#include <atomic>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace avianlidar
{
namespace
{
constexpr std::size_t Block = 4096; ///< number of triangles in a block

/// Allocate boxes without initialising them, in huge pages where the system has them: pages of 4
/// KiB make building the tree of 748,267 triangles 1.13 times as long.
LaneBox* allocate(std::size_t count)
{
  constexpr std::size_t hugePage = std::size_t{ 1 } << 21;
  const std::size_t bytes = count * sizeof(LaneBox);
  const bool isLarge = bytes >= 2 * hugePage;
  void* memory = nullptr;
  if (posix_memalign(&memory, isLarge ? hugePage : alignof(LaneBox), bytes) != 0)
  {
    throw std::bad_alloc();
  }
#ifdef MADV_HUGEPAGE
  if (isLarge)
  {
    madvise(memory, bytes, MADV_HUGEPAGE); // a refusal only costs time
  }
#endif
  return static_cast<LaneBox*>(memory);
}

bool isGood(const Vec3& corner)
{
  // Comparisons with NaN are false.
  const Vec3 size = glm::abs(corner);
  return (size.x <= MaximumCoordinate) & (size.y <= MaximumCoordinate) &
    (size.z <= MaximumCoordinate);
}

/// Extend a box by triangles. @return false if a corner is missing or out of range
bool addTriangles(const TriangleMesh& mesh, std::size_t begin, std::size_t end, AABB& sum)
{
  AABB box = sum;
  bool good = true;
  for (std::size_t t = begin; t < end; ++t)
  {
    for (const std::uint32_t p : mesh.triangles[t])
    {
      if (p >= mesh.points.size())
      {
        return false;
      }
      good &= isGood(mesh.points[p]);
      box.extend(mesh.points[p]);
    }
  }
  sum = box;
  return good;
}

[[noreturn]] void throwForBadTriangle(const TriangleMesh& mesh)
{
  for (std::size_t t = 0; t < mesh.size(); ++t)
  {
    for (const std::uint32_t p : mesh.triangles[t])
    {
      if (p >= mesh.points.size())
      {
        throw std::invalid_argument("triangle " + std::to_string(t) + " names point " +
          std::to_string(p) + " of " + std::to_string(mesh.points.size()));
      }
      const Vec3& corner = mesh.points[p];
      if (!isGood(corner))
      {
        throw std::invalid_argument("triangle " + std::to_string(t) + " has the corner (" +
          std::to_string(corner.x) + ", " + std::to_string(corner.y) + ", " +
          std::to_string(corner.z) + "), expected finite coordinates of at most 1e30 m");
      }
    }
  }
  throw std::logic_error("no triangle is bad");
}

/// Box of all triangles; empty if `keepGoing` returned false.
AABB boundsOf(const TriangleMesh& mesh, int threads, const KeepGoing& keepGoing)
{
  std::vector<AABB> ofThread(loopThreads(threads));
  std::atomic<bool> good{ true };
  const auto body = [&](std::size_t begin, std::size_t end, int thread)
  {
    if (!addTriangles(mesh, begin, end, ofThread[thread]))
    {
      good = false;
    }
  };
  const bool finished = parallelFor(mesh.size(), Block, threads, body, keepGoing);
  if (!good)
  {
    throwForBadTriangle(mesh);
  }
  AABB bounds;
  if (finished)
  {
    for (const AABB& box : ofThread)
    {
      bounds = merge(bounds, box);
    }
  }
  return bounds;
}
}

LaneBox TriangleBoxes::boxOf(const TriangleMesh& mesh, std::uint32_t triangle) const
{
  LaneBox box;
  box.clear();
  for (const std::uint32_t p : mesh.triangles[triangle])
  {
    const Vec3 corner = mesh.points[p] - this->reference;
    const Lanes nearest{ static_cast<float>(corner.x), static_cast<float>(corner.y),
      static_cast<float>(corner.z), 0.0f };
    box.include({ -nearest, nearest });
  }
  box.below = roundedUp(box.below);
  box.above = roundedUp(box.above);
  // Floats hold numbers of 16 bits exactly.
  box.below[3] = static_cast<float>(triangle & 0xffffu);
  box.above[3] = static_cast<float>(triangle >> 16);
  return box;
}

TriangleBoxes makeTriangleBoxes(const TriangleMesh& mesh, int threads, const KeepGoing& keepGoing)
{
  if (mesh.size() > 0x7fffffffu)
  {
    throw std::invalid_argument(
      std::to_string(mesh.size()) + " triangles, expected at most 2^31 - 1");
  }
  TriangleBoxes result;
  const AABB bounds = boundsOf(mesh, threads, partOf(keepGoing, 0.0, 0.5));
  if (bounds.empty())
  {
    return result;
  }
  result.reference = bounds.center();
  const Vec3 size = bounds.upper - result.reference;
  result.extent = std::fmax(size.x, std::fmax(size.y, size.z));
  result.count = mesh.size();
  result.memory.reset(allocate(2 * mesh.size()));
  LaneBox* const boxes = result.memory.get();
  result.room = boxes + mesh.size();
  const auto body = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t t = begin; t < end; ++t)
    {
      boxes[t] = result.boxOf(mesh, static_cast<std::uint32_t>(t));
    }
  };
  if (parallelFor(mesh.size(), Block, threads, body, partOf(keepGoing, 0.5, 1.0)))
  {
    result.boxes = boxes;
  }
  return result;
}
}
