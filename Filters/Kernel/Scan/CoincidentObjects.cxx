// SPDX-License-Identifier: BSD-3-Clause
#include "CoincidentObjects.h"

#include "BeamTracer.h"

#include <algorithm>
#include <map>

namespace avianlidar
{
namespace
{
constexpr std::size_t MostRaysOfPlane = 1000;
}

void addSeenPlanes(
  const CollisionTree& tree, const BeamView& view, std::size_t beam, std::vector<SeenPlane>& planes)
{
  const auto add = [&](std::uint32_t triangle)
  {
    if (triangle < tree.planeOwners.size() && tree.coincides(triangle)) // not of a mover
    {
      planes.push_back({ tree.planeOwner(triangle), beam });
    }
  };
  if (const VisiblePolygons* const polygons = view.polygons())
  {
    for (const PlaneSurface& surface : polygons->surfaces)
    {
      add(surface.triangle);
    }
    return;
  }
  const CellSamples* const cells = view.cells();
  if (const BeamSamples* const samples = cells ? &cells->samples : view.hits.get())
  {
    for (const BeamSamples::Surface& surface : samples->surfaces)
    {
      add(surface.triangle);
    }
  }
}

void sortSeenPlanes(std::vector<SeenPlane>& planes)
{
  std::sort(planes.begin(), planes.end());
  const auto isSame = [](const SeenPlane& a, const SeenPlane& b) { return a.owner == b.owner; };
  planes.erase(std::unique(planes.begin(), planes.end(), isSame), planes.end());
}

std::vector<CoincidentPair> findCoincidentObjects(
  const ScanSetup& setup, const ScanBeams& beams, const std::vector<SeenPlane>& planes)
{
  if (planes.empty())
  {
    return {};
  }
  const CollisionTree& tree = *setup.tree;
  std::map<std::uint32_t, std::vector<std::uint32_t>> members; // triangles by plane
  for (const SeenPlane& plane : planes)
  {
    members[plane.owner];
  }
  for (std::uint32_t t = 0; t < tree.planeOwners.size(); ++t)
  {
    const auto plane = members.find(tree.planeOwners[t]);
    if (plane != members.end())
    {
      plane->second.push_back(t);
    }
  }
  const auto differ = [&](std::uint32_t one, std::uint32_t two)
  {
    return setup.objectId(one) != setup.objectId(two) ||
      !(setup.material(one) == setup.material(two));
  };
  std::map<std::pair<int, int>, CoincidentPair> found;
  const SceneTriangles scene(tree);
  BeamTracer tracer(scene);
  for (const SeenPlane& plane : planes)
  {
    const std::vector<std::uint32_t>& all = members[plane.owner];
    if (std::none_of(
          all.begin(), all.end(), [&](std::uint32_t t) { return differ(all.front(), t); }))
    {
      continue;
    }
    const Vec3& apex = beams.origins[plane.beam];
    tracer.setBeam(makeBeamFrame(apex, beams.directions[plane.beam], setup.sensor.halfBeamwidth));
    const auto isOnPlane = [&](const Hit& hit)
    { return hit.valid() && tree.planeOwners[hit.triangle] == plane.owner; };
    const std::size_t step = 1 + all.size() / MostRaysOfPlane;
    for (std::size_t i = 0; i < all.size(); i += step)
    {
      const Corners t = cornersFrom(*tree.mesh, all[i], apex);
      const Vec3 centroid = t.a / 3.0 + t.b / 3.0 + t.c / 3.0;
      const Hit seen = tracer.traceFromApex(centroid);
      const Hit next =
        isOnPlane(seen) ? tracer.traceFrom(Vec3(0.0), centroid, 0.0, seen.triangle) : Hit();
      if (isOnPlane(next) && differ(seen.triangle, next.triangle))
      {
        const auto objects =
          std::minmax({ setup.objectId(seen.triangle), setup.objectId(next.triangle) });
        found.emplace(objects, CoincidentPair{ seen.triangle, next.triangle });
      }
    }
  }
  std::vector<CoincidentPair> pairs;
  for (const auto& one : found)
  {
    pairs.push_back(one.second);
  }
  return pairs;
}
}
