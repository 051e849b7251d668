// SPDX-License-Identifier: BSD-3-Clause
#include "PathStarts.h"

#include "ScanAir.h"

namespace avianlidar
{
HitFinder::HitFinder(const ScanSetup& setup, const SceneTriangles& scene)
  : Setup(setup)
  , Samples(scene)
{
}

std::unique_ptr<BeamSamples> HitFinder::hitsOf(const BeamFrame& frame, const BeamRays& rays,
  const std::vector<std::uint32_t>& triangles, SampleGeometry& geometry)
{
  auto hits = std::make_unique<BeamSamples>();
  this->Samples.find(frame, rays, triangles, *hits, geometry);
  if (haveVolumes(this->Setup.media))
  {
    for (std::size_t i = 0; i < hits->size(); ++i)
    {
      const std::uint32_t ray = hits->ray[i];
      SamplePlace place;
      place.add(AirColumn::at(rays.x[ray], rays.y[ray]), hits->weight[i], rays.x[ray], rays.y[ray]);
      hits->places.push_back(place);
    }
  }
  return hits;
}

PathStarts PathStarts::nowhere()
{
  static const BeamSamples hits;
  static const BeamRays rays;
  static const SampleGeometry geometry;
  return { hits, rays, geometry };
}

/// True if paths with two reflections may start at hits of a beam's rays.
bool HitFinder::mayStartIn(const BeamView& view) const
{
  const bool hasPaths = view.polygons() ? view.polygons()->facing : view.hits != nullptr;
  return this->Setup.needs.secondaryReflections && hasPaths &&
    (connectionsOf(this->Setup.settings) > 0 || !view.surfacesOfMirrors());
}

PathStarts HitFinder::startsOf(std::size_t beam, const BeamFrame& frame, DrawnRays& rays,
  BeamView& view, SampleGeometry& geometry, bool known)
{
  if (!this->mayStartIn(view))
  {
    return PathStarts::nowhere();
  }
  if (view.hits && view.hits->size() == 0)
  {
    const PathStarts none = PathStarts::nowhere();
    return { *view.hits, none.rays, none.geometry };
  }
  const BeamRays& drawn = rays.of(beam);
  if (view.hits)
  {
    if (!known)
    {
      this->Samples.findAgain(frame, drawn, *view.hits, geometry);
    }
    return { *view.hits, drawn, geometry };
  }
  this->Met.resize(drawn.size());
  for (std::size_t i = 0; i < drawn.size(); ++i)
  {
    this->Met[i] = view.polygons()->triangleAt({ drawn.x[i], drawn.y[i] });
  }
  view.hits = this->hitsOf(frame, drawn, this->Met, geometry);
  return { *view.hits, drawn, geometry };
}
}
