// SPDX-License-Identifier: BSD-3-Clause
#include "Tracers.h"

#include "GeometryTestScene.h"
#include "ParallelLoop.h"

#include <algorithm>
#include <cmath>

namespace benchmarks
{
using namespace avianlidar;

std::vector<Hit> allHits(const Tracer& tracer, const Workload& workload, int threads)
{
  std::vector<Hit> all(workload.size());
  tracer(workload, threads,
    [&](std::size_t first, const Hit* hits, std::size_t count)
    { std::copy(hits, hits + count, all.begin() + static_cast<std::ptrdiff_t>(first)); });
  return all;
}

Tracer ourTracer(const CollisionTree& tree, TraceMode mode)
{
  return [&tree, mode](const Workload& work, int threads, const Consumer& consumer)
  {
    std::vector<std::unique_ptr<BeamTracer>> tracers(threads);
    const auto rays = static_cast<std::uint32_t>(work.raysPerBeam);
    const auto body = [&](std::size_t begin, std::size_t end, int thread)
    {
      if (!tracers[thread])
      {
        tracers[thread] = std::make_unique<BeamTracer>(tree);
      }
      const BeamBlock block{ &work.frames[begin], end - begin, rays,
        [&](std::size_t b) -> const BeamRays& { return work.rays[begin + b]; } };
      const BlockHits& found = tracers[thread]->traceBlock(block, mode);
      for (std::size_t b = begin; consumer && b < end; ++b)
      {
        const std::vector<Hit> hits =
          hitsOf(tree, work.frames[b], work.rays[b], found.triangles[b - begin]);
        consumer(b * work.raysPerBeam, hits.data(), work.raysPerBeam);
      }
    };
    parallelFor(work.beams(), avianlidar::beamsPerBlock(static_cast<int>(rays)), threads, body);
  };
}

namespace
{
struct Wedge
{
  Vec3 a, ab, ac;
};

Hit nearest(const std::vector<Wedge>& wedges, const Vec3& d)
{
  Hit hit;
  for (std::size_t t = 0; t < wedges.size(); ++t)
  {
    const Wedge& w = wedges[t];
    const Vec3 p = glm::cross(d, w.ac);
    const double determinant = glm::dot(w.ab, p);
    const Vec3 q = glm::cross(-w.a, w.ab);
    const double u = glm::dot(-w.a, p) / determinant;
    const double v = glm::dot(d, q) / determinant;
    const double range = glm::dot(w.ac, q) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && range > 0.0 && range < hit.range)
    {
      hit.triangle = static_cast<std::uint32_t>(t);
      hit.range = range;
    }
  }
  return hit;
}
}

Tracer bruteForce(const Scene& scene)
{
  std::vector<Wedge> wedges;
  for (std::uint32_t t = 0; t < scene.mesh->size(); ++t)
  {
    const Vec3 a = scene.mesh->corner(t, 0) - scene.apex;
    wedges.push_back(
      { a, scene.mesh->corner(t, 1) - scene.apex - a, scene.mesh->corner(t, 2) - scene.apex - a });
  }
  return [wedges](const Workload& work, int, const Consumer& consumer)
  {
    std::vector<Hit> hits(work.size());
    for (std::size_t i = 0; i < work.size(); ++i)
    {
      hits[i] = nearest(wedges, work.direction(i));
    }
    if (consumer)
    {
      consumer(0, hits.data(), hits.size());
    }
  };
}

namespace
{
bool atEdge(const Scene& scene, const Hit& hit, const Vec3& d)
{
  if (!hit.valid())
  {
    return false;
  }
  const geometrytest::PairResult pair =
    geometrytest::testPair(*scene.mesh, hit.triangle, scene.apex, geometrytest::wide(d));
  return pair.edgeAngle < 1e-5 + 16.0 * 0x1p-24 * pair.size / std::max(hit.range, 1e-3);
}
}

HitAgreement compareHits(const Scene& scene, const Workload& work, const std::vector<Hit>& ours,
  const std::vector<Hit>& theirs)
{
  HitAgreement agreement;
  agreement.rays = ours.size();
  for (std::size_t i = 0; i < ours.size(); ++i)
  {
    agreement.hits += ours[i].valid();
    const bool same = ours[i].valid() == theirs[i].valid() &&
      (!ours[i].valid() || std::fabs(ours[i].range - theirs[i].range) <= 1e-3 * ours[i].range);
    if (!same)
    {
      ++agreement.differ;
      const Vec3 d = work.direction(i);
      agreement.atEdges += atEdge(scene, ours[i], d) || atEdge(scene, theirs[i], d);
    }
  }
  return agreement;
}
}
