// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryReflection.h"

#include "ParallelLoop.h"
#include "Propagation.h"
#include "Random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// A beam of a hundred thousand rays takes longer than a user wants to wait for a stop.
void askWhetherWanted(const SecondaryReflection::Beam& beam, std::size_t step)
{
  constexpr std::size_t interval = 4096;
  if (beam.wanted && *beam.wanted && step % interval == interval - 1 && !(*beam.wanted)())
  {
    throw WorkStopped();
  }
}

/// A hit as the beginning or end of a segment.
struct HitPoint
{
  Vec3 point;
  Vec3 normal;
  double range;
  HitPoint(const PrimaryHits& hits, const HitGeometry& geometry, std::uint32_t hit)
    : point(hits.range[hit] * geometry.direction(hit))
    , normal(geometry.surfaces[geometry.surface[hit]].normal)
    , range(hits.range[hit])
  {
  }
};

/// True if the segment leaves P1 and reaches P2 on the sides that face the apex, by more than
/// rounding: neighbours on one plane do not.
bool faceEachOther(const HitPoint& one, const HitPoint& two)
{
  const Vec3 step = two.point - one.point;
  const double margin = surfaceMargin(std::max(one.range, two.range));
  return glm::dot(one.normal, step) > margin && glm::dot(two.normal, step) < -margin &&
    safeLength(step) > 2.0 * margin;
}

/// The solid angle under which P1 sees the part of the surface that fills the cone around P2, over
/// pi.
double formFactor(const BeamFrame& frame, const HitPoint& one, const HitPoint& two,
  const Vec3& towards, double length, double cosIncidence)
{
  const double cosOut = glm::dot(one.normal, towards);
  const double cosIn = -glm::dot(two.normal, towards);
  const double lit =
    two.range * two.range * coneSolidAngle(frame.halfBeamwidth) / std::max(cosIncidence, 1e-300);
  return cosOut * cosIn * lit / (Pi * length * length);
}

PathNumbers numbersOf(const SecondaryReflection::Beam& beam)
{
  return { beam.hits.rays, beam.trace.connections };
}
}

double coneSolidAngle(double halfBeamwidth)
{
  const double s = std::sin(0.5 * halfBeamwidth);
  return 4.0 * Pi * s * s;
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
    this->findLinks(beam, connections);
  }
}

void SecondaryReflection::findLinks(const Beam& beam, std::uint32_t connections)
{
  SecondaryTrace& trace = beam.trace;
  trace.unknown -= std::count_if(trace.links.begin(), trace.links.end(),
    [](const SecondaryLink& link) { return link.visibility == Visibility::Unknown; });
  trace.links.clear();
  trace.paths.erase(std::remove_if(trace.paths.begin(), trace.paths.end(),
                      [](const PathGeometry& path) { return path.link != NoLink; }),
    trace.paths.end());
  trace.connections = connections;
  trace.linksKnown = true;
  // Points of one plane do not look at each other.
  if (connections == 0 || beam.hits.coplanar)
  {
    return;
  }
  const Scene scene = beam.scene();
  const std::uint32_t rays = beam.hits.rays;
  this->chooseShifts(beam.id, rays);
  this->HitOfRay.assign(rays, NoLink);
  for (std::uint32_t hit = 0; hit < beam.hits.size(); ++hit)
  {
    this->HitOfRay[beam.hits.ray[hit]] = hit;
  }
  for (std::uint32_t one = 0; one < beam.hits.size(); ++one)
  {
    askWhetherWanted(beam, one);
    const std::uint32_t n = beam.hits.ray[one];
    const HitPoint from(beam.hits, scene.geometry, one);
    for (std::uint32_t k = 0; k < connections; ++k)
    {
      const std::uint32_t sum = n + this->Shifts[k];
      const std::uint32_t partner = sum < rays ? sum : sum - rays;
      const std::uint32_t two = this->HitOfRay[partner];
      if (two != NoLink && scene.geometry.surface[one] != scene.geometry.surface[two] &&
        faceEachOther(from, HitPoint(beam.hits, scene.geometry, two)))
      {
        const double share = this->solidAngleShare(scene, partner);
        trace.links.push_back(
          { one, two, k, Visibility::Unknown, this->partnerWeight(beam, n, partner, share) });
      }
    }
  }
  trace.unknown += trace.links.size();
}

void SecondaryReflection::chooseShifts(std::uint64_t beam, std::uint32_t rays)
{
  const std::uint32_t count = connectionsOf(this->Setup.settings, rays);
  this->Shifts.clear();
  if (count == 0)
  {
    return;
  }
  const std::uint32_t last = rays - 1; // shifts are 1 ... N - 1
  this->Taken.assign(last + 1, 0);
  // Floyd's sampling of `count` different numbers out of 1 ... last.
  for (std::uint32_t i = last - count + 1; i <= last; ++i)
  {
    const double u = uniformPair(this->Setup.settings.seed, beam, i, RandomPurpose::Connections)[0];
    const std::uint32_t drawn = 1 + std::min(i - 1, static_cast<std::uint32_t>(u * i));
    const std::uint32_t shift = this->Taken[drawn] ? i : drawn;
    this->Taken[shift] = 1;
    this->Shifts.push_back(shift);
  }
}

/// Uniform solid angle that a ray stands for, over the cone's: 1 unless Gaussian. There rays are
/// denser on the axis: over the density (1 - e^-2)^-1 2 e^-2u they stand for equal solid angles.
double SecondaryReflection::solidAngleShare(const Scene& scene, std::uint32_t ray) const
{
  const Sensor& sensor = this->Setup.sensor;
  if (sensor.beamProfile == BeamProfile::Uniform)
  {
    return 1.0;
  }
  const double half = std::sin(0.5 * sensor.halfBeamwidth);
  const double x = scene.rays.x[ray];
  const double y = scene.rays.y[ray];
  const double tan2 = scene.frame.tanHalf * scene.frame.tanHalf * (x * x + y * y);
  const double length = std::sqrt(1.0 + tan2);
  const double u = tan2 / (length * (1.0 + length)) / (2.0 * half * half);
  return -std::expm1(-2.0) / (2.0 * std::exp(-2.0 * std::min(1.0, u)));
}

/// The sum over the M connections of a ray of weight times value estimates the mean of the value
/// over the cone. Partners in the ray's own stratum stand for the whole of it, as the ray itself
/// cannot be its partner.
double SecondaryReflection::partnerWeight(
  const Beam& beam, std::uint32_t n, std::uint32_t partner, double partnerShare) const
{
  const double rays = static_cast<double>(beam.hits.rays);
  double weight = 1.0 / (rays - 1.0);
  if (beam.strata)
  {
    const std::size_t cell = beam.strata->cellOfRay(n);
    weight = 1.0 / rays;
    if (beam.strata->cellOfRay(partner) == cell)
    {
      const double inCell = static_cast<double>(beam.strata->raysInCell(cell));
      weight *= inCell / (inCell - 1.0);
    }
  }
  return weight * partnerShare * (rays - 1.0) / static_cast<double>(this->Shifts.size());
}

//--- what it is worth -----------------------------------------------------------------------------

/// Per hit, so that the links of a beam cost a few multiplications each.
void SecondaryReflection::findBounds(const Beam& beam)
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const bool aperture = this->Setup.sensor.receiverAperture > 0.0;
  const bool links = !beam.trace.links.empty();
  const std::size_t count = beam.hits.size();
  this->Bounds.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Material m{ beam.light.kd[i], beam.light.ks[i], beam.light.kp[i] };
    const Reflectance most = reflectanceBound(model, m, beam.hits.cosine[i]);
    HitBounds& bounds = this->Bounds[i];
    // With an aperture the form factor of a connection may exceed its weight; it is at most 1.
    bounds.diffuse = this->RayEnergy * (aperture ? m.kd : most.diffuse);
    // By the triangle inequality no path over a point at range r is shorter than 2 r.
    bounds.specular = this->RayEnergy * most.specular *
      (aperture ? 1.0 : this->Setup.largestReflectance) * beam.light.air[i];
    bounds.second = links ? this->secondBound(m, beam.hits.range[i]) : 0.0;
    bounds.air = beam.light.air[i];
  }
}

double SecondaryReflection::mirrorBound(std::uint32_t hit) const
{
  return this->Bounds[hit].specular;
}

/// The most that a surface returns at P2: kd + ks, or through an aperture the cap of 1.
double SecondaryReflection::secondBound(const Material& m, double range) const
{
  const double aperture = this->Setup.sensor.receiverAperture;
  const double most = m.kd + m.ks;
  if (aperture <= 0.0)
  {
    return most;
  }
  return std::min(1.0, most * std::max(1.0, 0.5 * (m.kp + 1.0)) * aperture / (Pi * range * range));
}

double SecondaryReflection::linkBound(const SecondaryLink& link) const
{
  const double weight = this->Setup.sensor.receiverAperture > 0.0 ? 1.0 : link.weight;
  const HitBounds& one = this->Bounds[link.one];
  const HitBounds& two = this->Bounds[link.two];
  return weight * one.diffuse * two.second * std::min(one.air, two.air);
}

double SecondaryReflection::sumOfBounds(const Beam& beam) const
{
  double sum = 0.0;
  for (std::uint32_t hit = 0; hit < beam.hits.size(); ++hit)
  {
    sum += this->mirrorBound(hit);
  }
  for (const SecondaryLink& link : beam.trace.links)
  {
    sum += this->linkBound(link);
  }
  return sum;
}

double SecondaryReflection::bound(const Beam& beam)
{
  this->RayEnergy = this->Setup.sensor.pulseEnergy / beam.hits.rays;
  if (beam.trace.isDark() &&
    beam.trace.connections == connectionsOf(this->Setup.settings, beam.hits.rays))
  {
    return 0.0;
  }
  // A ray returns kd + ks at most; on one plane there are mirror paths alone.
  double sum = 0.0;
  if (beam.hits.coplanar && this->Setup.sensor.receiverAperture <= 0.0)
  {
    this->findBounds(beam);
    for (std::uint32_t hit = 0; hit < beam.hits.size(); ++hit)
    {
      sum += this->mirrorBound(hit);
    }
    return sum;
  }
  for (std::uint32_t i = 0; i < beam.hits.size(); ++i)
  {
    sum += this->budgetOf(beam, i);
  }
  return sum * this->RayEnergy;
}

double SecondaryReflection::budgetOf(const Beam& beam, std::uint32_t hit) const
{
  return std::max(0.0, beam.light.kd[hit] + beam.light.ks[hit] - beam.light.reflected[hit]);
}

double SecondaryReflection::scale(const Beam& beam, std::uint32_t hit, const Material& second) const
{
  const Material first{ beam.light.kd[hit], beam.light.ks[hit], beam.light.kp[hit] };
  const double passedOn = this->Setup.sensor.receiverAperture > 0.0
    ? first.kd + first.ks
    : reflectanceBound(this->Setup.settings.reflectanceModel, first, beam.hits.cosine[hit]).total();
  const double budget = this->budgetOf(beam, hit);
  const double passed = passedOn * (second.kd + second.ks);
  return passed > budget ? budget / passed : 1.0;
}

double SecondaryReflection::energyOf(const Beam& beam, const PathGeometry& path) const
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const double aperture = this->Setup.sensor.receiverAperture;
  const Material first{ beam.light.kd[path.one], beam.light.ks[path.one], beam.light.kp[path.one] };
  const Material& second = this->Setup.materials[path.triangle];
  double f1 = 0.0;
  if (path.link == NoLink)
  {
    f1 = specularReflectance(model, first, path.first);
  }
  else
  {
    const double weight = beam.trace.links[path.link].weight;
    f1 = aperture > 0.0 ? first.kd * std::min(1.0, weight * path.formFactor)
                        : weight * diffuseReflectance(model, first, path.first);
  }
  ReflectionGeometry back = path.second;
  if (aperture > 0.0)
  {
    back.cosIncidence = back.cosOutgoing;
  }
  const double f2 =
    throughAperture(reflectance(model, second, back), second.kp, aperture, path.range).total();
  return this->RayEnergy * f1 * f2 * this->scale(beam, path.one, second) *
    transmission(this->Setup.settings.attenuationCoefficient, path.length);
}

//--- tracing --------------------------------------------------------------------------------------

std::uint32_t SecondaryReflection::mirrorEnd(
  const Beam& beam, const Scene& scene, std::uint32_t hit, const Vec3& direction) const
{
  const bool coneOnly = this->Setup.settings.beamConstraint;
  const HitPoint from(beam.hits, scene.geometry, hit);
  // With the beam constraint the search ends where the path leaves the cone.
  const double reach = coneOnly ? distanceInCone(scene.frame, from.point, from.range, direction)
                                : std::numeric_limits<double>::infinity();
  const Hit end = scene.tracer.traceFrom(
    from.point, direction, surfaceMargin(from.range), beam.hits.triangle[hit], coneOnly, reach);
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

void SecondaryReflection::traceMirror(const Beam& beam, const Scene& scene, std::uint32_t hit)
{
  const HitPoint from(beam.hits, scene.geometry, hit);
  const Vec3 incident = scene.geometry.direction(hit);
  const Vec3 direction = mirrorDirection(incident, from.normal);
  const std::uint32_t triangle = this->mirrorEnd(beam, scene, hit, direction);
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
  beam.trace.paths.push_back({ numbersOf(beam).mirror(beam.hits.ray[hit]), hit, triangle, NoLink,
    from.range + length + range, range, std::acos(std::min(1.0, -towards)), 0.0,
    mirrorGeometry(beam.hits.cosine[hit]),
    reflectionGeometry(direction, -point / range, end.normal) });
}

void SecondaryReflection::traceLink(const Beam& beam, const Scene& scene, std::uint32_t index)
{
  SecondaryLink& link = beam.trace.links[index];
  const HitPoint one(beam.hits, scene.geometry, link.one);
  const HitPoint two(beam.hits, scene.geometry, link.two);
  const double margin = surfaceMargin(std::max(one.range, two.range));
  const std::uint32_t triangle = beam.hits.triangle[link.two];
  const bool blocked = scene.tracer.occluded(one.point, two.point, margin,
    beam.hits.triangle[link.one], triangle, this->Setup.settings.beamConstraint);
  link.visibility = blocked ? Visibility::Blocked : Visibility::Clear;
  if (blocked)
  {
    return;
  }
  const Vec3 step = two.point - one.point;
  const double length = safeLength(step);
  const Vec3 towards = step / length;
  const double cosIn = std::min(1.0, -glm::dot(two.normal, towards));
  beam.trace.paths.push_back({ numbersOf(beam).connection(beam.hits.ray[link.one], link.connection),
    link.one, triangle, index, one.range + length + two.range, two.range, std::acos(cosIn),
    formFactor(scene.frame, one, two, towards, length, beam.hits.cosine[link.two]),
    reflectionGeometry(scene.geometry.direction(link.one), towards, one.normal),
    reflectionGeometry(towards, -two.point / two.range, two.normal) });
}

/// Trace what is not known yet and may carry as much as `threshold`.
void SecondaryReflection::traceUnknown(const Beam& beam, double threshold)
{
  SecondaryTrace& trace = beam.trace;
  const std::size_t before = trace.paths.size();
  const Scene scene = beam.scene();
  const std::vector<char>* occupied = this->Setup.settings.beamConstraint
    ? &this->Space.look(*this->Setup.tree, scene.frame, beam.hits, scene.geometry)
    : nullptr;
  for (std::uint32_t hit = 0; hit < beam.hits.size(); ++hit)
  {
    askWhetherWanted(beam, hit);
    const double bound = this->mirrorBound(hit);
    if (trace.mirror[hit] != MirrorEnd::NotTraced || !(bound > 0.0 && bound >= threshold))
    {
      continue;
    }
    --trace.unknown;
    if (occupied && !(*occupied)[scene.geometry.surface[hit]])
    {
      trace.mirror[hit] = MirrorEnd::Nowhere;
    }
    else
    {
      this->traceMirror(beam, scene, hit);
    }
  }
  for (std::uint32_t i = 0; i < trace.links.size(); ++i)
  {
    askWhetherWanted(beam, i);
    const double bound = this->linkBound(trace.links[i]);
    if (trace.links[i].visibility == Visibility::Unknown && bound > 0.0 && bound >= threshold)
    {
      --trace.unknown;
      this->traceLink(beam, scene, i);
    }
  }
  if (trace.paths.size() > before)
  {
    std::sort(trace.paths.begin(), trace.paths.end(),
      [](const PathGeometry& a, const PathGeometry& b) { return a.path < b.path; });
  }
}

void SecondaryReflection::collect(const Beam& beam, std::vector<SecondaryPath>& paths, double& lost)
{
  this->RayEnergy = this->Setup.sensor.pulseEnergy / beam.hits.rays;
  this->prepare(beam);
  if (beam.trace.isDark())
  {
    return;
  }
  this->findBounds(beam);
  double threshold = 0.0;
  if (this->Setup.settings.lightEnergyConstraint)
  {
    const double budget = LightEnergyTolerance * this->Setup.sensor.lowerEnergyLimit;
    const double all = this->sumOfBounds(beam);
    if (all + lost < budget)
    {
      lost += all;
      return;
    }
    threshold = budget / static_cast<double>(numbersOf(beam).total());
  }
  if (beam.trace.unknown > 0)
  {
    this->traceUnknown(beam, threshold);
  }
  this->lightPaths(beam, threshold, paths, lost);
}

void SecondaryReflection::lightPaths(
  const Beam& beam, double threshold, std::vector<SecondaryPath>& paths, double& lost)
{
  this->Returned.assign(beam.trace.paths.empty() ? 0 : beam.hits.size(), 0.0);
  const std::size_t begin = paths.size();
  for (const PathGeometry& path : beam.trace.paths)
  {
    const double bound = path.link == NoLink ? this->mirrorBound(path.one)
                                             : this->linkBound(beam.trace.links[path.link]);
    if (!(bound > 0.0 && bound >= threshold))
    {
      lost += bound;
      continue;
    }
    const double energy = this->energyOf(beam, path);
    if (energy > 0.0)
    {
      paths.push_back({ { path.length, energy, path.path }, path.triangle, path.angle, path.one });
      this->Returned[path.one] += energy;
    }
  }
  // The random weights of the connections may together exceed 1: cut what passes the ray's budget.
  for (std::size_t i = begin; i < paths.size(); ++i)
  {
    const double sum = this->Returned[paths[i].one];
    const double budget = this->budgetOf(beam, paths[i].one) * this->RayEnergy;
    if (sum > budget)
    {
      paths[i].contribution.energy *= budget / sum;
    }
  }
  for (std::uint32_t hit = 0; beam.trace.unknown > 0 && hit < beam.hits.size(); ++hit)
  {
    lost += beam.trace.mirror[hit] == MirrorEnd::NotTraced ? this->mirrorBound(hit) : 0.0;
  }
  for (const SecondaryLink& link : beam.trace.links)
  {
    lost += link.visibility == Visibility::Unknown ? this->linkBound(link) : 0.0;
  }
}
}
