// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSimulator.h"

#include <limits>

namespace avianlidar
{
BeamSimulator::BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, std::uint32_t shading,
  std::function<bool()> wanted)
  : Beams(beams)
  , Samplers(setup.settings.sampling)
  , Block(setup, beams, this->Samplers)
  , Receiver(
      setup.sensor, setup.noise, setup.settings.seed, setup.settings.returnMode, setup.revolution)
  , Lighting(setup, beams, shading, this->Block, this->Samplers, this->Receiver, std::move(wanted))
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
  const TraceCounters& now = this->Block.countersOf(beam);
  addCounters(now, trace.counters);
  report.counters = trace.counters;
  report.raysTracedNow = now.raysTraced;
  if (this->Block.isChanged(beam))
  {
    trace.held = trace.heldBytes();
  }
}
}
