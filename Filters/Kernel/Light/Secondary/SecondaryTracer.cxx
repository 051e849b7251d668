// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryTracer.h"

#include "Descents.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
SecondaryTracer::SecondaryTracer(const ScanSetup& setup)
  : Setup(setup)
{
}

/// Where the mirror path of a hit ends, if that is in the cone and seen by the lidar.
Hit SecondaryTracer::mirrorEnd(const SecondaryBeam& beam, const SecondaryScene& scene,
  std::uint32_t hit, const Vec3& direction, const PathSpace::Candidates* candidates) const
{
  const HitPoint from(beam.samples, scene.geometry, hit);
  const double margin = surfaceMargin(from.range);
  // With the beam constraint the search ends where the path leaves the cone.
  const double reach = this->Setup.settings.beamConstraint
    ? distanceInCone(scene.frame, from.point, from.range, direction)
    : std::numeric_limits<double>::infinity();
  Hit end;
  if (candidates)
  {
    FreeRayVisitor visitor(
      *this->Setup.tree->mesh, scene.frame.origin, from.point, unitDirection(direction), 0.0);
    visitor.minimum = margin;
    visitor.maximum = reach;
    visitor.ignore1 = scene.geometry.triangle(hit);
    visitor.leaf(candidates->data(), static_cast<std::uint32_t>(candidates->size()));
    end = visitor.nearest;
    ++scene.segments;
  }
  else
  {
    end =
      scene.tracer.traceFrom(from.point, direction, margin, scene.geometry.triangle(hit), reach);
  }
  if (!end.valid())
  {
    return {};
  }
  const Vec3 point = from.point + end.range * direction;
  if (!scene.frame.contains(point))
  {
    return {};
  }
  const SeenTriangle triangle =
    seeTriangle(*this->Setup.tree->mesh, end.triangle, scene.frame.origin);
  if (glm::dot(triangle.normal, direction) >= 0.0)
  {
    return {}; // it meets the side that looks away from the lidar
  }
  const Hit seen = scene.tracer.traceFromApex(point);
  const double range = safeLength(point);
  const bool visible =
    !seen.valid() || seen.triangle == end.triangle || seen.range >= range - surfaceMargin(range);
  return visible ? end : Hit();
}

void SecondaryTracer::traceMirror(const SecondaryBeam& beam, const SecondaryScene& scene,
  std::uint32_t hit, const PathSpace::Candidates* candidates)
{
  const HitPoint from(beam.samples, scene.geometry, hit);
  const Vec3 direction = mirrorDirection(scene.geometry.direction(hit), from.normal);
  const Hit found = this->mirrorEnd(beam, scene, hit, direction, candidates);
  if (!found.valid())
  {
    beam.trace.mirror[hit] = MirrorEnd::Nowhere;
    return;
  }
  beam.trace.mirror[hit] = MirrorEnd::Arrives;
  const SeenTriangle end = seeTriangle(*this->Setup.tree->mesh, found.triangle, scene.frame.origin);
  // The range that was found, not the plane's once more: seen edge-on they have little in common.
  const Vec3 point = from.point + found.range * direction;
  const double range = safeLength(point);
  beam.trace.mirrorPaths.push_back({ hit, found.triangle, from.range + found.range + range, range,
    reflectionGeometry(direction, -point / range, end.normal) });
}

void SecondaryTracer::traceMirrors(
  const SecondaryBeam& beam, const std::vector<double>& throughputs, double least)
{
  SecondaryTrace& trace = beam.trace;
  const auto isWanted = [&](std::uint32_t hit)
  {
    const double most = throughputs[hit];
    return trace.mirror[hit] == MirrorEnd::NotTraced && most > 0.0 && most >= least;
  };
  std::uint32_t hit = 0;
  while (hit < beam.samples.size() && !isWanted(hit))
  {
    ++hit;
  }
  if (hit == beam.samples.size())
  {
    return;
  }
  const SecondaryScene scene = beam.scene();
  const bool inCone = this->Setup.settings.beamConstraint;
  if (inCone)
  {
    this->Space.lookBefore(*this->Setup.tree, scene.frame, beam.samples, scene.geometry);
  }
  for (; hit < beam.samples.size(); ++hit)
  {
    beam.askWhetherWanted(hit);
    if (!isWanted(hit))
    {
      continue;
    }
    --trace.unknown;
    if (inCone && this->Space.isKnownFree(hit))
    {
      trace.mirror[hit] = MirrorEnd::Nowhere;
      continue;
    }
    const PathSpace::Candidates* candidates = inCone ? this->Space.ofMirror(hit) : nullptr;
    if (candidates && candidates->empty())
    {
      trace.mirror[hit] = MirrorEnd::Nowhere;
    }
    else
    {
      this->traceMirror(beam, scene, hit, candidates);
    }
  }
  std::sort(trace.mirrorPaths.begin(), trace.mirrorPaths.end(),
    [](const MirrorPath& a, const MirrorPath& b) { return a.one < b.one; });
}

void SecondaryTracer::traceConnections(
  const SecondaryBeam& beam, const std::vector<double>& throughputs, double least)
{
  SecondaryConnections& connections = beam.trace.connections;
  const auto isWanted = [&](std::size_t connection)
  {
    const double throughput = throughputs[connection];
    return connections.visibility[connection] == Visibility::Unknown && throughput > 0.0 &&
      throughput >= least;
  };
  std::size_t connection = 0;
  while (connection < connections.size() && !isWanted(connection))
  {
    ++connection;
  }
  if (connection == connections.size())
  {
    return;
  }
  const SecondaryScene scene = beam.scene();
  this->Space.lookBetween(
    *this->Setup.tree, scene.frame, beam.samples, scene.geometry, connections);
  for (; connection < connections.size(); ++connection)
  {
    beam.askWhetherWanted(connection);
    if (isWanted(connection))
    {
      --beam.trace.unseen;
      connections.visibility[connection] =
        this->isBlocked(beam, scene, connection) ? Visibility::Blocked : Visibility::Clear;
    }
  }
}

/// Whether something stands between the hits of a connection.
bool SecondaryTracer::isBlocked(
  const SecondaryBeam& beam, const SecondaryScene& scene, std::size_t connection)
{
  const PathSpace::Candidates* candidates = this->Space.ofConnection(connection);
  if (candidates && candidates->empty())
  {
    return false;
  }
  const std::uint32_t hit1 = beam.trace.connections.one[connection];
  const std::uint32_t hit2 = beam.trace.connections.two[connection];
  const std::uint32_t triangle1 = scene.geometry.triangle(hit1);
  const std::uint32_t triangle2 = scene.geometry.triangle(hit2);
  const HitPoint one(beam.samples, scene.geometry, hit1);
  const HitPoint two(beam.samples, scene.geometry, hit2);
  const double margin = surfaceMargin(std::max(one.range, two.range));
  if (!candidates)
  {
    return scene.tracer.occluded(one.point, two.point, margin, triangle1, triangle2);
  }
  FreeRayVisitor visitor(*this->Setup.tree->mesh, scene.frame.origin, one.point,
    unitDirection(two.point - one.point), 0.0);
  visitor.minimum = margin;
  visitor.maximum = beam.trace.connections.length[connection] - margin;
  visitor.ignore1 = triangle1;
  visitor.ignore2 = triangle2;
  visitor.anyHit = true;
  visitor.leaf(candidates->data(), static_cast<std::uint32_t>(candidates->size()));
  ++scene.segments;
  return visitor.nearest.valid();
}
}
