// SPDX-License-Identifier: BSD-3-Clause
#include "ScanBlock.h"

#include "Random.h"

#include <algorithm>

namespace avianlidar
{
void addCounters(const TraceCounters& more, TraceCounters& sum)
{
  sum.nodesVisited += more.nodesVisited;
  sum.raysTraced += more.raysTraced;
  sum.candidates = std::max(sum.candidates, more.candidates);
}

ScanBlock::ScanBlock(
  const ScanSetup& setup, const ScanBeams& beams, std::uint32_t light, BeamSamplers& samplers)
  : Setup(setup)
  , Width(setup.sensor.halfBeamwidth)
  , Beams(beams)
  , Light(light)
  , Samplers(samplers)
  , Tracer(*setup.tree, &samplers.order)
  , Budget(setup, samplers)
  , Polygons(*setup.tree, mostTrianglesIntegrated(setup.settings),
      usesCells(setup.settings) ? MostTrianglesOfCells : 0)
  , Quadrature(setup)
  , Cells(setup)
  , Targets(setup, samplers)
  , Integrates(mostTrianglesIntegrated(setup.settings) > 0)
  , UsesCells(usesCells(setup.settings))
  , Refines(refinesNearLimit(setup.settings))
{
}

void ScanBlock::followSurfaces()
{
  this->Tracer.follow(*this->Setup.tree);
  this->Polygons.follow(*this->Setup.tree);
  this->Finder.forget();
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
    slot.targets.clear();
    slot.first.reset();
    slot.firstTraced = false;
    slot.counters = {};
    const BeamTrace& trace = traces[beam];
    slot.polygons.reset();
    slot.cells.reset();
    slot.preTested = false;
    slot.seen = this->Integrates ? trace.seen : SeenByBeam::TooMuch;
    slot.lit = trace.lit && trace.lit->light == this->Light;
    slot.integrated = slot.seen == SeenByBeam::Polygons &&
      (slot.lit ? trace.rays == 0 : this->fits(this->frameOf(beam), *trace.polygons));
    slot.inCells = !slot.integrated && trace.cells && !this->Cells.isSharp(*trace.cells);
    if (this->UsesCells && slot.seen == SeenByBeam::Polygons && !slot.integrated && !trace.cells)
    {
      slot.seen = SeenByBeam::Unknown; // they fitted with other materials
    }
  }
}

/// True if polygons can be integrated.
bool ScanBlock::fits(const BeamFrame& frame, const VisiblePolygons& seen)
{
  this->Quadrature.begin(frame, seen);
  return this->Quadrature.fits();
}

bool ScanBlock::begin(std::size_t beam)
{
  this->PreTested = &this->slotOf(this->Traced[beam]);
  this->PreTestedBeam = this->Traced[beam];
  if (this->PreTested->seen != SeenByBeam::Unknown)
  {
    return false;
  }
  this->PreTested->preTested = true;
  this->PreTested->seen = SeenByBeam::TooMuch;
  this->Polygons.begin(this->PreTested->frame);
  return true;
}

bool ScanBlock::leaf(const std::uint32_t* triangles, std::uint32_t count)
{
  return this->Polygons.add(triangles, count);
}

bool ScanBlock::end()
{
  Slot& slot = *this->PreTested;
  slot.seen = this->Polygons.find(slot.polygons);
  slot.integrated = slot.seen == SeenByBeam::Polygons && this->fits(slot.frame, *slot.polygons);
  if (this->UsesCells && !slot.integrated && !this->Polygons.candidates().empty())
  {
    this->findCells(slot);
  }
  return slot.integrated || slot.inCells || slot.seen == SeenByBeam::Nothing;
}

/// Divide the beam being pre-tested into cells; its rays, from which paths over two reflections
/// start, meet what the cells show.
void ScanBlock::findCells(Slot& slot)
{
  const std::size_t beam = this->PreTestedBeam;
  slot.cells = this->Cells.find(this->Beams.ids[beam], slot.frame, this->Polygons.candidates());
  slot.inCells = slot.cells && !this->Cells.isSharp(*slot.cells);
  if (!slot.inCells)
  {
    return;
  }
  const auto rays = static_cast<std::uint32_t>(this->Setup.settings.raysPerBeam);
  if (!this->Cells.meet(this->raysOf(beam, rays, RandomPurpose::Rays), slot.triangles))
  {
    slot.triangles.clear();
  }
  slot.counters.raysTraced += rays;
}

/// True if the hits of the beam are those of the rays that it needs now.
bool ScanBlock::isKnown(std::size_t beam, const BeamTrace& trace)
{
  Slot& slot = this->slotOf(beam);
  if (slot.integrated || trace.rays != slot.raysWanted)
  {
    return slot.integrated;
  }
  if (slot.inCells)
  {
    return slot.raysMissing == 0 && !slot.firstTraced && !trace.targets;
  }
  if (this->Setup.settings.targetRelativeError > 0.0 || this->Refines)
  {
    const std::size_t targets = trace.targets ? trace.targets->size() : 0;
    return !slot.firstTraced && targets == slot.targets.wanted.size() &&
      (targets == 0 || *trace.targets == slot.targets.wanted);
  }
  return this->haveTargetsStayed(beam, trace);
}

/// True if the beam has the same small targets as when it was traced. Objects and number of rays
/// are the same by the key of the traces.
bool ScanBlock::haveTargetsStayed(std::size_t beam, const BeamTrace& trace)
{
  return trace.smallestTarget == this->Setup.needs.smallestTarget ||
    (trace.targets ? trace.targets->size() : 0) == this->targetsOf(beam).cones.size();
}

/// True if the hits of the beam's first N rays are known.
bool ScanBlock::isFirstKnown(std::size_t beam, const BeamTrace& trace)
{
  const Slot& slot = this->slotOf(beam);
  if (slot.inCells)
  {
    return trace.rays == slot.raysWanted && !trace.targets;
  }
  return slot.integrated || (trace.rays > 0 && this->haveTargetsStayed(beam, trace));
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
    if (slot.lit)
    {
      slot.raysWanted = trace.rays;
      slot.raysMissing = 0;
      slot.targets.wanted = trace.targets ? *trace.targets : TargetRays();
      continue;
    }
    slot.raysWanted = target && !slot.integrated
      ? this->Budget.raysFor(*trace.pilot, slot.targets.wanted)
      : static_cast<std::uint32_t>(settings.raysPerBeam);
    const bool known = this->Refines ? this->isFirstKnown(beam, trace) : this->isKnown(beam, trace);
    slot.raysMissing = known ? 0 : slot.raysWanted;
  }
  this->tracePrimary(begin, end, RandomPurpose::Rays);
  if (this->Setup.objects)
  {
    this->traceTargets(begin, end, RandomPurpose::Rays);
  }
  if (this->Refines)
  {
    this->refine(begin, end, traces);
  }
}

/// Trace more rays for beams whose first N do not decide whether an echo exceeds Qlow. The first N
/// are kept as the pilot, which decides again under other limits.
void ScanBlock::refine(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  bool any = false;
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    Slot& slot = this->slotOf(beam);
    const BeamTrace& trace = traces[beam];
    const std::uint32_t usual = slot.raysWanted;
    slot.firstTraced = slot.raysMissing > 0;
    slot.raysMissing = 0;
    if (slot.integrated || slot.lit || slot.inCells)
    {
      continue;
    }
    if (!slot.triangles.empty())
    {
      slot.first = std::make_unique<BeamSamples>();
      this->makeHits(beam, usual, RandomPurpose::Rays, *slot.first);
      slot.triangles.clear();
    }
    const BeamSamples* first = slot.firstTraced ? slot.first.get()
      : trace.pilot                             ? trace.pilot.get()
                                                : trace.hits.get();
    const std::size_t targets = slot.firstTraced ? this->targetsOf(beam).cones.size()
      : trace.targets                            ? trace.targets->size()
                                                 : 0;
    if (first)
    {
      slot.raysWanted = this->Budget.raysFor(*first, slot.targets.wanted);
    }
    slot.targets.wanted.resize(targets, RaysOfTarget);
    slot.targets.shares.clear();
    const bool enough =
      slot.raysWanted == usual && sumOf(slot.targets.wanted) == RaysOfTarget * targets;
    slot.raysMissing = enough || this->isKnown(beam, trace) ? 0 : slot.raysWanted;
    any = any || slot.raysMissing > 0;
  }
  if (any)
  {
    this->tracePrimary(begin, end, RandomPurpose::Rays);
    if (this->Setup.objects)
    {
      this->traceTargets(begin, end, RandomPurpose::Rays);
    }
  }
}

/// True if the beam has a pilot, for the same small targets.
bool ScanBlock::isPilotKnown(std::size_t beam, const BeamTrace& trace)
{
  return trace.pilot &&
    (trace.smallestTarget == this->Setup.needs.smallestTarget ||
      trace.pilot->extraRays == PilotRays * this->targetsOf(beam).cones.size());
}

/// Trace the pilots of the beams that have none yet.
void ScanBlock::tracePilots(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    Slot& slot = this->slotOf(beam);
    slot.raysMissing =
      slot.integrated || slot.lit || this->isPilotKnown(beam, traces[beam]) ? 0 : PilotRays;
  }
  this->tracePrimary(begin, end, RandomPurpose::Pilot);
  if (this->Setup.objects)
  {
    this->traceTargets(begin, end, RandomPurpose::Pilot);
  }
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    BeamTrace& trace = traces[beam];
    Slot& slot = this->slotOf(beam);
    if (slot.raysMissing == 0 || slot.integrated)
    {
      continue;
    }
    trace.pilot = std::make_unique<BeamSamples>();
    trace.pilot->rays = PilotRays;
    slot.changed = true;
    if (!slot.triangles.empty())
    {
      this->makeHits(beam, PilotRays, RandomPurpose::Pilot, *trace.pilot);
      slot.triangles.clear();
    }
    // Also where none met anything: the number says for how many targets the pilot is.
    trace.pilot->extraRays =
      static_cast<std::uint32_t>(PilotRays * this->targetsOf(beam).cones.size());
  }
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

const BeamRays& ScanBlock::raysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose)
{
  Slot& slot = this->slotOf(beam);
  if (slot.raysDrawn != rays || slot.purpose != purpose)
  {
    this->Samplers.of(rays).draw(
      this->Setup.sensor, this->Setup.settings.seed, this->Beams.ids[beam], purpose, slot.rays);
    slot.raysDrawn = rays;
    slot.purpose = purpose;
  }
  return slot.rays;
}

/// Find the triangles of the missing rays of beams [begin, end). Rays are drawn only where the beam
/// may meet anything.
void ScanBlock::tracePrimary(std::size_t begin, std::size_t end, RandomPurpose purpose)
{
  this->Frames.clear();
  this->Missing.clear();
  this->Traced.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    const std::uint32_t rays = this->slotOf(beam).raysMissing;
    if (rays > 0 && this->slotOf(beam).seen != SeenByBeam::Nothing)
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
  const BlockHits& found = this->traceBeams([&](std::size_t k) -> const BeamRays&
    { return this->raysOf(this->Traced[k], this->Missing[k], purpose); },
    this->Integrates ? this : nullptr);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    Slot& slot = this->slotOf(this->Traced[k]);
    if (this->Integrates && slot.seen == SeenByBeam::Unknown) // no triangle may meet its group
    {
      slot.preTested = true;
      slot.seen = SeenByBeam::Nothing;
    }
    if (const std::uint32_t* const triangles = found.triangles[k])
    {
      slot.triangles.assign(triangles, triangles + this->Missing[k]);
    }
  }
}

/// Trace rays of the beams in Traced, and count their costs. @param inOrder see BeamBlock
const BlockHits& ScanBlock::traceBeams(
  const std::function<const BeamRays&(std::size_t)>& source, BeamPreTest* preTest, bool inOrder)
{
  const BeamBlock block{ this->Frames.data(), this->Frames.size(), this->Missing.data(), source,
    preTest, inOrder };
  const BlockHits& found = this->Tracer.traceBlock(block, this->Setup.settings.traceMode);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    avianlidar::addCounters(found.counters[k], this->slotOf(this->Traced[k]).counters);
  }
  return found;
}

void ScanBlock::takeHits(std::size_t beam, BeamTrace& trace)
{
  Slot& slot = this->slotOf(beam);
  if (slot.preTested)
  {
    slot.changed = true;
    trace.seen = slot.seen;
    trace.polygons = std::move(slot.polygons);
    trace.cells = std::move(slot.cells);
  }
  if (slot.integrated && trace.rays != 0)
  {
    slot.changed = true;
    trace.rays = 0;
    trace.counters = {};
    trace.targets.reset();
    trace.hits.reset();
    trace.pilot.reset();
    trace.secondary.reset();
    trace.throughput.reset();
  }
  const bool known = this->isKnown(beam, trace);
  if (slot.inCells)
  {
    trace.targetsLeftOut = 0;
    trace.smallestTarget = -1.0;
  }
  else if (!slot.integrated && trace.smallestTarget != this->Setup.needs.smallestTarget)
  {
    trace.targetsLeftOut = this->targetsOf(beam).leftOut;
    trace.smallestTarget = this->Setup.needs.smallestTarget;
  }
  if (known)
  {
    return;
  }
  slot.changed = true;
  trace.rays = slot.raysWanted;
  TargetRays targets = this->raysOfTargets(beam, RandomPurpose::Rays);
  trace.targets = targets.empty() ? nullptr : std::make_unique<TargetRays>(std::move(targets));
  trace.throughput.reset();
  trace.secondary.reset();
  if (this->Refines)
  {
    std::unique_ptr<BeamSamples>& known = trace.pilot ? trace.pilot : trace.hits;
    std::unique_ptr<BeamSamples> first = std::move(slot.firstTraced ? slot.first : known);
    trace.pilot.reset();
    trace.hits.reset();
    (slot.raysMissing > 0 ? trace.pilot : trace.hits) = std::move(first);
  }
  else
  {
    trace.hits.reset();
  }
  if (!this->Refines || slot.firstTraced)
  {
    trace.counters = {};
  }
  if (!slot.triangles.empty())
  {
    trace.hits = std::make_unique<BeamSamples>();
    this->makeHits(beam, trace.rays, RandomPurpose::Rays, *trace.hits);
    this->GeometryBeam = beam;
    if (this->Refines)
    {
      this->thinPaths(beam, *trace.hits);
    }
  }
}

/// Leave about as many paths over two reflections as N rays have: more rays serve the direct echo.
void ScanBlock::thinPaths(std::size_t beam, BeamSamples& samples) const
{
  const EchoSettings& settings = this->Setup.settings;
  samples.pathStep = samples.rays / static_cast<std::uint32_t>(settings.raysPerBeam);
  const double u =
    uniformPair(settings.seed, this->Beams.ids[beam], 0, RandomPurpose::PathPhase)[0];
  samples.pathPhase = static_cast<std::uint32_t>(u * samples.pathStep);
}

const BeamSamples& ScanBlock::pathStartsOf(std::size_t beam, BeamTrace& trace)
{
  if (!trace.hits)
  {
    Slot& slot = this->slotOf(beam);
    const auto count = static_cast<std::uint32_t>(this->Setup.settings.raysPerBeam);
    this->frameOf(beam);
    const BeamRays& rays = this->raysOf(beam, count, RandomPurpose::Rays);
    this->Own.resize(count);
    for (std::uint32_t i = 0; i < count; ++i)
    {
      this->Own[i] = trace.polygons->triangleAt({ rays.x[i], rays.y[i] });
    }
    trace.hits = std::make_unique<BeamSamples>();
    this->Finder.find(
      *this->Setup.tree->mesh, slot.frame, rays, this->Own, *trace.hits, this->Geometry);
    this->GeometryBeam = beam;
    slot.changed = true;
  }
  return *trace.hits;
}

const SampleGeometry& ScanBlock::geometryOf(std::size_t beam, const BeamSamples& samples)
{
  if (this->GeometryBeam != beam)
  {
    const BeamRays& rays = samples.extraRays > 0
      ? this->allRaysOf(beam, samples.rays, RandomPurpose::Rays)
      : this->raysOf(beam, samples.rays, RandomPurpose::Rays);
    this->Finder.findAgain(
      *this->Setup.tree->mesh, this->frameOf(beam), rays, samples, this->Geometry);
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

/// The beam's small targets, found when they are first needed.
const BeamTargets& ScanBlock::targetsOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (!slot.targets.found && this->Setup.objects && !slot.integrated && !slot.inCells)
  {
    this->Targets.find(this->frameOf(beam), slot.targets);
  }
  return slot.targets;
}

/// The number of rays of each small target of the beam, in the order of its sampling cones.
TargetRays ScanBlock::raysOfTargets(std::size_t beam, RandomPurpose purpose)
{
  const BeamTargets& targets = this->targetsOf(beam);
  if (purpose == RandomPurpose::Pilot)
  {
    return TargetRays(targets.cones.size(), PilotRays);
  }
  return targets.wanted.empty() ? TargetRays(targets.cones.size(), RaysOfTarget) : targets.wanted;
}

/// Trace the targets' own rays of the beams of the last tracePrimary().
void ScanBlock::traceTargets(std::size_t begin, std::size_t end, RandomPurpose purpose)
{
  this->Frames.clear();
  this->Missing.clear();
  this->Traced.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    // tracePrimary() has found whether the beam is integrated.
    Slot& slot = this->slotOf(beam);
    if (slot.raysMissing == 0 || slot.integrated || slot.inCells ||
      slot.seen == SeenByBeam::Nothing)
    {
      continue;
    }
    // Where nothing can be met they are neither found nor drawn, unless a kept pilot gives their
    // numbers of rays.
    if (slot.raysDrawn != slot.raysMissing || slot.purpose != purpose)
    {
      slot.targets.found = slot.targets.found || slot.targets.wanted.empty();
      continue;
    }
    if (const std::uint32_t rays = sumOf(this->raysOfTargets(beam, purpose)))
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
  const BlockHits& found = this->traceBeams([this, purpose](std::size_t k) -> const BeamRays&
    { return this->drawTargets(this->Traced[k], purpose).rays; },
    nullptr, true);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    const std::uint32_t* const triangles = found.triangles[k];
    if (!triangles)
    {
      continue;
    }
    this->Own.assign(triangles, triangles + this->Missing[k]);
    const std::size_t beam = this->Traced[k];
    Slot& slot = this->slotOf(beam);
    if (this->Targets.keepOwn(slot.targets, this->raysOfTargets(beam, purpose), this->Own.data()))
    {
      slot.triangles.resize(slot.raysMissing, NoTriangle);
      slot.triangles.insert(slot.triangles.end(), this->Own.begin(), this->Own.end());
    }
  }
}

/// The rays of the beam's small targets, and their shares.
const BeamTargets& ScanBlock::drawTargets(std::size_t beam, RandomPurpose purpose)
{
  this->targetsOf(beam);
  Slot& slot = this->slotOf(beam);
  if (slot.targets.shares.empty() || slot.targetsDrawn != purpose)
  {
    this->Targets.draw(this->Beams.ids[beam], this->frameOf(beam), purpose,
      this->raysOfTargets(beam, purpose), slot.targets);
    slot.targetsDrawn = purpose;
  }
  return slot.targets;
}

/// The beam's `rays` rays, followed by those of small targets.
const BeamRays& ScanBlock::allRaysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose)
{
  this->AllRays = this->raysOf(beam, rays, purpose);
  const BeamRays& more = this->drawTargets(beam, purpose).rays;
  this->AllRays.x.insert(this->AllRays.x.end(), more.x.begin(), more.x.end());
  this->AllRays.y.insert(this->AllRays.y.end(), more.y.begin(), more.y.end());
  return this->AllRays;
}

/// Make samples of the triangles just found.
void ScanBlock::makeHits(
  std::size_t beam, std::uint32_t rays, RandomPurpose purpose, BeamSamples& samples)
{
  const Slot& slot = this->slotOf(beam);
  const TriangleMesh& mesh = *this->Setup.tree->mesh;
  if (this->targetsOf(beam).cones.empty())
  {
    this->Finder.find(
      mesh, slot.frame, this->raysOf(beam, rays, purpose), slot.triangles, samples, this->Geometry);
    return;
  }
  this->Finder.find(mesh, slot.frame, this->allRaysOf(beam, rays, purpose), slot.triangles, samples,
    this->Geometry);
  this->Targets.weigh(slot.targets, rays, samples);
}
}
