// SPDX-License-Identifier: BSD-3-Clause
#include "ScanBlock.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// @param cells null if they have too many strips: rays take their place @return false then
bool seeCells(std::unique_ptr<CellSamples> cells, BeamTrace& trace)
{
  const bool fits = cells != nullptr;
  trace.view = fits ? BeamView(std::move(cells)) : BeamView(RaysAlone{});
  return fits;
}
}

void addCounters(const TraceCounters& more, TraceCounters& sum)
{
  sum.nodesVisited += more.nodesVisited;
  sum.raysTraced += more.raysTraced;
  sum.candidates = std::max(sum.candidates, more.candidates);
}

ScanBlock::ScanBlock(const ScanSetup& setup, const ScanBeams& beams, BeamSampler& sampler)
  : Setup(setup)
  , Width(BeamShape(setup.sensor).width())
  , Beams(beams)
  , Sampler(sampler)
  , Tracer(*setup.tree)
  , Polygons(*setup.tree, this->Width.isRound ? mostTrianglesIntegrated(setup.settings) : 0,
      MostTrianglesOfCells)
  , Quadrature(setup)
  , Cells(setup)
{
}

void ScanBlock::followSurfaces()
{
  this->Tracer.follow(*this->Setup.tree);
  this->Polygons.follow(*this->Setup.tree);
  this->Cells.followSurfaces();
  this->Finder.forget();
}

std::size_t ScanBlock::trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  this->First = begin;
  this->Traces = &traces;
  this->GeometryBeam = NoBeam;
  this->TracerBeam = NoBeam;
  this->Slots.resize(std::max(this->Slots.size(), end - begin));
  this->Frames.clear();
  this->Traced.clear();
  this->Crowded.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    Slot& slot = this->slotOf(beam);
    slot.triangles.clear();
    slot.counters = {};
    slot.frame.reset();
    slot.rays.resize(0);
    const BeamTrace& known = traces[beam];
    if (known.direct() == DirectEcho::Unknown || this->lacksStarts(known))
    {
      this->Frames.push_back(this->frameOf(beam));
      this->Traced.push_back(beam);
    }
  }
  if (this->Traced.empty())
  {
    return 0;
  }
  const bool rays = this->Setup.settings.beamSamples == BeamSampleSource::Rays;
  const std::uint32_t count = tracedRaysOf(this->Setup.settings);
  const BeamBlock block{ this->Frames.data(), this->Frames.size(), count,
    [this](std::size_t k) -> const BeamRays& { return this->raysOf(this->Traced[k]); },
    rays ? nullptr : this };
  const BlockHits& found = this->Tracer.traceBlock(block, this->Setup.settings.traceMode);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    Slot& slot = this->slotOf(this->Traced[k]);
    BeamTrace& trace = traces[this->Traced[k]];
    avianlidar::addCounters(found.counters[k], slot.counters);
    if (trace.direct() == DirectEcho::Unknown) // if pre-tested: no triangle may meet its group
    {
      trace.view = rays ? BeamView(RaysAlone{}) : BeamView(NoSurfaces{});
    }
    if (const std::uint32_t* const triangles = found.triangles[k])
    {
      slot.triangles.assign(triangles, triangles + count);
    }
  }
  this->traceCells();
  for (const std::size_t beam : this->Traced)
  {
    if (this->lacksStarts(traces[beam]) && this->slotOf(beam).triangles.empty())
    {
      traces[beam].hits = std::make_unique<BeamSamples>(); // no path starts
      traces[beam].hits->rays = count;
    }
  }
  return this->Traced.size();
}

/// True if paths over two reflections may start from the rays of a beam in cells, and those are not
/// known.
bool ScanBlock::lacksStarts(const BeamTrace& trace) const
{
  return trace.cells() && !trace.hits && this->Setup.settings.numberOfReflections > 1;
}

/// Trace the N rays of a beam.
void ScanBlock::traceRays(std::size_t beam)
{
  const BeamRays& rays = this->raysOf(beam);
  const BlockHits& found = this->traceAll(beam, rays, false);
  if (const std::uint32_t* const triangles = found.triangles[0])
  {
    this->slotOf(beam).triangles.assign(triangles, triangles + rays.size());
  }
}

/// Trace some rays of a beam.
const BlockHits& ScanBlock::traceAll(std::size_t beam, const BeamRays& rays, bool inOrder)
{
  const BeamBlock block{ &this->frameOf(beam), 1, static_cast<std::uint32_t>(rays.size()),
    [&rays](std::size_t) -> const BeamRays& { return rays; }, nullptr, inOrder };
  const BlockHits& found = this->Tracer.traceBlock(block, this->Setup.settings.traceMode);
  avianlidar::addCounters(found.counters[0], this->slotOf(beam).counters);
  return found;
}

/// Trace the rays of the cells of beams that too many triangles enter for lists.
void ScanBlock::traceCells()
{
  for (CrowdedBeam& crowded : this->Crowded)
  {
    BeamTrace& trace = (*this->Traces)[crowded.beam];
    const BeamFrame& frame = this->frameOf(crowded.beam);
    const BeamRays& rays =
      this->Cells.place(this->Beams.ids[crowded.beam], frame, crowded.triangles);
    const BlockHits& found = this->traceAll(crowded.beam, rays, true);
    const std::uint32_t* const triangles = found.triangles[0];
    if (!seeCells(triangles ? this->Cells.find(triangles) : std::make_unique<CellSamples>(), trace))
    {
      this->traceRays(crowded.beam);
    }
  }
}

void ScanBlock::begin(std::size_t beam)
{
  this->PreTested = this->Traced[beam];
  this->Polygons.begin(this->frameOf(this->PreTested));
}

void ScanBlock::leaf(const std::uint32_t* triangles, std::uint32_t count)
{
  this->Polygons.add(triangles, count);
}

/// Choose how the direct echo is found.
bool ScanBlock::end()
{
  const std::size_t beam = this->PreTested;
  BeamTrace& trace = (*this->Traces)[beam];
  const BeamFrame& frame = this->frameOf(beam);
  std::unique_ptr<VisiblePolygons> polygons;
  const SeenByBeam seen = this->Polygons.find(polygons);
  if (seen == SeenByBeam::Polygons && !this->meetsBorders(frame) &&
    this->Quadrature.fits(*polygons))
  {
    trace.view = std::move(polygons);
    return true;
  }
  if (seen == SeenByBeam::Nothing)
  {
    trace.view = NoSurfaces{};
    return true;
  }
  const std::vector<const BeamSurface*>& candidates = this->Polygons.candidates();
  if (candidates.empty())
  {
    this->Numbers.clear();
    this->Polygons.entering().appendNumbers(this->Numbers);
    this->Cells.leaveSmallObjects(this->Beams.ids[beam], frame, this->Numbers);
    this->Crowded.push_back({ beam, this->Numbers });
    trace.view = std::make_unique<CellSamples>(); // until its rays are traced
    return this->Setup.settings.numberOfReflections == 1;
  }
  return seeCells(this->Cells.find(this->Beams.ids[beam], frame, candidates), trace) &&
    this->Setup.settings.numberOfReflections == 1;
}

/// True if a border of a medium may lie in a beam: samples of polygons do not say in which part of
/// the beam they lie. What moves may be anywhere.
bool ScanBlock::meetsBorders(const BeamFrame& frame) const
{
  const std::vector<PlacedMedium>& media = this->Setup.placedMedia;
  return std::any_of(media.begin(), media.end(),
    [&](const PlacedMedium& placed)
    {
      return placed.volume.velocity != Vec3(0.0) ||
        mayMeetBorder(placed.volume, frame, this->Setup.sensor.rangeGate);
    });
}

const BeamFrame& ScanBlock::frameOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (!slot.frame)
  {
    slot.frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
  }
  return *slot.frame;
}

const BeamRays& ScanBlock::raysOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (slot.rays.size() == 0)
  {
    this->Sampler.draw(this->Setup.settings.seed, this->Beams.ids[beam], slot.rays);
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
  this->Finder.find(*this->Setup.tree, this->frameOf(beam), this->raysOf(beam), triangles,
    *trace.hits, this->Geometry);
  this->GeometryBeam = beam;
  if (!this->Setup.placedMedia.empty())
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
    this->Finder.findAgain(
      *this->Setup.tree, this->frameOf(beam), this->raysOf(beam), hits, this->Geometry);
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
