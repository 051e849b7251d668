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

/// Distance of a point from a mirror's plane, over the range, below which it lies on the mirror.
/// Coordinates in single precision have such errors.
constexpr double CoplanarWithin = 1e-6;

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

/// Direction at an angle, whose sine and cosine are given, from an axis. @param turn about the
/// axis, as a share of a whole turn
Vec3 directionAbout(const Vec3& axis, double sine, double cosine, double turn)
{
  const Vec3 other = std::fabs(axis.x) < 0.7 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
  const Vec3 e1 = unitVector(glm::cross(axis, other));
  const Vec3 e2 = glm::cross(axis, e1);
  const double angle = 2.0 * Pi * turn;
  return unitVector(sine * (std::cos(angle) * e1 + std::sin(angle) * e2) + cosine * axis);
}

/// A direction drawn from a lobe cos^kp. If `narrower` is not 1, the angle to the axis is
/// multiplied by it afterwards. Cosine and squared sine belong to the angle before.
struct LobeSample
{
  Vec3 direction;
  double cosine, sine2;

  LobeSample(const std::array<double, 2>& u, double kp, const Vec3& axis, double narrower = 1.0)
    : cosine(std::pow(u[0], 1.0 / (kp + 1.0)))
    , sine2(-std::expm1(2.0 * std::log(u[0]) / (kp + 1.0)))
  {
    const double angle = narrower * std::atan2(std::sqrt(this->sine2), this->cosine);
    this->direction = directionAbout(axis, std::sin(angle), std::cos(angle), u[1]);
  }
};

double densityAt(const SecondaryBeam& beam, const BeamShape& shape, const Vec3& point)
{
  const Vec3 q = beam.frame.toPlane(point);
  return shape.density(q.x / q.z, q.y / q.z);
}

/// Find whether and where the mirror shows the end of a path. The direction from the apex is drawn
/// about the image of the end. @param out direction in which the light arrives at the end
void findImage(const ScanSetup& setup, const SecondaryBeam& beam, const std::array<double, 2>& u,
  const Vec3& normal, const Vec3& out, const Vec3& endNormal, const MirrorPath& path, MattEnd& matt)
{
  const double kp = setup.material(path.first).kp;
  const double height = path.rangeOne * path.cosine;
  const double above = glm::dot(normal, matt.end) + height;
  if (!(above > 0.0) || !(height > 0.0))
  {
    return;
  }
  const Vec3 image = matt.end - 2.0 * above * normal;
  matt.image = safeLength(image);
  const double behind = matt.image * above / (height + above); // mirror to image
  const LobeSample view(u, kp, image / matt.image, behind / matt.image);
  matt.cosine = -glm::dot(view.direction, normal);
  if (!(matt.cosine > 0.0))
  {
    return;
  }
  const double range = height / matt.cosine;
  matt.through = range * view.direction;
  const Vec3 back = matt.through - matt.end;
  const double step = safeLength(back);
  const double margin = surfaceMargin(std::max(range, matt.range));
  if (!beam.frame.contains(matt.through) || !(step > 2.0 * margin))
  {
    return;
  }
  const Hit seen = beam.tracer.traceFromApex(matt.through);
  if (!seen.valid() || !(std::fabs(seen.range - range) * matt.cosine <= CoplanarWithin * range) ||
    beam.tracer.occluded(matt.through, matt.end, margin, seen.triangle, matt.triangle))
  {
    return;
  }
  // The angle at the mirror differs from the drawn angle, which belongs to the image's middle.
  const ReflectionGeometry atMirror = reflectionGeometry(view.direction, -back / step, normal);
  const double toDrawn =
    lobe(atMirror.cosLobe, atMirror.sin2Lobe, kp) / lobe(view.cosine, view.sine2, kp);
  const double nearer = behind / step;
  matt.again =
    std::min(MostGrazing, toDrawn * atMirror.cosOutgoing / matt.cosine * nearer * nearer);
  matt.shown = true;
  matt.mirror = seen.triangle;
  matt.lengthAgain = matt.length - matt.range + step + range;
  matt.third = reflectionGeometry(out, back / step, endNormal);
}

/// Find the matt end of a mirror path whose start is known. @param number number of the path
MattEnd findMattEnd(const ScanSetup& setup, const SecondaryBeam& beam, const BeamShape& shape,
  std::uint64_t number, const MirrorPath& path)
{
  MattEnd matt{};
  const auto draw = [&](std::uint64_t k)
  { return uniformPair(setup.settings.seed, beam.id, 2 * number + k, RandomPurpose::Lobes); };
  const Vec3 normal = seeTriangle(beam.scene, path.first, beam.frame.origin).normal;
  const Vec3 mirrored = mirrorDirection(path.from / path.rangeOne, normal);
  const Vec3 out = LobeSample(draw(0), setup.material(path.first).kp, mirrored).direction;
  const double rise = glm::dot(out, normal);
  if (!(rise > 0.0))
  {
    return matt; // the surface itself stops the part of the lobe below its horizon
  }
  const Hit found = beam.tracer.traceFrom(path.from, out, surfaceMargin(path.rangeOne), path.first);
  if (!found.valid())
  {
    return matt;
  }
  const Vec3 endNormal = seeTriangle(beam.scene, found.triangle, beam.frame.origin).normal;
  matt.triangle = found.triangle;
  matt.end = path.from + found.range * out;
  matt.range = safeLength(matt.end);
  matt.length = path.rangeOne + found.range + matt.range;
  matt.seen = seesEnd(beam, matt.end, out, found.triangle, endNormal);
  if (matt.seen)
  {
    matt.back = densityAt(beam, shape, matt.end) / densityAt(beam, shape, path.from) *
      std::min(MostGrazing, rise / path.cosine);
    matt.second = reflectionGeometry(out, -matt.end / matt.range, endNormal);
  }
  if (setup.settings.numberOfReflections > 2)
  {
    findImage(setup, beam, draw(1), normal, out,
      glm::dot(endNormal, out) < 0.0 ? endNormal : -endNormal, path, matt);
  }
  return matt;
}

/// Find the matt end of a mirror path, and keep it if light arrives. @return whether light arrives
bool keepMattEnd(const ScanSetup& setup, const SecondaryBeam& beam, const BeamShape& shape,
  std::uint64_t number, MirrorPath& path)
{
  const MattEnd matt = findMattEnd(setup, beam, shape, number, path);
  const bool arrives = matt.seen || matt.shown;
  if (arrives)
  {
    path.matt = static_cast<std::uint32_t>(beam.trace.mattEnds.size());
    beam.trace.mattEnds.push_back(matt);
  }
  return arrives;
}

/// Number of a path of MirrorRegions.h.
std::uint64_t numberOf(const MirrorPath& path)
{
  return std::uint64_t{ path.start } << 32 | path.one;
}

/// Follow a mirror path whose start and direction, `end`, are known.
/// @return false if no light arrives, or if the direction ends where the apex sees the end
bool followBeyond(const ScanSetup& setup, const SecondaryBeam& beam, const BeamShape& shape,
  std::uint64_t number, MirrorPath& path)
{
  path.seen = false;
  path.visibility = Visibility::Clear;
  if (!keepMattEnd(setup, beam, shape, number, path))
  {
    return false;
  }
  const Hit found =
    beam.tracer.traceFrom(path.from, path.end, surfaceMargin(path.rangeOne), path.first);
  const bool isSeen = found.valid() &&
    seesEnd(beam, path.from + found.range * path.end, path.end, found.triangle,
      seeTriangle(beam.scene, found.triangle, beam.frame.origin).normal);
  if (isSeen)
  {
    beam.trace.mattEnds.pop_back();
  }
  return !isSeen;
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
  const Hit found = inCone ? pathEnd(setup, beam, hit, direction) : Hit();
  const bool gathers = setup.sensor.receiverAperture > 0.0;
  if (!found.valid())
  {
    beam.trace.mirror[hit] = MirrorEnd::Nowhere;
    if (gathers)
    {
      MirrorPath path{ 0, hit, beam.geometry.triangle(hit), NoTriangle, beam.samples.weight[hit],
        beam.samples.cosine[hit], from.range, 0.0, 0.0, {}, from.point, direction,
        Visibility::Clear, false };
      if (keepMattEnd(setup, beam, shape, beam.samples.ray[hit], path))
      {
        beam.trace.mirror[hit] = MirrorEnd::Arrives;
        beam.trace.mirrorPaths.push_back(path);
      }
    }
    return;
  }
  beam.trace.mirror[hit] = MirrorEnd::Arrives;
  const SeenTriangle end = seeTriangle(beam.scene, found.triangle, beam.frame.origin);
  // The range found is used, not the range of the plane: for planes seen edge-on the two ranges
  // differ widely.
  const Vec3 point = from.point + found.range * direction;
  const double range = safeLength(point);
  MirrorPath path{ 0, hit, beam.geometry.triangle(hit), found.triangle, beam.samples.weight[hit],
    beam.samples.cosine[hit], from.range, from.range + found.range + range, range,
    reflectionGeometry(direction, -point / range, end.normal), from.point, point,
    Visibility::Clear };
  if (gathers)
  {
    keepMattEnd(setup, beam, shape, beam.samples.ray[hit], path);
  }
  beam.trace.mirrorPaths.push_back(path);
}

/// Draw a direction from a surface. The density of directions is proportional to the cosine, as for
/// matt light.
Vec3 drawDirection(
  const ScanSetup& setup, const SecondaryBeam& beam, std::uint64_t number, const Vec3& normal)
{
  const auto u = uniformPair(setup.settings.seed, beam.id, number, RandomPurpose::ShortPaths);
  return directionAbout(normal, std::sqrt(u[0]), std::sqrt(1.0 - u[0]), u[1]);
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

void traceBeyond(const ScanSetup& setup, const SecondaryBeam& beam, std::vector<MirrorPath>& paths,
  std::size_t first)
{
  const BeamShape shape(setup.sensor);
  std::size_t kept = first;
  for (std::size_t p = first; p < paths.size(); ++p)
  {
    MirrorPath& path = paths[p];
    // Only one of two triangles that coincide is seen.
    if ((!beam.cells || beam.tracer.traceFromApex(path.from).triangle == path.first) &&
      followBeyond(setup, beam, shape, numberOf(path), path))
    {
      paths[kept++] = path;
    }
  }
  paths.resize(kept);
}

void traceMirrorPaths(const ScanSetup& setup, const SecondaryBeam& beam,
  const std::vector<double>& throughputs, double least)
{
  const BeamShape shape(setup.sensor);
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
    if (clear && setup.sensor.receiverAperture > 0.0)
    {
      keepMattEnd(setup, beam, shape, numberOf(path), path);
    }
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
