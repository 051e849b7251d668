// SPDX-License-Identifier: BSD-3-Clause
#include "ScanBlock.h"

namespace avianlidar
{
ScanBlock::ScanBlock(
  const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams, BlockBeams& block)
  : Setup(setup)
  , Scene(scene)
  , Beams(beams)
  , Block(block)
  , Gate(setup.sensor.seesDaylight() ? std::numeric_limits<double>::infinity()
                                     : setup.sensor.rangeGate)
  , Views(setup, scene, block.tracer())
{
}

std::size_t ScanBlock::trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces,
  const std::function<bool(std::size_t)>& leaveOut)
{
  this->Block.begin(begin, end);
  this->Frames.clear();
  this->Searched.clear();
  this->FramesOfRays.clear();
  this->TracedRays.clear();
  const bool byRays = this->Setup.settings.beamSamples == BeamSampleSource::Rays;
  std::size_t count = 0;
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    BeamTrace& trace = traces[beam];
    const bool isUnknown = trace.direct() == DirectEcho::Unknown;
    if (!(isUnknown || this->needsPathStarts(trace)) || (leaveOut && leaveOut(beam)))
    {
      continue;
    }
    ++count;
    if (isUnknown && !byRays)
    {
      trace.view = EmptyView{};
      this->Frames.push_back(this->Block.frameOf(beam));
      this->Searched.push_back(beam);
      continue;
    }
    if (isUnknown)
    {
      trace.view = RayView{};
    }
    this->addRaysOf(beam); // a kept view lacks only rays
  }
  this->findViews(traces);
  this->traceRays();
  for (const std::size_t beam : this->TracedRays)
  {
    if (this->needsPathStarts(traces[beam]) && this->Block.triangles(beam).empty())
    {
      traces[beam].hits = std::make_unique<BeamSamples>(); // no ray of the beam hits anything
      traces[beam].hits->rays = tracedRaysOf(this->Setup.settings);
    }
  }
  return count;
}

/// True if paths with two reflections may start from the untraced rays of a beam in cells.
bool ScanBlock::needsPathStarts(const BeamTrace& trace) const
{
  return trace.cells() && !trace.hits && this->Setup.settings.numberOfReflections > 1;
}

void ScanBlock::addRaysOf(std::size_t beam)
{
  this->FramesOfRays.push_back(this->Block.frameOf(beam));
  this->TracedRays.push_back(beam);
}

/// True if the beam's axis meets a surface behind the gate.
bool ScanBlock::meetsBehindGate(std::size_t beam)
{
  BeamTracer& tracer = this->Block.tracerOf(beam);
  const Hit hit = tracer.traceFromApex(this->Block.frameOf(beam).axis);
  addCounters(tracer.counters(), this->Block.counters(beam));
  return hit.valid() && hit.range > this->Gate;
}

/// Find the view of the beam at which the search has arrived.
BeamView ScanBlock::findView(std::size_t beam)
{
  constexpr double Everywhere = std::numeric_limits<double>::infinity();
  const auto viewWithin = [&](double range) -> BeamView
  {
    const std::vector<std::uint32_t>& found = this->Candidates.collect(range);
    return found.empty() ? BeamView(EmptyView{})
                         : this->Views.find(this->Beams.ids[beam], this->Block.frameOf(beam), found,
                             this->Block.counters(beam));
  };
  if (!(this->Gate < this->Candidates.farthest()))
  {
    return viewWithin(Everywhere);
  }
  BeamView view = viewWithin(this->Gate);
  const auto* const cells = std::get_if<std::unique_ptr<CellSamples>>(&view);
  if (!std::holds_alternative<EmptyView>(view) && !(cells && (*cells)->samples.size() == 0))
  {
    return view;
  }
  return this->meetsBehindGate(beam) ? BeamView(EmptyView{ true }) : viewWithin(Everywhere);
}

/// Find the views of the searched beams, and which of these beams need rays.
void ScanBlock::findViews(std::vector<BeamTrace>& traces)
{
  this->Candidates.begin(this->Scene, this->Frames.data(), this->Frames.size(),
    this->Setup.settings.traceMode == TraceMode::Automatic);
  while (this->Candidates.next())
  {
    const std::size_t beam = this->Searched[this->Candidates.beam()];
    BeamTrace& trace = traces[beam];
    trace.view = this->findView(beam);
    this->Block.counters(beam).nodesVisited += this->Candidates.nodesVisited();
    if (trace.direct() == DirectEcho::Rays || this->needsPathStarts(trace))
    {
      this->addRaysOf(beam);
    }
  }
}

/// Trace the rays of the beams that need them.
void ScanBlock::traceRays()
{
  const std::uint32_t count = tracedRaysOf(this->Setup.settings);
  const BeamBlock block{ this->FramesOfRays.data(), this->FramesOfRays.size(), count,
    [this](std::size_t k) -> const BeamRays& { return this->Block.raysOf(this->TracedRays[k]); } };
  const BlockHits& found = this->Block.tracer().traceBlock(block, this->Setup.settings.traceMode);
  for (std::size_t k = 0; k < this->TracedRays.size(); ++k)
  {
    const std::size_t beam = this->TracedRays[k];
    addCounters(found.counters[k], this->Block.counters(beam));
    if (const std::uint32_t* const triangles = found.triangles[k])
    {
      this->Block.triangles(beam).assign(triangles, triangles + count);
    }
  }
}
}
