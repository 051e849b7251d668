// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSimulator.h"

#include "BeamShape.h"

#include <limits>
#include <memory>
#include <utility>

namespace avianlidar
{
namespace
{
/// Finish the report of a beam. @param cost cost of tracing the beam in this run
void finishReport(const TraceCounters& cost, KeptBeam& kept, BeamReport& report)
{
  if (report.status == BeamStatus::NoSurface && kept.view.isBehindGate())
  {
    report.status = BeamStatus::OutsideGate;
  }
  addCounters(cost, kept.counters);
  report.counters = kept.counters;
  report.raysTracedNow = cost.raysTraced;
}
}

BeamSimulator::BeamSimulator(const ScanSetup& setup, const ScanAir& air, const ScanBeams& beams,
  const ScanOptions& options, BeamSampler& sampler, std::function<bool()> wanted)
  : Scene(*setup.tree)
  , Setup(setup)
  , Air(air)
  , Beams(beams)
  , Width(BeamShape(setup.sensor).width())
  , KeepsLight(options.keepsLight && (setup.noise.active || setup.movers) &&
      !haveVolumes(setup.media) && !setup.settings.waveforms)
  , Rays(sampler, setup.settings.seed)
  , Tracing(setup, this->Scene, beams, this->Rays, options.lightsAll)
  , Hits(setup, this->Scene)
  , AirAlong(air)
  , Receiver(setup.sensor, setup.noise, setup.settings.seed, setup.settings.returnMode, air,
      setup.revolution, wanted)
  , Lighting(
      setup, this->Scene, this->Receiver.mayAlarm(), options.lightsAll, wanted, partsOfUnit(setup))
  , OfRays(setup.settings.sampling, sampler.strata.numberOfRays(), &sampler.strata)
  , Echoes(setup, this->OfRays)
  , Divided(setup.sensor)
{
  if (setup.settings.waveforms)
  {
    this->Recording = std::make_unique<BeamWaveforms>(setup, air, this->Receiver);
    if (partsForSamples(setup) != partsOfUnit(setup))
    {
      this->Dividing = std::make_unique<BeamLighting>(
        setup, this->Scene, true, true, std::move(wanted), partsForSamples(setup));
    }
  }
}

SeenBeam& BeamSimulator::Traced::of(std::size_t beam)
{
  const std::size_t place = this->Places[beam - this->First];
  this->Nothing.cost = {};
  return place < this->Count ? this->Seen[place] : this->Nothing;
}

BeamSimulator::Traced BeamSimulator::trace(std::size_t begin, std::size_t end,
  std::vector<KeptBeam>& kept, const std::function<bool(std::size_t)>& leaveOut, Traced&& memory)
{
  Traced traced = std::move(memory);
  this->Rays.begin(this->Beams.ids, begin, end);
  std::vector<BeamToSee> beams;
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    const BeamView& view = kept[beam].view;
    const bool isKnown = view.direct() != DirectEcho::Unknown;
    if ((!isKnown || this->Tracing.lacksHits(view)) && !(leaveOut && leaveOut(beam)))
    {
      beams.push_back({ beam, isKnown });
    }
  }
  traced.First = begin;
  traced.Count = beams.size();
  traced.Places.assign(end - begin, beams.size());
  traced.Seen = this->Tracing.see(beams, std::move(traced.Seen));
  for (std::size_t k = 0; k < beams.size(); ++k)
  {
    BeamView& view = kept[beams[k].beam].view;
    if (beams[k].onlyRays)
    {
      view.hits = std::move(traced.Seen[k].view.hits);
    }
    else
    {
      view = std::move(traced.Seen[k].view);
    }
    traced.Places[beams[k].beam - begin] = k;
  }
  return traced;
}

BeamLight BeamSimulator::follow(std::size_t beam, SeenBeam& traced, KeptBeam& kept,
  BeamResults& results, BeamReport& report, BeamLight&& memory)
{
  report.range = std::numeric_limits<double>::quiet_NaN();
  report.direct = kept.view.direct();
  report.isCrowded = kept.view.cells() && kept.view.cells()->isCrowded;
  report.status = kept.view.meetsSurfaces() ? BeamStatus::BelowLimit : BeamStatus::NoSurface;
  if (kept.lit && this->followKnown(beam, *kept.lit, results.echoes, report))
  {
    finishReport(traced.cost, kept, report);
    memory.clear(this->Setup.sensor.backgroundRadiance);
    return std::move(memory);
  }
  const BeamFrame frame =
    makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
  const PathStarts starts =
    this->Hits.startsOf(beam, frame, this->Rays, kept.view, traced.geometry, traced.hasGeometry);
  const BeamAir air = this->AirAlong.along(frame, this->Beams.timeOf(beam));
  const BeamLighting::Beam seen{ this->Beams.ids[beam], frame, kept.view, starts, air };
  BeamLight light =
    this->Lighting.light(seen, this->Rays.strata(), kept.paths, traced.cost, std::move(memory));
  const bool isWhole = this->Recording && this->Setup.settings.waveformFloor == 0.0;
  if (light.isPerceivable || isWhole)
  {
    if (light.samples() && this->KeepsLight && !kept.lit)
    {
      kept.lit = std::make_unique<LitBeam>(light);
    }
    const Received received =
      this->Receiver.receive(this->Beams.ids[beam], light.arriving(), air, light.leaves);
    const std::vector<LightEcho> ofLight = this->Echoes.ofLight(received, light);
    const BeamEchoes::Report echo = this->Echoes.add(
      received, ofLight, light.samples() != nullptr, light.isOutsideGate(), results.echoes);
    if (this->Recording)
    {
      const bool isDivided =
        this->Recording->find(light, received, air) && this->Dividing && light.isIntegrated;
      if (isDivided)
      {
        this->Divided = this->Dividing->divided(seen, light, std::move(this->Divided));
      }
      this->Recording->record(
        beam, light, isDivided ? this->Divided : light, received, results.waveforms);
    }
    if (kept.lit)
    {
      kept.lit->add(ofLight);
    }
    report.status = echo.status;
    report.range = echo.range;
  }
  report.lost = light.lost;
  report.skipped = light.skipped;
  kept.held = kept.heldBytes();
  finishReport(traced.cost, kept, report);
  return light;
}

/// Make the echoes of a beam whose light was kept. @return false if the light must be computed
/// again
bool BeamSimulator::followKnown(
  std::size_t beam, const LitBeam& lit, std::vector<Echo>& echoes, BeamReport& report)
{
  const Received received = this->Receiver.receive(
    this->Beams.ids[beam], lit.arriving(), BeamAir(this->Air), DrawnLeaves());
  if (!lit.knows(received))
  {
    return false;
  }
  const BeamEchoes::Report echo =
    this->Echoes.add(received, lit.returns, true, lit.outsideGate, echoes);
  report.status = echo.status;
  report.range = echo.range;
  report.lost = lit.lost;
  report.skipped = lit.skipped;
  return true;
}
}
