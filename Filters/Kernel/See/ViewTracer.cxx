// SPDX-License-Identifier: BSD-3-Clause
#include "ViewTracer.h"

#include "BeamShape.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

namespace avianlidar
{
ViewTracer::ViewTracer(const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams,
  DrawnRays& rays, bool beyondGate)
  : Setup(setup)
  , Scene(scene)
  , Beams(beams)
  , Rays(rays)
  , Width(BeamShape(setup.sensor).width())
  , Gate(beyondGate || setup.sensor.seesDaylight() ? std::numeric_limits<double>::infinity()
                                                   : setup.sensor.rangeGate)
  , Tracer(scene)
  , Views(setup, scene, Tracer)
  , Hits(setup, scene)
{
}

bool ViewTracer::lacksHits(const BeamView& view) const
{
  return view.cells() && !view.hits && this->Setup.settings.numberOfReflections > 1;
}

std::vector<SeenBeam> ViewTracer::see(
  const std::vector<BeamToSee>& beams, std::vector<SeenBeam>&& memory)
{
  std::vector<SeenBeam> seen = std::move(memory);
  seen.resize(std::max(seen.size(), beams.size()));
  this->Frames.clear();
  this->Searched.clear();
  this->FramesOfRays.clear();
  this->TracedRays.clear();
  const bool byRays = this->Setup.settings.beamSamples == BeamSampleSource::Rays;
  for (std::size_t k = 0; k < beams.size(); ++k)
  {
    const std::size_t beam = beams[k].beam;
    const BeamFrame frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
    const bool needsRays = beams[k].onlyRays || byRays;
    (needsRays ? this->FramesOfRays : this->Frames).push_back(frame);
    (needsRays ? this->TracedRays : this->Searched).push_back(k);
    seen[k].view = {};
    seen[k].cost = {};
    seen[k].hasGeometry = false;
    if (!beams[k].onlyRays)
    {
      seen[k].view.seen = byRays ? SeenSurfaces(SeenByRays{}) : SeenSurfaces(NothingSeen{});
    }
  }
  this->Candidates.begin(this->Scene, this->Frames.data(), this->Frames.size(),
    this->Setup.settings.traceMode == TraceMode::Automatic);
  while (this->Candidates.next())
  {
    const std::size_t k = this->Searched[this->Candidates.beam()];
    const BeamFrame& frame = this->Frames[this->Candidates.beam()];
    BeamView& view = seen[k].view;
    view.seen = this->findSurfaces(beams[k].beam, frame, seen[k].cost);
    seen[k].cost.nodesVisited += this->Candidates.nodesVisited();
    if (view.direct() == DirectEcho::Rays || this->lacksHits(view))
    {
      this->FramesOfRays.push_back(frame);
      this->TracedRays.push_back(k);
    }
  }
  this->traceRays(beams, seen);
  return seen;
}

/// True if the beam's axis meets a surface behind the gate.
bool ViewTracer::meetsBehindGate(const BeamFrame& frame, TraceCounters& cost)
{
  this->Tracer.setBeam(frame);
  const Hit hit = this->Tracer.traceFromApex(frame.axis);
  addCounters(this->Tracer.counters(), cost);
  return hit.valid() && hit.range > this->Gate;
}

/// Find what a beam sees of the candidates at which the search has arrived.
SeenSurfaces ViewTracer::findSurfaces(std::size_t beam, const BeamFrame& frame, TraceCounters& cost)
{
  constexpr double Everywhere = std::numeric_limits<double>::infinity();
  const auto seenWithin = [&](double range) -> SeenSurfaces
  {
    const std::vector<std::uint32_t>& found = this->Candidates.collect(range);
    return found.empty() ? SeenSurfaces(NothingSeen{})
                         : this->Views.find(this->Beams.ids[beam], frame, found, cost);
  };
  if (!(this->Gate < this->Candidates.farthest()))
  {
    return seenWithin(Everywhere);
  }
  SeenSurfaces seen = seenWithin(this->Gate);
  const auto* const cells = std::get_if<std::unique_ptr<CellSamples>>(&seen);
  if (!std::holds_alternative<NothingSeen>(seen) && !(cells && (*cells)->samples.size() == 0))
  {
    return seen;
  }
  return this->meetsBehindGate(frame, cost) ? SeenSurfaces(NothingSeen{ true })
                                            : seenWithin(Everywhere);
}

/// Trace the rays of the beams that need them.
void ViewTracer::traceRays(const std::vector<BeamToSee>& beams, std::vector<SeenBeam>& seen)
{
  const std::uint32_t count = tracedRaysOf(this->Setup.settings);
  this->Numbers.clear();
  for (const std::size_t k : this->TracedRays)
  {
    this->Numbers.push_back(beams[k].beam);
  }
  const TracedBeams block{ this->FramesOfRays.data(), this->FramesOfRays.size(), count, &this->Rays,
    this->Numbers.data() };
  const TracedHits& found = this->Tracer.traceBeams(block, this->Setup.settings.traceMode);
  for (std::size_t n = 0; n < this->TracedRays.size(); ++n)
  {
    const std::size_t k = this->TracedRays[n];
    SeenBeam& one = seen[k];
    addCounters(found.counters[n], one.cost);
    if (const std::uint32_t* const triangles = found.triangles[n])
    {
      this->Triangles.assign(triangles, triangles + count);
      one.view.hits = this->Hits.hitsOf(
        this->FramesOfRays[n], this->Rays.of(beams[k].beam), this->Triangles, one.geometry);
      one.hasGeometry = true;
    }
    else if (beams[k].onlyRays || this->lacksHits(one.view))
    {
      one.view.hits = std::make_unique<BeamSamples>(); // no ray of the beam hits anything
      one.view.hits->rays = count;
    }
  }
}
}
