// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSimulator.h"

#include <limits>

namespace avianlidar
{
BeamSimulator::BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, std::uint32_t shading,
  BeamSamplers& samplers, std::function<bool()> wanted)
  : Beams(beams)
  , Block(setup, beams, samplers)
  , Receiver(
      setup.sensor, setup.noise, setup.settings.seed, setup.settings.returnMode, setup.revolution)
  , Lighting(setup, beams, shading, this->Block, samplers, this->Receiver, std::move(wanted))
  , Echoes(setup, this->Lighting, this->Receiver)
{
}

void BeamSimulator::light(
  std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report)
{
  this->Block.takeHits(beam, trace);
  report.range = std::numeric_limits<double>::quiet_NaN();
  const bool meets = trace.hits || this->Block.isIntegrated(beam);
  report.status = meets ? BeamStatus::BelowLimit : BeamStatus::NoSurface;
  if (this->Lighting.light(beam, trace))
  {
    this->Echoes.receive(this->Beams.ids[beam], echoes, report);
  }
  report.lost = this->Lighting.lost();
  report.skipped = this->Lighting.skipped();
  report.targetsLeftOut = trace.hits && !this->Block.isIntegrated(beam) ? trace.targetsLeftOut : 0;
  this->count(beam, trace);
  report.counters = trace.counters;
  report.raysTracedNow = this->Block.countersOf(beam).raysTraced;
}

std::uint64_t BeamSimulator::keep(std::size_t beam, BeamTrace& trace)
{
  this->Block.takeHits(beam, trace);
  this->count(beam, trace);
  return this->Block.countersOf(beam).raysTraced;
}

void BeamSimulator::count(std::size_t beam, BeamTrace& trace)
{
  addCounters(this->Block.countersOf(beam), trace.counters);
  if (this->Block.isChanged(beam))
  {
    trace.held = trace.heldBytes();
  }
}
}
