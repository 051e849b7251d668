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

/// Whether the apex sees the point at which a path ends, on a side that faces the apex, in the
/// cone.
bool seesEnd(const SecondaryBeam& beam, const Vec3& point, const Vec3& direction,
  std::uint32_t triangle, const Vec3& normal)
{
  if (!beam.frame.contains(point) || glm::dot(normal, direction) >= 0.0)
  {
    return false;
  }
  const Hit seen = beam.tracer.traceFromApex(point);
  const double range = safeLength(point);
  return !seen.valid() || seen.triangle == triangle || seen.range >= range - surfaceMargin(range);
}

/// Follow a mirror path whose start and direction, `end`, are known.
/// @return false if the path ends nowhere, or where the apex sees the end
bool followBeyond(const SecondaryBeam& beam, MirrorPath& path)
{
  const Vec3 direction = path.end;
  const Hit found = beam.tracer.traceFrom(path.from, direction, surfaceMargin(path.rangeOne),
    path.first, std::numeric_limits<double>::infinity());
  if (!found.valid())
  {
    return false;
  }
  const Vec3 normal = seeTriangle(beam.scene, found.triangle, beam.frame.origin).normal;
  path.end = path.from + found.range * direction;
  if (seesEnd(beam, path.end, direction, found.triangle, normal))
  {
    return false;
  }
  path.seen = false;
  path.back = 0.0;
  path.triangle = found.triangle;
  path.range = safeLength(path.end);
  path.length = path.rangeOne + found.range + path.range;
  path.second =
    reflectionGeometry(direction, -direction, glm::dot(normal, direction) < 0.0 ? normal : -normal);
  path.visibility = Visibility::Clear;
  return true;
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
  const Vec3 normal = seeTriangle(beam.scene, end.triangle, beam.frame.origin).normal;
  const Vec3 point = from.point + end.range * direction;
  return seesEnd(beam, point, direction, end.triangle, normal) ? end : Hit();
}

/// @param inCone whether the path may end where the apex sees the end
void traceMirror(const ScanSetup& setup, const SecondaryBeam& beam, const BeamShape& shape,
  std::uint32_t hit, bool inCone)
{
  const HitPoint from(beam.samples, beam.geometry, hit);
  const Vec3 direction = mirrorDirection(beam.geometry.direction(hit), from.normal);
  const bool isNew = beam.trace.mirror[hit] == MirrorEnd::NotTraced;
  const Hit found = isNew && inCone ? pathEnd(setup, beam, hit, direction) : Hit();
  if (!found.valid())
  {
    MirrorPath path{ 0, hit, beam.geometry.triangle(hit), NoTriangle, beam.samples.weight[hit], 0.0,
      beam.samples.cosine[hit], from.range, 0.0, 0.0, {}, from.point, direction,
      Visibility::Unknown };
    const bool gathers = setup.sensor.receiverAperture > 0.0;
    const bool arrives = gathers && followBeyond(beam, path);
    beam.trace.mirror[hit] = arrives ? MirrorEnd::Arrives
      : gathers                      ? MirrorEnd::Lost
                                     : MirrorEnd::Nowhere;
    if (arrives)
    {
      beam.trace.mirrorPaths.push_back(path);
    }
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
  const bool gathers = setup.sensor.receiverAperture > 0.0;
  const auto isWanted = [&](std::uint32_t hit)
  {
    const double most = throughputs[hit];
    return (trace.mirror[hit] == MirrorEnd::NotTraced ||
             (gathers && trace.mirror[hit] == MirrorEnd::Nowhere)) &&
      most > 0.0 && most >= least;
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
    const bool inCone = !constrained || pairs.any(beam.geometry.surface[hit]);
    if (inCone || gathers)
    {
      traceMirror(setup, beam, shape, hit, inCone);
    }
    else
    {
      trace.mirror[hit] = MirrorEnd::Nowhere;
    }
  }
  std::sort(trace.mirrorPaths.begin(), trace.mirrorPaths.end(),
    [](const MirrorPath& a, const MirrorPath& b) { return a.one < b.one; });
}

void traceBeyond(const SecondaryBeam& beam, std::vector<MirrorPath>& paths, std::size_t first)
{
  std::size_t kept = first;
  for (std::size_t p = first; p < paths.size(); ++p)
  {
    MirrorPath& path = paths[p];
    // Only one of two triangles that coincide is seen.
    if ((!beam.cells || beam.tracer.traceFromApex(path.from).triangle == path.first) &&
      followBeyond(beam, path))
    {
      paths[kept++] = path;
    }
  }
  paths.resize(kept);
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
