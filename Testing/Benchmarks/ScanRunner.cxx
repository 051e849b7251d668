// SPDX-License-Identifier: BSD-3-Clause
#include "ScanRunner.h"

#include "FinishSetup.h"

namespace benchmarks
{
using namespace avianlidar;

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

ScanSetup makePaperSetup(const Scene& scene, std::shared_ptr<const CollisionTree> tree)
{
  ScanSetup setup = makeSetup(scene, std::move(tree));
  setup.settings.sampling = Sampling::MonteCarlo;
  setup.settings.returnMode = ReturnMode::RangeUnits;
  setup.settings.traceMode = TraceMode::Beams;
  setup.settings.lightEnergyThreshold = LightEnergyThreshold::Limit;
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
      const auto d = scan.beam(b).direction;
      beams.ids.push_back(static_cast<std::uint64_t>(b));
      beams.origins.push_back(scene.apex);
      beams.directions.emplace_back(d[0], d[1], d[2]);
    }
  }
  return beams;
}

std::size_t freshScan(const ScanSetup& setup, const ScanBeams& beams, int threads)
{
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, threads, cache, std::size_t(1) << 30, {}, result);
  return result.echoes.size();
}
}
