// SPDX-License-Identifier: BSD-3-Clause
#include "ScanBlock.h"

#include <algorithm>

namespace avianlidar
{
ScanBlock::ScanBlock(
  const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams, BeamSampler& sampler)
  : Setup(setup)
  , Scene(scene)
  , Width(BeamShape(setup.sensor).width())
  , Beams(beams)
  , Sampler(sampler)
  , Tracer(scene)
  , Finder(scene)
  , Views(setup, scene, this->Tracer)
{
}

std::size_t ScanBlock::trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces,
  const std::function<bool(std::size_t)>& leaveOut)
{
  this->First = begin;
  this->GeometryBeam = NoBeam;
  this->TracerBeam = NoBeam;
  this->BeamStates.resize(std::max(this->BeamStates.size(), end - begin));
  this->Frames.clear();
  this->Traced.clear();
  this->FramesOfRays.clear();
  this->TracedRays.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    BeamState& slot = this->stateOf(beam);
    slot.triangles.clear();
    slot.counters = {};
    slot.frame.reset();
    slot.rays.resize(0);
    const BeamTrace& known = traces[beam];
    const bool lacks = known.direct() == DirectEcho::Unknown || this->needsPathStarts(known);
    if (lacks && !(leaveOut && leaveOut(beam)))
    {
      this->Frames.push_back(this->frameOf(beam));
      this->Traced.push_back(beam);
    }
  }
  if (this->Setup.settings.beamSamples == BeamSampleSource::Rays)
  {
    for (const std::size_t beam : this->Traced)
    {
      traces[beam].view = RayView{};
    }
    this->FramesOfRays = this->Frames;
    this->TracedRays = this->Traced;
  }
  else
  {
    this->findViews(traces);
  }
  this->traceRays();
  for (const std::size_t beam : this->Traced)
  {
    if (this->needsPathStarts(traces[beam]) && this->stateOf(beam).triangles.empty())
    {
      traces[beam].hits = std::make_unique<BeamSamples>(); // none of its rays hits anything
      traces[beam].hits->rays = tracedRaysOf(this->Setup.settings);
    }
  }
  return this->Traced.size();
}

/// True if paths over two reflections may start from the untraced rays of a beam in cells.
bool ScanBlock::needsPathStarts(const BeamTrace& trace) const
{
  return trace.cells() && !trace.hits && this->Setup.settings.numberOfReflections > 1;
}

/// Find the views of the beams being traced, and which of them need rays.
void ScanBlock::findViews(std::vector<BeamTrace>& traces)
{
  for (const std::size_t beam : this->Traced)
  {
    if (traces[beam].direct() == DirectEcho::Unknown)
    {
      traces[beam].view = EmptyView{};
    }
  }
  this->Candidates.begin(this->Scene, this->Frames.data(), this->Frames.size(),
    this->Setup.settings.traceMode == TraceMode::Automatic);
  while (this->Candidates.next())
  {
    const std::size_t beam = this->Traced[this->Candidates.beam()];
    BeamState& slot = this->stateOf(beam);
    slot.counters.nodesVisited += this->Candidates.nodesVisited();
    BeamTrace& trace = traces[beam];
    trace.view = this->Views.find(
      this->Beams.ids[beam], *slot.frame, this->Candidates.triangles(), slot.counters);
    if (trace.direct() == DirectEcho::Rays || this->needsPathStarts(trace))
    {
      this->FramesOfRays.push_back(*slot.frame);
      this->TracedRays.push_back(beam);
    }
  }
}

/// Trace the rays of the beams that need them.
void ScanBlock::traceRays()
{
  const std::uint32_t count = tracedRaysOf(this->Setup.settings);
  const BeamBlock block{ this->FramesOfRays.data(), this->FramesOfRays.size(), count,
    [this](std::size_t k) -> const BeamRays& { return this->raysOf(this->TracedRays[k]); } };
  const BlockHits& found = this->Tracer.traceBlock(block, this->Setup.settings.traceMode);
  for (std::size_t k = 0; k < this->TracedRays.size(); ++k)
  {
    BeamState& slot = this->stateOf(this->TracedRays[k]);
    avianlidar::addCounters(found.counters[k], slot.counters);
    if (const std::uint32_t* const triangles = found.triangles[k])
    {
      slot.triangles.assign(triangles, triangles + count);
    }
  }
}

const BeamFrame& ScanBlock::frameOf(std::size_t beam)
{
  BeamState& slot = this->stateOf(beam);
  if (!slot.frame)
  {
    slot.frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
  }
  return *slot.frame;
}

const BeamRays& ScanBlock::raysOf(std::size_t beam)
{
  BeamState& slot = this->stateOf(beam);
  if (slot.rays.size() == 0)
  {
    this->Sampler.draw(this->Setup.settings.seed, this->Beams.ids[beam], slot.rays);
  }
  return slot.rays;
}

void ScanBlock::takeHits(std::size_t beam, BeamTrace& trace)
{
  const std::vector<std::uint32_t>& triangles = this->stateOf(beam).triangles;
  if (!triangles.empty())
  {
    this->makeHits(beam, triangles, trace);
  }
}

/// Make samples of the hits of the beam's rays. @param triangles nearest triangle of each ray
void ScanBlock::makeHits(
  std::size_t beam, const std::vector<std::uint32_t>& triangles, BeamTrace& trace)
{
  trace.hits = std::make_unique<BeamSamples>();
  this->Finder.find(
    this->frameOf(beam), this->raysOf(beam), triangles, *trace.hits, this->Geometry);
  this->GeometryBeam = beam;
  if (haveVolumes(this->Setup.media))
  {
    const BeamRays& rays = this->raysOf(beam);
    for (const std::uint32_t ray : trace.hits->ray)
    {
      trace.hits->columns.push_back(BeamAir::columnAt(rays.x[ray], rays.y[ray]));
    }
  }
}

const BeamSamples& ScanBlock::pathStartsOf(std::size_t beam, BeamTrace& trace)
{
  if (!trace.hits)
  {
    const BeamRays& rays = this->raysOf(beam);
    this->Own.resize(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      this->Own[i] = trace.polygons()->triangleAt({ rays.x[i], rays.y[i] });
    }
    this->makeHits(beam, this->Own, trace);
  }
  return *trace.hits;
}

const SampleGeometry& ScanBlock::geometryOf(std::size_t beam, const BeamSamples& hits)
{
  if (this->GeometryBeam != beam)
  {
    this->Finder.findAgain(this->frameOf(beam), this->raysOf(beam), hits, this->Geometry);
    this->GeometryBeam = beam;
  }
  return this->Geometry;
}

BeamTracer& ScanBlock::tracerOf(std::size_t beam)
{
  if (this->TracerBeam != beam)
  {
    this->Tracer.setBeam(this->frameOf(beam));
    this->TracerBeam = beam;
  }
  return this->Tracer;
}

void ScanBlock::addCounters(std::size_t beam, const TraceCounters& more)
{
  avianlidar::addCounters(more, this->stateOf(beam).counters);
}
}
