// SPDX-License-Identifier: BSD-3-Clause
#include "ScanBlock.h"

#include <algorithm>

namespace avianlidar
{
void addCounters(const TraceCounters& more, TraceCounters& sum)
{
  sum.nodesVisited += more.nodesVisited;
  sum.raysTraced += more.raysTraced;
  sum.candidates = std::max(sum.candidates, more.candidates);
}

ScanBlock::ScanBlock(const ScanSetup& setup, const ScanBeams& beams, BeamSampler& sampler)
  : Setup(setup)
  , Width(setup.sensor.halfBeamwidth)
  , Beams(beams)
  , Sampler(sampler)
  , Tracer(*setup.tree, &sampler.order)
  , Polygons(*setup.tree, mostTrianglesIntegrated(setup.settings), MostTrianglesOfCells)
  , Quadrature(setup)
  , Cells(setup)
{
}

void ScanBlock::followSurfaces()
{
  this->Tracer.follow(*this->Setup.tree);
  this->Polygons.follow(*this->Setup.tree);
  this->Finder.forget();
}

void ScanBlock::trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  this->First = begin;
  this->Traces = &traces;
  this->GeometryBeam = NoBeam;
  this->TracerBeam = NoBeam;
  this->Slots.resize(std::max(this->Slots.size(), end - begin));
  this->Frames.clear();
  this->Traced.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    Slot& slot = this->slotOf(beam);
    slot.triangles.clear();
    slot.counters = {};
    slot.framed = slot.drawn = false;
    slot.traced = slot.changed = traces[beam].direct == DirectEcho::Unknown;
    if (slot.traced)
    {
      this->Frames.push_back(this->frameOf(beam));
      this->Traced.push_back(beam);
    }
  }
  if (this->Traced.empty())
  {
    return;
  }
  const bool rays = this->Setup.settings.beamSamples == BeamSampleSource::Rays;
  const auto count = static_cast<std::uint32_t>(this->Setup.settings.raysPerBeam);
  const BeamBlock block{ this->Frames.data(), this->Frames.size(), count,
    [this](std::size_t k) -> const BeamRays& { return this->raysOf(this->Traced[k]); },
    rays ? nullptr : this };
  const BlockHits& found = this->Tracer.traceBlock(block, this->Setup.settings.traceMode);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    Slot& slot = this->slotOf(this->Traced[k]);
    DirectEcho& direct = traces[this->Traced[k]].direct;
    avianlidar::addCounters(found.counters[k], slot.counters);
    if (direct == DirectEcho::Unknown) // if pre-tested: no triangle may meet its group
    {
      direct = rays ? DirectEcho::Rays : DirectEcho::Nothing;
    }
    if (const std::uint32_t* const triangles = found.triangles[k])
    {
      slot.triangles.assign(triangles, triangles + count);
    }
  }
}

void ScanBlock::begin(std::size_t beam)
{
  this->PreTested = this->Traced[beam];
  this->Polygons.begin(this->frameOf(this->PreTested));
}

bool ScanBlock::leaf(const std::uint32_t* triangles, std::uint32_t count)
{
  return this->Polygons.add(triangles, count);
}

/// Choose how the direct echo is found.
bool ScanBlock::end()
{
  const std::size_t beam = this->PreTested;
  BeamTrace& trace = (*this->Traces)[beam];
  const BeamFrame& frame = this->frameOf(beam);
  const SeenByBeam seen = this->Polygons.find(trace.polygons);
  if (seen == SeenByBeam::Polygons)
  {
    if (this->Quadrature.fits(*trace.polygons))
    {
      trace.direct = DirectEcho::Polygons;
      return true;
    }
    trace.polygons.reset();
  }
  const std::vector<PolygonCandidate>& candidates = this->Polygons.candidates();
  trace.cells =
    candidates.empty() ? nullptr : this->Cells.find(this->Beams.ids[beam], frame, candidates);
  if (!trace.cells)
  {
    trace.direct = seen == SeenByBeam::Nothing ? DirectEcho::Nothing : DirectEcho::Rays;
    return trace.direct == DirectEcho::Nothing;
  }
  // Rays from which paths over two reflections start meet what the cells show.
  trace.direct = DirectEcho::Cells;
  Slot& slot = this->slotOf(beam);
  if (!this->Cells.meet(this->raysOf(beam), slot.triangles))
  {
    slot.triangles.clear();
  }
  slot.counters.raysTraced += static_cast<std::uint64_t>(this->Setup.settings.raysPerBeam);
  return true;
}

const BeamFrame& ScanBlock::frameOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (!slot.framed)
  {
    slot.frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
    slot.framed = true;
  }
  return slot.frame;
}

const BeamRays& ScanBlock::raysOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (!slot.drawn)
  {
    this->Sampler.draw(
      this->Setup.sensor, this->Setup.settings.seed, this->Beams.ids[beam], slot.rays);
    slot.drawn = true;
  }
  return slot.rays;
}

void ScanBlock::takeHits(std::size_t beam, BeamTrace& trace)
{
  const std::vector<std::uint32_t>& triangles = this->slotOf(beam).triangles;
  if (!triangles.empty())
  {
    this->makeHits(beam, triangles, trace);
  }
}

/// Make samples of the triangles that the beam's rays hit.
void ScanBlock::makeHits(
  std::size_t beam, const std::vector<std::uint32_t>& triangles, BeamTrace& trace)
{
  trace.hits = std::make_unique<BeamSamples>();
  this->Finder.find(*this->Setup.tree->mesh, this->frameOf(beam), this->raysOf(beam), triangles,
    *trace.hits, this->Geometry);
  this->GeometryBeam = beam;
}

const BeamSamples& ScanBlock::pathStartsOf(std::size_t beam, BeamTrace& trace)
{
  if (!trace.hits)
  {
    const BeamRays& rays = this->raysOf(beam);
    this->Own.resize(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      this->Own[i] = trace.polygons->triangleAt({ rays.x[i], rays.y[i] });
    }
    this->makeHits(beam, this->Own, trace);
    this->markChanged(beam);
  }
  return *trace.hits;
}

const SampleGeometry& ScanBlock::geometryOf(std::size_t beam, const BeamSamples& hits)
{
  if (this->GeometryBeam != beam)
  {
    this->Finder.findAgain(
      *this->Setup.tree->mesh, this->frameOf(beam), this->raysOf(beam), hits, this->Geometry);
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
  avianlidar::addCounters(more, this->slotOf(beam).counters);
}
}
