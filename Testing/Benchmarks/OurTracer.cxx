// SPDX-License-Identifier: BSD-3-Clause
#include "OurTracer.h"

#include "OneBeamTracer.h"
#include "ParallelLoop.h"

#include <memory>

namespace benchmarks
{
using namespace avianlidar;

Tracer ourTracer(const CollisionTree& tree, TraceMode mode)
{
  return [&tree, mode](const Workload& work, int threads, const Consumer& consumer)
  {
    std::vector<std::unique_ptr<BeamTracer>> tracers(threads);
    const std::size_t size = beamsPerBlock(static_cast<int>(work.raysPerBeam));
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
    parallelFor(work.beams(), size, threads, body);
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
    const Vec3 s = -w.a;
    const Vec3 q = glm::cross(s, w.ab);
    const double u = glm::dot(s, p) / determinant;
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
  const auto wedges = std::make_shared<std::vector<Wedge>>();
  for (std::uint32_t t = 0; t < scene.mesh->size(); ++t)
  {
    const Vec3 a = scene.mesh->corner(t, 0) - scene.apex;
    wedges->push_back(
      { a, scene.mesh->corner(t, 1) - scene.apex - a, scene.mesh->corner(t, 2) - scene.apex - a });
  }
  return [wedges](const Workload& work, int threads, const Consumer& consumer)
  {
    const auto body = [&](std::size_t begin, std::size_t end, int)
    {
      for (std::size_t i = begin * work.raysPerBeam; i < end * work.raysPerBeam; ++i)
      {
        const Hit hit = nearest(*wedges, work.direction(i));
        if (consumer)
        {
          consumer(i, &hit, 1);
        }
      }
    };
    parallelFor(work.beams(), work.beamsPerBlock(), threads, body);
  };
}
}
