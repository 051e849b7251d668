// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryReflection.h"

#include "Propagation.h"
#include "TraceVisitors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
PathNumbers numbersOf(const SecondaryReflection::Beam& beam)
{
  return { beam.hits.rays, beam.trace.connections };
}
}

std::uint32_t connectionsOf(const EchoSettings& settings, std::uint32_t rays)
{
  if (settings.numberOfReflections < 2 || rays < 2)
  {
    return 0;
  }
  return std::min(static_cast<std::uint32_t>(settings.numberOfConnections), rays - 1);
}

SecondaryReflection::SecondaryReflection(const ScanSetup& setup)
  : Setup(setup)
  , Finder(setup)
{
}

//--- what may be connected ------------------------------------------------------------------------

void SecondaryReflection::prepare(const Beam& beam)
{
  SecondaryTrace& trace = beam.trace;
  const std::uint32_t connections = connectionsOf(this->Setup.settings, beam.hits.rays);
  if (trace.mirror.empty())
  {
    trace.mirror.assign(beam.hits.size(), MirrorEnd::NotTraced);
    trace.unknown = beam.hits.size();
  }
  if (!trace.linksKnown || trace.connections != connections)
  {
    trace.links.clear();
    trace.connections = connections;
    // Points of one plane do not look at each other.
    if (connections > 0 && !beam.hits.coplanar)
    {
      this->Finder.find(beam, connections);
    }
    trace.linksKnown = true;
    trace.unseen = trace.links.size();
  }
}

//--- what it is worth -----------------------------------------------------------------------------

/// The most that each mirror path can carry.
void SecondaryReflection::boundMirrors(const Beam& beam)
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const bool aperture = this->Setup.sensor.receiverAperture > 0.0;
  const std::size_t count = beam.hits.size();
  // By the triangle inequality no path over a point at range r is shorter than 2 r.
  const double factor = this->RayEnergy * (aperture ? 1.0 : this->Setup.largestReflectance);
  this->MirrorBounds.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Material m{ beam.light.kd[i], beam.light.ks[i], beam.light.kp[i] };
    this->MirrorBounds[i] =
      reflectanceBound(model, m, beam.hits.cosine[i]).specular * factor * beam.light.air[i];
  }
}

double SecondaryReflection::bound(const Beam& beam)
{
  this->RayEnergy = this->Setup.sensor.pulseEnergy / beam.hits.rays;
  const bool known = beam.trace.linksKnown &&
    beam.trace.connections == connectionsOf(this->Setup.settings, beam.hits.rays);
  if (known && beam.trace.isDark())
  {
    return 0.0;
  }
  // A ray returns kd + ks at most; where no hits look at each other there are mirror paths alone.
  double sum = 0.0;
  if ((beam.hits.coplanar || (known && beam.trace.links.size() == 0)) &&
    this->Setup.sensor.receiverAperture <= 0.0)
  {
    this->boundMirrors(beam);
    for (const double most : this->MirrorBounds)
    {
      sum += most;
    }
    return sum;
  }
  for (std::uint32_t hit = 0; hit < beam.hits.size(); ++hit)
  {
    sum += secondaryBudget(beam, hit);
  }
  return sum * this->RayEnergy;
}

double SecondaryReflection::mirrorEnergy(const Beam& beam, const MirrorPath& path) const
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const double aperture = this->Setup.sensor.receiverAperture;
  const Material first{ beam.light.kd[path.one], beam.light.ks[path.one], beam.light.kp[path.one] };
  const Material& second = this->Setup.materials[path.triangle];
  ReflectionGeometry back = path.second;
  if (aperture > 0.0)
  {
    back.cosIncidence = back.cosOutgoing;
  }
  const double f1 = specularReflectance(model, first, mirrorGeometry(beam.hits.cosine[path.one]));
  const double f2 =
    throughAperture(reflectance(model, second, back), second.kp, aperture, path.range).total();
  return this->RayEnergy * f1 * f2 * secondaryScale(this->Setup, beam, path.one, second) *
    transmission(this->Setup.settings.attenuationCoefficient, path.length);
}

//--- tracing --------------------------------------------------------------------------------------

std::uint32_t SecondaryReflection::mirrorEnd(const Beam& beam, const Scene& scene,
  std::uint32_t hit, const Vec3& direction, const Occupants& occupants) const
{
  const bool coneOnly = this->Setup.settings.beamConstraint;
  const HitPoint from(beam.hits, scene.geometry, hit);
  const double margin = surfaceMargin(from.range);
  // With the beam constraint the search ends where the path leaves the cone.
  const double reach = coneOnly ? distanceInCone(scene.frame, from.point, from.range, direction)
                                : std::numeric_limits<double>::infinity();
  Hit end;
  if (occupants.areListed())
  {
    FreeRayVisitor visitor(
      *this->Setup.tree->mesh, scene.frame.origin, from.point, unitDirection(direction), 0.0);
    visitor.minimum = margin;
    visitor.maximum = reach;
    visitor.ignore1 = beam.hits.triangle[hit];
    visitor.leaf(occupants.triangles, occupants.count);
    end = visitor.nearest;
    ++scene.segments;
  }
  else
  {
    end = scene.tracer.traceFrom(
      from.point, direction, margin, beam.hits.triangle[hit], coneOnly, reach);
  }
  if (!end.valid())
  {
    return NoTriangle;
  }
  const Vec3 point = from.point + end.range * direction;
  if (!scene.frame.contains(point))
  {
    return NoTriangle;
  }
  const LocalTriangle triangle =
    localTriangle(*this->Setup.tree->mesh, end.triangle, scene.frame.origin);
  if (glm::dot(triangle.normal, direction) >= 0.0)
  {
    return NoTriangle; // it meets the side that looks away from the lidar
  }
  const Hit seen = scene.tracer.traceFromApex(point, coneOnly);
  const double range = safeLength(point);
  const bool visible =
    !seen.valid() || seen.triangle == end.triangle || seen.range >= range - surfaceMargin(range);
  return visible ? end.triangle : NoTriangle;
}

void SecondaryReflection::traceMirror(
  const Beam& beam, const Scene& scene, std::uint32_t hit, const Occupants& occupants)
{
  const HitPoint from(beam.hits, scene.geometry, hit);
  const Vec3 direction = mirrorDirection(scene.geometry.direction(hit), from.normal);
  const std::uint32_t triangle = this->mirrorEnd(beam, scene, hit, direction, occupants);
  if (triangle == NoTriangle)
  {
    beam.trace.mirror[hit] = MirrorEnd::Nowhere;
    return;
  }
  beam.trace.mirror[hit] = MirrorEnd::Arrives;
  const LocalTriangle end = localTriangle(*this->Setup.tree->mesh, triangle, scene.frame.origin);
  const double towards = glm::dot(end.normal, direction);
  const double length = glm::dot(end.normal, end.a - from.point) / towards;
  const Vec3 point = from.point + length * direction;
  const double range = safeLength(point);
  beam.trace.mirrorPaths.push_back({ hit, triangle, from.range + length + range, range,
    reflectionGeometry(direction, -point / range, end.normal) });
}

/// Trace the mirror paths that are not known yet and may carry as much as `threshold`.
void SecondaryReflection::traceMirrors(const Beam& beam, double threshold)
{
  SecondaryTrace& trace = beam.trace;
  const auto isWanted = [&](std::uint32_t hit)
  {
    const double most = this->MirrorBounds[hit];
    return trace.mirror[hit] == MirrorEnd::NotTraced && most > 0.0 && most >= threshold;
  };
  std::uint32_t hit = 0;
  while (hit < beam.hits.size() && !isWanted(hit))
  {
    ++hit;
  }
  if (hit == beam.hits.size())
  {
    return;
  }
  const Scene scene = beam.scene();
  const std::vector<Occupants>* found = this->Setup.settings.beamConstraint
    ? &this->Space.beforeSurfaces(*this->Setup.tree, scene.frame, beam.hits, scene.geometry)
    : nullptr;
  Occupants unknown;
  unknown.count = Occupants::Most + 1;
  for (; hit < beam.hits.size(); ++hit)
  {
    beam.askWhetherWanted(hit);
    if (!isWanted(hit))
    {
      continue;
    }
    --trace.unknown;
    const Occupants& occupants = found ? (*found)[scene.geometry.surface[hit]] : unknown;
    if (occupants.count == 0)
    {
      trace.mirror[hit] = MirrorEnd::Nowhere;
    }
    else
    {
      this->traceMirror(beam, scene, hit, occupants);
    }
  }
  std::sort(trace.mirrorPaths.begin(), trace.mirrorPaths.end(),
    [](const MirrorPath& a, const MirrorPath& b) { return a.one < b.one; });
}

/// Look which links that carry as much as `threshold` are blocked, as far as it is not known.
void SecondaryReflection::traceLinks(const Beam& beam, double threshold)
{
  SecondaryLinks& links = beam.trace.links;
  const auto isWanted = [&](std::size_t link)
  {
    const double energy = this->LinkEnergies[link];
    return links.visibility[link] == Visibility::Unknown && energy > 0.0 && energy >= threshold;
  };
  std::size_t link = 0;
  while (link < links.size() && !isWanted(link))
  {
    ++link;
  }
  if (link == links.size())
  {
    return;
  }
  const Scene scene = beam.scene();
  this->Space.betweenSurfaces(*this->Setup.tree, scene.frame, beam.hits, scene.geometry, links);
  for (; link < links.size(); ++link)
  {
    beam.askWhetherWanted(link);
    if (isWanted(link))
    {
      --beam.trace.unseen;
      links.visibility[link] =
        this->isBlocked(beam, scene, link) ? Visibility::Blocked : Visibility::Clear;
    }
  }
}

bool SecondaryReflection::isBlocked(const Beam& beam, const Scene& scene, std::size_t link) const
{
  const Occupants& occupants = this->Space.ofLink(link);
  if (occupants.count == 0)
  {
    return false;
  }
  const std::uint32_t hit1 = beam.trace.links.one[link];
  const std::uint32_t hit2 = beam.trace.links.two[link];
  const std::uint32_t triangle1 = beam.hits.triangle[hit1];
  const std::uint32_t triangle2 = beam.hits.triangle[hit2];
  const HitPoint one(beam.hits, scene.geometry, hit1);
  const HitPoint two(beam.hits, scene.geometry, hit2);
  const double margin = surfaceMargin(std::max(one.range, two.range));
  if (!occupants.areListed())
  {
    return scene.tracer.occluded(
      one.point, two.point, margin, triangle1, triangle2, this->Setup.settings.beamConstraint);
  }
  FreeRayVisitor visitor(*this->Setup.tree->mesh, scene.frame.origin, one.point,
    unitDirection(two.point - one.point), 0.0);
  visitor.minimum = margin;
  visitor.maximum = beam.trace.links.length[link] - margin;
  visitor.ignore1 = triangle1;
  visitor.ignore2 = triangle2;
  visitor.anyHit = true;
  visitor.leaf(occupants.triangles, occupants.count);
  ++scene.segments;
  return visitor.nearest.valid();
}

//--- paths ----------------------------------------------------------------------------------------

void SecondaryReflection::collect(const Beam& beam, std::vector<SecondaryPath>& paths, double& lost)
{
  this->RayEnergy = this->Setup.sensor.pulseEnergy / beam.hits.rays;
  this->prepare(beam);
  if (beam.trace.isDark())
  {
    return;
  }
  this->boundMirrors(beam);
  lightLinks(this->Setup, beam, this->RayEnergy, this->LinkEnergies);
  double threshold = 0.0;
  if (this->Setup.settings.lightEnergyConstraint)
  {
    const double budget = LightEnergyTolerance * this->Setup.sensor.lowerEnergyLimit;
    double all = 0.0;
    for (const std::vector<double>* bounds : { &this->MirrorBounds, &this->LinkEnergies })
    {
      for (const double most : *bounds)
      {
        all += most;
      }
    }
    if (all + lost < budget)
    {
      lost += all;
      return;
    }
    threshold = budget / static_cast<double>(numbersOf(beam).total());
  }
  if (beam.trace.unknown > 0)
  {
    this->traceMirrors(beam, threshold);
  }
  if (beam.trace.unseen > 0)
  {
    this->traceLinks(beam, threshold);
  }
  this->takePaths(beam, threshold, paths, lost);
}

/// Paths that carry enough, in the order of their numbers.
void SecondaryReflection::takePaths(
  const Beam& beam, double threshold, std::vector<SecondaryPath>& paths, double& lost)
{
  const SecondaryTrace& trace = beam.trace;
  const SecondaryLinks& links = trace.links;
  const PathNumbers numbers = numbersOf(beam);
  const std::size_t begin = paths.size();
  this->Returned.assign(beam.hits.size(), 0.0);
  for (const MirrorPath& path : trace.mirrorPaths)
  {
    const double most = this->MirrorBounds[path.one];
    const double energy = most > 0.0 && most >= threshold ? this->mirrorEnergy(beam, path) : 0.0;
    if (energy > 0.0)
    {
      paths.push_back({ { path.length, energy, numbers.mirror(beam.hits.ray[path.one]) },
        path.triangle, path.second.cosIncidence, path.one });
      this->Returned[path.one] += energy;
    }
  }
  for (std::size_t i = 0; i < links.size(); ++i)
  {
    const double energy = this->LinkEnergies[i];
    if (!(energy > 0.0 && energy >= threshold))
    {
      lost += energy;
    }
    else if (links.visibility[i] == Visibility::Clear)
    {
      const std::uint32_t one = links.one[i];
      const std::uint32_t two = links.two[i];
      paths.push_back({ { beam.hits.range[one] + links.length[i] + beam.hits.range[two], energy,
                          numbers.connection(beam.hits.ray[one], links.connection[i]) },
        beam.hits.triangle[two], links.cosIn[i], one });
      this->Returned[one] += energy;
    }
  }
  // The random weights of the connections may together exceed 1: cut what passes the ray's budget.
  for (std::size_t i = begin; i < paths.size(); ++i)
  {
    const double sum = this->Returned[paths[i].one];
    const double budget = secondaryBudget(beam, paths[i].one) * this->RayEnergy;
    if (sum > budget)
    {
      paths[i].contribution.energy *= budget / sum;
    }
  }
  for (std::uint32_t hit = 0; trace.unknown > 0 && hit < beam.hits.size(); ++hit)
  {
    lost += trace.mirror[hit] == MirrorEnd::NotTraced ? this->MirrorBounds[hit] : 0.0;
  }
}
}
