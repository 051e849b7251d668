// SPDX-License-Identifier: BSD-3-Clause
#include "BlockBeams.h"

#include "BeamAir.h"

#include <algorithm>

namespace avianlidar
{
BlockBeams::BlockBeams(
  const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams, BeamSampler& sampler)
  : Setup(setup)
  , Width(BeamShape(setup.sensor).width())
  , Beams(beams)
  , Sampler(sampler)
  , Tracer(scene)
  , Finder(scene)
{
}

void BlockBeams::begin(std::size_t begin, std::size_t end)
{
  this->First = begin;
  this->GeometryBeam = NoBeam;
  this->BeamStates.resize(std::max(this->BeamStates.size(), end - begin));
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    BeamState& slot = this->stateOf(beam);
    slot.triangles.clear();
    slot.counters = {};
    slot.frame.reset();
    slot.rays.resize(0);
  }
}

const BeamFrame& BlockBeams::frameOf(std::size_t beam)
{
  BeamState& slot = this->stateOf(beam);
  if (!slot.frame)
  {
    slot.frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
  }
  return *slot.frame;
}

const BeamRays& BlockBeams::raysOf(std::size_t beam)
{
  BeamState& slot = this->stateOf(beam);
  if (slot.rays.size() == 0)
  {
    this->Sampler.draw(this->Setup.settings.seed, this->Beams.ids[beam], slot.rays);
  }
  return slot.rays;
}

void BlockBeams::takeHits(std::size_t beam, BeamTrace& trace)
{
  const std::vector<std::uint32_t>& triangles = this->stateOf(beam).triangles;
  if (!triangles.empty())
  {
    this->makeHits(beam, triangles, trace);
  }
}

/// Make samples of the hits of the beam's rays. @param triangles nearest triangle of each ray
void BlockBeams::makeHits(
  std::size_t beam, const std::vector<std::uint32_t>& triangles, BeamTrace& trace)
{
  trace.hits = std::make_unique<BeamSamples>();
  this->Finder.find(
    this->frameOf(beam), this->raysOf(beam), triangles, *trace.hits, this->Geometry);
  this->GeometryBeam = beam;
  if (haveVolumes(this->Setup.media))
  {
    const BeamRays& rays = this->raysOf(beam);
    for (std::size_t i = 0; i < trace.hits->size(); ++i)
    {
      const std::uint32_t ray = trace.hits->ray[i];
      SamplePlace place;
      place.add(BeamAir::columnAt(rays.x[ray], rays.y[ray]), trace.hits->weight[i], rays.x[ray],
        rays.y[ray]);
      trace.hits->places.push_back(place);
    }
  }
}

const BeamSamples& BlockBeams::pathStartsOf(std::size_t beam, BeamTrace& trace)
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

const SampleGeometry& BlockBeams::geometryOf(std::size_t beam, const BeamSamples& hits)
{
  if (this->GeometryBeam != beam)
  {
    this->Finder.findAgain(this->frameOf(beam), this->raysOf(beam), hits, this->Geometry);
    this->GeometryBeam = beam;
  }
  return this->Geometry;
}

BeamTracer& BlockBeams::tracerOf(std::size_t beam)
{
  this->Tracer.setBeam(this->frameOf(beam));
  return this->Tracer;
}
}
