// SPDX-License-Identifier: BSD-3-Clause
#include "Workload.h"

#include <algorithm>

namespace benchmarks
{
using namespace avianlidar;

Vec3 Workload::direction(std::size_t ray) const
{
  const std::size_t beam = ray / this->raysPerBeam;
  const std::size_t n = ray % this->raysPerBeam;
  return glm::normalize(this->frames[beam].direction(this->rays[beam].x[n], this->rays[beam].y[n]));
}

std::size_t Workload::beamsPerBlock() const
{
  const std::size_t beams = std::max<std::size_t>(16, 512 / this->raysPerBeam);
  return (beams + 15) / 16 * 16;
}

Workload makeWorkload(const Scene& scene, const BeamAxes& axes)
{
  Scene scanned = scene;
  scanned.pattern = axes.channels > 0 ? airportPattern(axes.channels) : scene.pattern;
  const ScanGenerator scan(scanned.pattern);
  const std::size_t all = static_cast<std::size_t>(scan.size()) * axes.raysPerBeam;
  const std::int64_t columns = scan.size() / numberOfChannels(scanned.pattern);
  const ScanBeams beams = makeBeams(scanned,
    axes.mostRays > 0
      ? std::clamp<std::int64_t>((all + axes.mostRays - 1) / axes.mostRays, 1, columns)
      : 1);
  Workload work;
  work.raysPerBeam = axes.raysPerBeam;
  work.rays.resize(beams.size());
  const StrataPartition strata(axes.raysPerBeam);
  for (std::size_t b = 0; b < beams.size(); ++b)
  {
    work.frames.push_back(makeBeamFrame(scene.apex, beams.directions[b], axes.halfBeamwidth));
    sampleBeam(0, beams.ids[b], axes.raysPerBeam, { axes.halfBeamwidth, BeamProfile::Uniform },
      Sampling::Stratified, &strata, work.rays[b]);
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

ScanSetup makeSetup(const Scene& scene, std::shared_ptr<const CollisionTree> tree)
{
  ScanSetup setup;
  setup.tree = std::move(tree);
  setup.materials = scene.materials;
  setup.objectIds = scene.objectIds;
  setup.materialIds = std::vector<int>(scene.materials.size(), 0);
  setup.sensor = scene.sensor;
  setup.settings.attenuationCoefficient = scene.attenuationCoefficient;
  setup.settings.beamSamples = BeamSampleSource::Rays; // rays are what is measured here
  finishSetup(setup);
  return setup;
}

ScanBeams makeBeams(const Scene& scene, std::int64_t stride)
{
  const ScanGenerator scan(scene.pattern);
  const int channels = numberOfChannels(scene.pattern);
  ScanBeams beams;
  for (std::int64_t b = 0; b < scan.size(); ++b)
  {
    if (b / channels % stride == 0)
    {
      const ScanBeam beam = scan.beam(b);
      beams.ids.push_back(static_cast<std::uint64_t>(b));
      beams.origins.push_back(scene.apex);
      beams.directions.emplace_back(beam.direction[0], beam.direction[1], beam.direction[2]);
      beams.times.push_back(beam.time);
    }
  }
  return beams;
}
}
