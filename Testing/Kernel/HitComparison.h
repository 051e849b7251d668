// SPDX-License-Identifier: BSD-3-Clause
// Hits of beams that are aimed at triangles, compared with the oracle of GeometryTestScene.h and,
// bit for bit, with each other.
#ifndef avianlidar_HitComparison_h
#define avianlidar_HitComparison_h

#include "GeometryTestScene.h"

#include <gtest/gtest.h>

namespace geometrytest
{
using Trees = std::vector<std::shared_ptr<const CollisionTree>>;

struct HitComparison
{
  /// Largest error of a range, in units of round-off of double times farthest corner / cosine.
  double rangeError = 0.0;
  std::size_t compared = 0;
  std::size_t hits = 0;
  std::size_t undecided = 0; ///< rays so near an edge that rounding decides
  std::size_t wrong = 0;     ///< another triangle, or none, or one too many
  /// Hits by each tree, in any way down, that differ by a bit from those by the first tree.
  std::vector<std::size_t> otherBits;
};

/// Angle within which rounding may decide whether a ray passes an edge, rad: four units of
/// round-off of the largest of the three terms of an edge function, each way, in a few operations.
constexpr long double EdgeTolerance = 32.0L * 0x1p-53L;

inline void compareRay(const TriangleMesh& mesh, const BeamFrame& frame, double x, double y,
  const Hit& hit, HitComparison& sum)
{
  const Vec3L d = rayDirection(frame, x, y);
  const OracleHit oracle = bruteForce(mesh, frame.origin, d, EdgeTolerance);
  sum.hits += hit.valid();
  if (oracle.nearEdge)
  {
    ++sum.undecided;
    return;
  }
  ++sum.compared;
  if (!hit.valid() || oracle.triangle == avianlidar::NoTriangle)
  {
    sum.wrong += hit.valid() != (oracle.triangle != avianlidar::NoTriangle);
    return;
  }
  // Of coplanar triangles another one may be as near.
  const PairResult pair = testPair(mesh, hit.triangle, frame.origin, d);
  sum.wrong += !pair.hit;
  const long double unit = 0x1p-53L * std::fmax(pair.size, oracle.range) / pair.cosine;
  const auto error = static_cast<double>(std::fabs(hit.range - oracle.range) / unit);
  sum.rangeError = error <= sum.rangeError ? sum.rangeError : error; // not a number stays
}

/// Beams of several widths aimed at points of random triangles, traced in every way down the trees.
inline void compareBeams(
  const Trees& trees, const Vec3& apex, Numbers& random, int beams, int rays, HitComparison& sum)
{
  using avianlidar::TraceMode;
  const TriangleMesh& mesh = *trees.front()->mesh;
  sum.otherBits.resize(std::max(sum.otherBits.size(), trees.size()), 0);
  for (int i = 0; i < beams; ++i)
  {
    const double widths[] = { 1e-6, 1e-4, 5.6e-3, 0.1, 1.0 };
    const auto t = static_cast<std::uint32_t>(random.index(mesh.size()));
    const double u = random();
    const double v = random() * (1.0 - u);
    const Vec3 target = mesh.corner(t, 0) - apex + u * (mesh.corner(t, 1) - mesh.corner(t, 0)) +
      v * (mesh.corner(t, 2) - mesh.corner(t, 0));
    BeamRays drawn = raysInDisc(random, static_cast<std::size_t>(rays));
    drawn.x[0] = drawn.y[0] = 0.0;
    if (glm::dot(target, target) == 0.0)
    {
      continue; // the lidar is that point
    }
    const BeamFrame frame = avianlidar::makeBeamFrame(apex, target, widths[i % 5]);
    std::vector<Hit> reference;
    for (std::size_t tree = 0; tree < trees.size(); ++tree)
    {
      avianlidar::OneBeamTracer tracer(*trees[tree]);
      for (const TraceMode mode : { TraceMode::Automatic, TraceMode::Beams, TraceMode::SingleRays })
      {
        std::vector<Hit> hits;
        tracer.setBeam(frame);
        tracer.trace(drawn, mode, hits);
        reference = reference.empty() ? hits : reference;
        for (std::size_t n = 0; n < hits.size(); ++n)
        {
          sum.otherBits[tree] += !sameBits(hits[n], reference[n]);
        }
      }
    }
    for (std::size_t n = 0; n < reference.size(); ++n)
    {
      compareRay(mesh, frame, drawn.x[n], drawn.y[n], reference[n], sum);
    }
  }
}
}

#endif
