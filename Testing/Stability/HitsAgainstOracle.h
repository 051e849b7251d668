// SPDX-License-Identifier: BSD-3-Clause
// Hits of the tracer beside brute force in long double, where that decides: rays that pass no edge
// within rounding.
#ifndef HitsAgainstOracle_h
#define HitsAgainstOracle_h

#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "StabilityTable.h"

namespace stability
{
using namespace geometrytest;
using avianlidar::NoTriangle;
using avianlidar::OneBeamTracer;
using avianlidar::TraceMode;

/// Bound of a range's error in units of RangeUnit(): the tracer's own statement is "a few".
constexpr double RangeBar = 32.0;

struct Comparison
{
  Worst rangeError; ///< in units of round-off of double times farthest corner / cosine
  std::size_t compared = 0;
  std::size_t hits = 0;
  std::size_t undecided = 0; ///< rays so near an edge that rounding decides
  std::size_t wrong = 0;     ///< another triangle, or none, or one too many
  std::size_t otherBits = 0; ///< one descent per ray differs from the batch
};

/// Angle within which rounding may decide whether a ray passes an edge, rad.
constexpr long double EdgeTolerance = 32.0L * 0x1p-53L;

inline void compareRay(const TriangleMesh& mesh, const BeamFrame& frame, double x, double y,
  const Hit& hit, Comparison& sum)
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
  if (hit.valid() != (oracle.triangle != NoTriangle))
  {
    ++sum.wrong;
    return;
  }
  if (!hit.valid())
  {
    return;
  }
  // Of coplanar triangles another one may be as near.
  const PairResult pair = testPair(mesh, hit.triangle, frame.origin, d);
  sum.wrong += !pair.hit;
  const long double unit = 0x1p-53L * std::fmax(pair.size, oracle.range) / pair.cosine;
  sum.rangeError.see(static_cast<double>(std::fabs(hit.range - oracle.range) / unit));
}

/// Trace the rays of one beam and compare all of them.
inline void compareBeam(
  const CollisionTree& tree, const BeamFrame& frame, const BeamRays& rays, Comparison& sum)
{
  OneBeamTracer tracer(tree);
  std::vector<Hit> hits;
  std::vector<Hit> singly;
  tracer.setBeam(frame);
  tracer.trace(rays, TraceMode::Automatic, hits);
  tracer.trace(rays, TraceMode::SingleRays, singly);
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    sum.otherBits += !sameBits(hits[i], singly[i]);
    compareRay(*tree.mesh, frame, rays.x[i], rays.y[i], hits[i], sum);
  }
}

/// Beams of several widths aimed at points of random triangles.
inline void compareBeams(const std::shared_ptr<const TriangleMesh>& mesh, const Vec3& apex,
  Numbers& random, int beams, Comparison& sum)
{
  const auto tree = buildCollisionTree(mesh, TreeOptions());
  const double widths[] = { 1e-6, 1e-4, 5.6e-3, 0.1, 1.0 };
  for (int i = 0; i < beams; ++i)
  {
    const auto t = static_cast<std::uint32_t>(random.index(mesh->size()));
    const double u = random();
    const double v = random() * (1.0 - u);
    const Vec3 a = mesh->corner(t, 0) - apex;
    const Vec3 target = a + u * (mesh->corner(t, 1) - mesh->corner(t, 0)) +
      v * (mesh->corner(t, 2) - mesh->corner(t, 0));
    const double width = widths[i % 5];
    const BeamRays rays = raysInDisc(random, 20);
    if (glm::dot(target, target) == 0.0)
    {
      continue; // the lidar is that point
    }
    compareBeam(*tree, avianlidar::makeBeamFrame(apex, target, width), rays, sum);
  }
}

/// The rows that every comparison gives.
inline void recordComparison(
  const std::string& extreme, const std::string& range, const Comparison& sum)
{
  record({ extreme, range,
    "hits unlike brute force in long double, or unlike one descent per ray, of " +
      std::to_string(sum.compared) + " rays",
    0.0, static_cast<double>(sum.wrong + sum.otherBits) });
  record({ extreme, range,
    "error of range, in 2^-53 times the triangle's farthest corner / cos(incidence)", RangeBar,
    sum.rangeError.value() });
}
}

#endif
