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

ScanBlock::ScanBlock(const ScanSetup& setup, const ScanBeams& beams, BeamSamplers& samplers)
  : Setup(setup)
  , Beams(beams)
  , Samplers(samplers)
  , Tracer(*setup.tree, setup.settings.precision)
  , Budget(setup, samplers)
  , Patches(*setup.tree)
  , Quadrature(setup)
{
}

void ScanBlock::beginBlock(std::size_t begin, std::size_t end, const std::vector<BeamTrace>& traces)
{
  this->First = begin;
  this->GeometryBeam = NoBeam;
  this->TracerBeam = NoBeam;
  if (this->Slots.size() < end - begin)
  {
    this->Slots.resize(end - begin);
  }
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    Slot& slot = this->slotOf(beam);
    slot.framed = false;
    slot.changed = false;
    slot.raysDrawn = 0;
    slot.triangles.clear();
    slot.counters = {};
    const BeamTrace& trace = traces[beam];
    slot.patch.reset();
    slot.surveyed = false;
    slot.surveyMissing = this->Setup.settings.planeIntegration && !trace.surveyed;
    slot.integrated = trace.patch && this->Quadrature.fits(this->frameOf(beam), *trace.patch);
  }
}

bool ScanBlock::begin(std::size_t beam)
{
  this->Surveyed = &this->slotOf(this->Traced[beam]);
  if (this->Surveyed->surveyMissing)
  {
    this->Patches.begin(this->Surveyed->frame);
  }
  return this->Surveyed->surveyMissing;
}

bool ScanBlock::leaf(const std::uint32_t* triangles, std::uint32_t count)
{
  return this->Patches.add(triangles, count);
}

bool ScanBlock::end()
{
  Slot& slot = *this->Surveyed;
  slot.patch = this->Patches.find();
  slot.integrated = slot.patch && this->Quadrature.fits(slot.frame, *slot.patch);
  return slot.integrated;
}

void ScanBlock::trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  const EchoSettings& settings = this->Setup.settings;
  this->beginBlock(begin, end, traces);
  const bool target = settings.targetRelativeError > 0.0;
  if (target)
  {
    this->tracePilots(begin, end, traces);
  }
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    const BeamTrace& trace = traces[beam];
    Slot& slot = this->slotOf(beam);
    slot.raysWanted = target && !slot.integrated ? this->Budget.raysFor(*trace.pilot)
                                                 : static_cast<std::uint32_t>(settings.raysPerBeam);
    slot.raysMissing = slot.integrated || trace.rays == slot.raysWanted ? 0 : slot.raysWanted;
  }
  this->tracePrimary(begin, end, RandomPurpose::Rays);
}

/// Pilots of the beams that have none yet.
void ScanBlock::tracePilots(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    Slot& slot = this->slotOf(beam);
    slot.raysMissing = slot.integrated || traces[beam].pilot ? 0 : PilotRays;
  }
  this->tracePrimary(begin, end, RandomPurpose::Pilot);
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    BeamTrace& trace = traces[beam];
    if (trace.pilot || this->slotOf(beam).integrated)
    {
      continue;
    }
    trace.pilot = std::make_unique<PrimaryHits>();
    trace.pilot->rays = PilotRays;
    Slot& slot = this->slotOf(beam);
    slot.changed = true;
    if (!slot.triangles.empty())
    {
      this->Finder.find(*this->Setup.tree->mesh, slot.frame,
        this->raysOf(beam, PilotRays, RandomPurpose::Pilot), slot.triangles, *trace.pilot,
        this->Geometry);
      slot.triangles.clear();
    }
  }
}

const BeamFrame& ScanBlock::frameOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (!slot.framed)
  {
    slot.frame = makeBeamFrame(
      this->Beams.origins[beam], this->Beams.directions[beam], this->Setup.sensor.halfBeamwidth);
    slot.framed = true;
  }
  return slot.frame;
}

const BeamRays& ScanBlock::raysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose)
{
  Slot& slot = this->slotOf(beam);
  if (slot.raysDrawn != rays || slot.purpose != purpose)
  {
    sampleBeam(this->Setup.settings.seed, this->Beams.ids[beam], rays,
      this->Setup.sensor.halfBeamwidth, this->Setup.sensor.beamProfile,
      this->Setup.settings.sampling, &this->Samplers.of(rays).strata, purpose, slot.rays);
    slot.raysDrawn = rays;
    slot.purpose = purpose;
  }
  return slot.rays;
}

/// The triangles of the missing rays of beams [begin, end); they are drawn only where the beam may
/// meet anything.
void ScanBlock::tracePrimary(std::size_t begin, std::size_t end, RandomPurpose purpose)
{
  this->Frames.clear();
  this->Missing.clear();
  this->Traced.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    if (const std::uint32_t rays = this->slotOf(beam).raysMissing)
    {
      this->Frames.push_back(this->frameOf(beam));
      this->Missing.push_back(rays);
      this->Traced.push_back(beam);
    }
  }
  if (this->Traced.empty())
  {
    return;
  }
  const BeamBlock block{ this->Frames.data(), this->Frames.size(), this->Missing.data(),
    [&](std::size_t k) -> const BeamRays&
    { return this->raysOf(this->Traced[k], this->Missing[k], purpose); },
    this->Setup.settings.planeIntegration ? this : nullptr };
  const BlockHits& found = this->Tracer.traceBlock(block,
    this->Setup.settings.batchCollisionDetection ? TraceMode::Automatic : TraceMode::SingleRays);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    Slot& slot = this->slotOf(this->Traced[k]);
    avianlidar::addCounters(found.counters[k], slot.counters);
    slot.surveyed = slot.surveyed || slot.surveyMissing;
    slot.surveyMissing = false;
    if (const Hit* const hits = found.hits[k])
    {
      slot.triangles.resize(this->Missing[k]);
      std::transform(hits, hits + this->Missing[k], slot.triangles.begin(),
        [](const Hit& hit) { return hit.triangle; });
    }
  }
}

void ScanBlock::takeHits(std::size_t beam, BeamTrace& trace)
{
  Slot& slot = this->slotOf(beam);
  if (slot.surveyed)
  {
    slot.changed = true;
    trace.surveyed = true;
    trace.patch = std::move(slot.patch);
  }
  if (slot.integrated || trace.rays == slot.raysWanted)
  {
    return;
  }
  slot.changed = true;
  trace.rays = slot.raysWanted;
  trace.hits.reset();
  trace.strengths.reset();
  trace.secondary.reset();
  trace.counters = {};
  if (slot.triangles.empty())
  {
    return;
  }
  trace.hits = std::make_unique<PrimaryHits>();
  this->Finder.find(*this->Setup.tree->mesh, slot.frame,
    this->raysOf(beam, trace.rays, RandomPurpose::Rays), slot.triangles, *trace.hits,
    this->Geometry);
  this->GeometryBeam = beam;
}

const HitGeometry& ScanBlock::geometryOf(std::size_t beam, const PrimaryHits& hits)
{
  if (this->GeometryBeam != beam)
  {
    this->Finder.findAgain(
      *this->Setup.tree->mesh, this->frameOf(beam), this->raysOf(beam, hits), hits, this->Geometry);
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
