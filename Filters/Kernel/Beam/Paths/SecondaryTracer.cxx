// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryTracer.h"

#include "BeamShape.h"
#include "Random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Upper bound of the distance, m, over which a path remains inside the cone; infinity if its
/// direction lies within the cone, or nearly. @param point start relative to the apex, m
/// @param range distance of `point` from the apex, m
double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction)
{
  // p . p cos^2 - (p . axis)^2 = 0 on the cone, a quadratic in the length s.
  const double cos2 = frame.cosHalf * frame.cosHalf;
  const double along = glm::dot(point, frame.axis);
  const double turn = glm::dot(direction, frame.axis);
  const double a = cos2 - turn * turn;
  const double b = cos2 * glm::dot(point, direction) - along * turn;
  const double c = std::min(0.0, cos2 * range * range - along * along);
  if (!(a > 1e-9))
  {
    return std::numeric_limits<double>::infinity();
  }
  const double reach = (std::sqrt(std::max(0.0, b * b - a * c)) - b) / a;
  return reach * (1.0 + 1e-6) + 1e-6 * range;
}

/// End of the path from a hit in a direction; invalid if the end is outside the cone or hidden.
Hit pathEnd(
  const ScanSetup& setup, const SecondaryBeam& beam, std::uint32_t hit, const Vec3& direction)
{
  const HitPoint from(beam.samples, beam.geometry, hit);
  const double margin = surfaceMargin(from.range);
  // With the beam constraint the search ends where the path leaves the cone.
  const double reach = setup.settings.beamConstraint
    ? distanceInCone(beam.frame, from.point, from.range, direction)
    : std::numeric_limits<double>::infinity();
  const Hit end =
    beam.tracer.traceFrom(from.point, direction, margin, beam.geometry.triangle(hit), reach);
  if (!end.valid())
  {
    return {};
  }
  const Vec3 point = from.point + end.range * direction;
  if (!beam.frame.contains(point))
  {
    return {};
  }
  const SeenTriangle triangle = seeTriangle(beam.scene, end.triangle, beam.frame.origin);
  if (glm::dot(triangle.normal, direction) >= 0.0)
  {
    return {}; // the path meets the side that faces away from the lidar
  }
  const Hit seen = beam.tracer.traceFromApex(point);
  const double range = safeLength(point);
  const bool visible =
    !seen.valid() || seen.triangle == end.triangle || seen.range >= range - surfaceMargin(range);
  return visible ? end : Hit();
}

void traceMirror(
  const ScanSetup& setup, const SecondaryBeam& beam, const BeamShape& shape, std::uint32_t hit)
{
  const HitPoint from(beam.samples, beam.geometry, hit);
  const Vec3 direction = mirrorDirection(beam.geometry.direction(hit), from.normal);
  const Hit found = pathEnd(setup, beam, hit, direction);
  if (!found.valid())
  {
    beam.trace.mirror[hit] = MirrorEnd::Nowhere;
    return;
  }
  beam.trace.mirror[hit] = MirrorEnd::Arrives;
  const SeenTriangle end = seeTriangle(beam.scene, found.triangle, beam.frame.origin);
  // The range found is used, not the range of the plane: for planes seen edge-on the two ranges
  // differ widely.
  const Vec3 point = from.point + found.range * direction;
  const double range = safeLength(point);
  const auto densityAt = [&](const Vec3& p)
  {
    const Vec3 q = beam.frame.toPlane(p);
    return shape.density(q.x / q.z, q.y / q.z);
  };
  beam.trace.mirrorPaths.push_back({ 0, hit, beam.geometry.triangle(hit), found.triangle,
    beam.samples.weight[hit], densityAt(point) / densityAt(from.point), beam.samples.cosine[hit],
    from.range, from.range + found.range + range, range,
    reflectionGeometry(direction, -point / range, end.normal), from.point, point,
    Visibility::Clear });
}

/// Draw a direction from a surface. The density of directions is proportional to the cosine, as for
/// matt light.
Vec3 drawDirection(
  const ScanSetup& setup, const SecondaryBeam& beam, std::uint64_t number, const Vec3& normal)
{
  const auto u = uniformPair(setup.settings.seed, beam.id, number, RandomPurpose::ShortPaths);
  const Vec3 other = std::fabs(normal.x) < 0.7 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
  const Vec3 e1 = unitVector(glm::cross(normal, other));
  const Vec3 e2 = glm::cross(normal, e1);
  const double turn = 2.0 * Pi * u[1];
  const double sine = std::sqrt(u[0]);
  return unitVector(
    sine * (std::cos(turn) * e1 + std::sin(turn) * e2) + std::sqrt(1.0 - u[0]) * normal);
}

/// Trace the k-th direction of a ray, and keep the path if its form factor exceeds MostFormFactor.
void traceShortPath(
  const ScanSetup& setup, const SecondaryBeam& beam, std::uint32_t hit, std::uint32_t k)
{
  const HitPoint from(beam.samples, beam.geometry, hit);
  const Vec3 direction = drawDirection(
    setup, beam, std::uint64_t{ beam.samples.ray[hit] } * beam.trace.partners + k, from.normal);
  const Hit found = pathEnd(setup, beam, hit, direction);
  if (!found.valid())
  {
    return;
  }
  const SeenTriangle end = seeTriangle(beam.scene, found.triangle, beam.frame.origin);
  const Vec3 point = from.point + found.range * direction;
  const double range = safeLength(point);
  const ReflectionGeometry first =
    reflectionGeometry(beam.geometry.direction(hit), direction, from.normal);
  const ReflectionGeometry second = reflectionGeometry(direction, -point / range, end.normal);
  const double excess = 1.0 -
    MostFormFactor /
      formFactor(first.cosOutgoing, second.cosIncidence, found.range, range, second.cosOutgoing,
        setup.sensor.solidAngle());
  if (excess > 0.0)
  {
    beam.trace.shortPaths.push_back(
      { hit, found.triangle, beam.samples.weight[hit] * excess / beam.trace.partners,
        from.range + found.range + range, range, first, second, from.point, point });
  }
}

/// True if something lies between the hits of a connection.
bool isBlocked(const SecondaryBeam& beam, std::size_t connection)
{
  const std::uint32_t hit1 = beam.trace.connections.one[connection];
  const std::uint32_t hit2 = beam.trace.connections.two[connection];
  const HitPoint one(beam.samples, beam.geometry, hit1);
  const HitPoint two(beam.samples, beam.geometry, hit2);
  return beam.tracer.occluded(one.point, two.point, surfaceMargin(std::max(one.range, two.range)),
    beam.geometry.triangle(hit1), beam.geometry.triangle(hit2));
}
}

void traceMirrors(const ScanSetup& setup, const SecondaryBeam& beam,
  const std::vector<double>& throughputs, double least, MirrorPairs& pairs)
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
  const bool constrained = hit < beam.samples.size() && setup.settings.beamConstraint;
  if (constrained)
  {
    pairs.find(beam);
  }
  const BeamShape shape(setup.sensor);
  for (; hit < beam.samples.size(); ++hit)
  {
    beam.throwIfStopped(hit);
    if (!isWanted(hit))
    {
      continue;
    }
    if (constrained && !pairs.any(beam.geometry.surface[hit]))
    {
      trace.mirror[hit] = MirrorEnd::Nowhere;
    }
    else
    {
      traceMirror(setup, beam, shape, hit);
    }
  }
  std::sort(trace.mirrorPaths.begin(), trace.mirrorPaths.end(),
    [](const MirrorPath& a, const MirrorPath& b) { return a.one < b.one; });
}

void traceMirrorPaths(
  const SecondaryBeam& beam, const std::vector<double>& throughputs, double least)
{
  std::vector<MirrorPath>& paths = beam.trace.mirrorPaths;
  for (std::size_t p = 0; p < paths.size(); ++p)
  {
    MirrorPath& path = paths[p];
    beam.throwIfStopped(p);
    if (path.visibility != Visibility::Unknown ||
      !(throughputs[p] > 0.0 && throughputs[p] >= least))
    {
      continue;
    }
    // Only one of two triangles that coincide is seen.
    const auto isSeen = [&](const Vec3& point, std::uint32_t triangle)
    { return beam.tracer.traceFromApex(point).triangle == triangle; };
    const bool clear =
      (!beam.cells || (isSeen(path.from, path.first) && isSeen(path.end, path.triangle))) &&
      !beam.tracer.occluded(path.from, path.end, surfaceMargin(std::max(path.rangeOne, path.range)),
        path.first, path.triangle);
    path.visibility = clear ? Visibility::Clear : Visibility::Blocked;
  }
}

void traceShortPaths(const ScanSetup& setup, const SecondaryBeam& beam, ConnectionFinder& finder)
{
  if (beam.trace.shortTraced)
  {
    return;
  }
  beam.trace.shortPaths.clear(); // paths may be left from stopped work
  const bool any = finder.findFacing(beam.samples, beam.geometry);
  for (std::uint32_t hit = 0; any && hit < beam.samples.size(); ++hit)
  {
    beam.throwIfStopped(hit);
    const bool faces = finder.faces(beam.geometry.surface[hit], beam.geometry.surfaces.size());
    for (std::uint32_t k = 0; faces && k < beam.trace.partners; ++k)
    {
      traceShortPath(setup, beam, hit, k);
    }
  }
  beam.trace.shortTraced = true;
}

void traceConnections(
  const SecondaryBeam& beam, const std::vector<double>& throughputs, double least)
{
  SecondaryConnections& connections = beam.trace.connections;
  const auto isWanted = [&](std::size_t connection)
  {
    const double throughput = throughputs[connection];
    return connections.visibility[connection] == Visibility::Unknown && throughput > 0.0 &&
      throughput >= least;
  };
  for (std::size_t connection = 0; connection < connections.size(); ++connection)
  {
    beam.throwIfStopped(connection);
    if (isWanted(connection))
    {
      connections.visibility[connection] =
        isBlocked(beam, connection) ? Visibility::Blocked : Visibility::Clear;
    }
  }
}
}
