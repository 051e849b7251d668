// SPDX-License-Identifier: BSD-3-Clause
#include "Workload.h"

#include <algorithm>

namespace benchmarks
{
using namespace avianlidar;

std::size_t Workload::beamsPerBlock() const
{
  const std::size_t beams = std::max<std::size_t>(16, 512 / this->raysPerBeam);
  return (beams + 15) / 16 * 16;
}

Workload makeWorkload(const Scene& scene, const BeamAxes& axes)
{
  const ScanGenerator scan(axes.channels > 0 ? airportPattern(axes.channels) : scene.pattern);
  const auto channels = axes.channels > 0 ? axes.channels : numberOfChannels(scene.pattern);
  const std::int64_t columns = scan.size() / channels;
  const std::size_t all = static_cast<std::size_t>(scan.size()) * axes.raysPerBeam;
  const std::int64_t stride = axes.mostRays > 0
    ? std::clamp<std::int64_t>((all + axes.mostRays - 1) / axes.mostRays, 1, columns)
    : 1;
  Workload work;
  work.raysPerBeam = axes.raysPerBeam;
  const StrataPartition strata(axes.raysPerBeam);
  for (std::int64_t column = 0; column < columns; column += stride)
  {
    for (std::int64_t b = column * channels; b < (column + 1) * channels; ++b)
    {
      const ScanBeam beam = scan.beam(b);
      work.frames.push_back(makeBeamFrame(scene.apex,
        Vec3(beam.direction[0], beam.direction[1], beam.direction[2]), axes.halfBeamwidth));
      work.rays.emplace_back();
      sampleBeam(0, static_cast<std::uint64_t>(b), axes.raysPerBeam,
        { axes.halfBeamwidth, BeamProfile::Uniform }, Sampling::Stratified, &strata,
        work.rays.back());
    }
  }
  for (std::size_t i = 0; i < work.size(); ++i)
  {
    const Vec3 d = work.direction(i);
    work.x.push_back(static_cast<float>(d.x));
    work.y.push_back(static_cast<float>(d.y));
    work.z.push_back(static_cast<float>(d.z));
  }
  for (std::vector<float>* v : { &work.x, &work.y, &work.z })
  {
    v->resize(v->size() + 15, 1.0f);
  }
  return work;
}

std::vector<Hit> allHits(const Tracer& tracer, const Workload& workload, int threads)
{
  std::vector<Hit> all(workload.size());
  tracer(workload, threads,
    [&](std::size_t first, const Hit* hits, std::size_t count)
    { std::copy(hits, hits + count, all.begin() + static_cast<std::ptrdiff_t>(first)); });
  return all;
}
}
