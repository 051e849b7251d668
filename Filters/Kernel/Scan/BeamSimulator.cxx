// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSimulator.h"

#include <limits>

namespace avianlidar
{
BeamSimulator::BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, bool keepsLight,
  BeamSampler& sampler, std::function<bool()> wanted)
  : Scene(*setup.tree)
  , Beams(beams)
  , KeepsLight(keepsLight && (setup.noise.active || setup.movers) && !haveVolumes(setup.media))
  , Block(setup, this->Scene, beams, sampler)
  , Tracing(setup, this->Scene, beams, this->Block)
  , Air(setup.sensor, setup.air())
  , Receiver(setup.sensor, setup.noise, setup.settings.seed, setup.settings.returnMode,
      setup.revolution, wanted, &this->Air, &this->Gaps)
  , Lighting(setup, this->Scene, beams, this->Block, sampler, this->Receiver, this->Air, this->Gaps,
      std::move(wanted))
  , Echoes(setup, this->Lighting, this->Receiver, sampler.error)
{
}

void BeamSimulator::light(
  std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report)
{
  this->Block.takeHits(beam, trace);
  report.range = std::numeric_limits<double>::quiet_NaN();
  const bool meets = trace.polygons() ||
    (trace.cells() ? trace.cells()->samples.size() > 0 : trace.hits && trace.hits->size() > 0);
  report.direct = trace.direct();
  report.isCrowded = trace.cells() && trace.cells()->isCrowded;
  report.status = meets ? BeamStatus::BelowLimit : BeamStatus::NoSurface;
  const bool isLit =
    !trace.lit || !this->Echoes.receiveAgain(this->Beams.ids[beam], *trace.lit, echoes, report);
  if (isLit)
  {
    this->lightBeam(beam, trace, echoes, report);
  }
  if (report.status == BeamStatus::NoSurface && trace.isBehindGate())
  {
    report.status = BeamStatus::OutsideGate;
  }
  addCounters(this->Block.counters(beam), trace.counters);
  trace.held = isLit ? trace.heldBytes() : trace.held;
  report.counters = trace.counters;
  report.raysTracedNow = this->Block.counters(beam).raysTraced;
}

/// Light a beam, and keep the result for scans that differ in noise or movers elsewhere.
void BeamSimulator::lightBeam(
  std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report)
{
  const bool perceivable = this->Lighting.light(beam, trace);
  if (perceivable && this->Lighting.samples() && this->KeepsLight && !trace.lit)
  {
    trace.lit = std::make_unique<LitBeam>();
    trace.lit->units = this->Lighting.units().units();
    trace.lit->radiance = this->Lighting.radiance();
    trace.lit->surfaces = this->Air.surfaces();
    trace.lit->outsideGate = this->Lighting.isOutsideGate();
    trace.lit->lost = this->Lighting.lost();
    trace.lit->skipped = this->Lighting.skipped();
  }
  if (perceivable)
  {
    this->Echoes.receive(this->Beams.ids[beam], trace.lit.get(), echoes, report);
  }
  report.lost = this->Lighting.lost();
  report.skipped = this->Lighting.skipped();
}
}
