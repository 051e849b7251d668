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
void askWhetherWanted(const SecondaryReflection::Beam& beam, std::uint32_t ray)
{
  constexpr std::uint32_t interval = 4096;
  if (beam.wanted && *beam.wanted && ray % interval == interval - 1 && !(*beam.wanted)())
  {
    throw WorkStopped();
  }
}

/// How far a path from `point` inside the cone stays in it, m, rather too long than too short.
double distanceInCone(const BeamFrame& frame, const Vec3& point, const Vec3& direction)
{
  // p . p cos^2 - (p . axis)^2 = 0 on the cone, a quadratic in the length s.
  const double cos2 = frame.cosHalf * frame.cosHalf;
  const double along = glm::dot(point, frame.axis);
  const double turn = glm::dot(direction, frame.axis);
  const double a = cos2 - turn * turn;
  const double b = cos2 * glm::dot(point, direction) - along * turn;
  const double c = std::min(0.0, cos2 * glm::dot(point, point) - along * along);
  const double range = safeLength(point);
  if (!(a > 1e-9))
  {
    return std::numeric_limits<double>::infinity(); // within the cone of directions, or nearly
  }
  const double reach = (std::sqrt(std::max(0.0, b * b - a * c)) - b) / a;
  return reach * (1.0 + 1e-6) + 1e-6 * range;
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

void SecondaryReflection::collect(const Beam& beam, std::vector<SecondaryPath>& paths, double& lost)
{
  const auto rays = static_cast<std::uint32_t>(beam.hits.size());
  const std::uint32_t connections = connectionsOf(this->Setup.settings, rays);
  this->RayEnergy = this->Setup.sensor.pulseEnergy / rays;
  this->chooseShifts(beam.id, rays);
  this->findBounds(beam);
  const double all = this->sumOfBounds(beam);
  double threshold = 0.0;
  if (this->Setup.settings.lightEnergyConstraint)
  {
    const double budget = LightEnergyTolerance * this->Setup.sensor.lowerEnergyLimit;
    if (all + lost < budget)
    {
      lost += all;
      return;
    }
    threshold = budget / static_cast<double>(PathNumbers{ rays, connections }.total());
  }
  BeamTrace& trace = beam.trace;
  if (trace.mirror.empty())
  {
    trace.mirror.assign(rays, NotTraced);
  }
  if (trace.connections != connections)
  {
    trace.links.clear();
    trace.connections = connections;
  }
  if (trace.links.empty())
  {
    trace.links.assign(static_cast<std::size_t>(rays) * connections, Visibility::Unknown);
  }
  for (std::uint32_t n = 0; n < rays; ++n)
  {
    askWhetherWanted(beam, n);
    if (beam.hits[n].valid())
    {
      this->collectOfRay(beam, n, threshold, paths, lost);
    }
  }
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

/// The sum over the M connections of a ray of weight times value estimates the mean of the value
/// over the cone. Partners in the ray's own stratum stand for the whole of it, as the ray itself
/// cannot be its partner.
double SecondaryReflection::partnerWeight(
  const Beam& beam, std::uint32_t n, std::uint32_t partner) const
{
  const double rays = static_cast<double>(beam.hits.size());
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
  return weight * beam.hits[partner].share * (rays - 1.0) /
    static_cast<double>(this->Shifts.size());
}

/// Per hit, so that the pairs of a beam cost a few multiplications each.
void SecondaryReflection::findBounds(const Beam& beam)
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const bool aperture = this->Setup.sensor.receiverAperture > 0.0;
  this->Bounds.assign(beam.hits.size(), HitBounds{});
  for (std::size_t n = 0; n < beam.hits.size(); ++n)
  {
    const RayHit& hit = beam.hits[n];
    if (!hit.valid())
    {
      continue;
    }
    const Material& m = this->Setup.materials[hit.triangle];
    const Reflectance most = reflectanceBound(model, m, hit.cosIncidence);
    HitBounds& bounds = this->Bounds[n];
    // With an aperture the form factor of a connection may exceed its weight; it is at most 1.
    bounds.diffuse = this->RayEnergy * (aperture ? m.kd : most.diffuse);
    bounds.specular =
      this->RayEnergy * most.specular * (aperture ? 1.0 : this->Setup.largestReflectance);
    bounds.passed = aperture ? m.kd + m.ks : most.total();
    bounds.second = this->secondBound(m, hit.range);
    // By the triangle inequality no path over a point at range r is shorter than 2 r.
    bounds.air = transmission(this->Setup.settings.attenuationCoefficient, 2.0 * hit.range);
  }
}

double SecondaryReflection::mirrorBound(std::uint32_t n) const
{
  return this->Bounds[n].specular * this->Bounds[n].air;
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

/// True if the segment leaves P1 and reaches P2 on the sides that face the apex, by more than
/// rounding: neighbours on one plane do not.
bool SecondaryReflection::faceEachOther(const RayHit& one, const RayHit& two)
{
  const Vec3 step = two.point - one.point;
  const double margin = surfaceMargin(std::max(one.range, two.range));
  return glm::dot(one.normal, step) > margin && glm::dot(two.normal, step) < -margin &&
    safeLength(step) > 2.0 * margin;
}

double SecondaryReflection::connectionBound(
  const Beam& beam, std::uint32_t n, std::uint32_t partner) const
{
  const RayHit& two = beam.hits[partner];
  if (!two.valid() || !faceEachOther(beam.hits[n], two))
  {
    return 0.0;
  }
  const double weight =
    this->Setup.sensor.receiverAperture > 0.0 ? 1.0 : this->partnerWeight(beam, n, partner);
  return weight * this->Bounds[n].diffuse * this->Bounds[partner].second *
    std::min(this->Bounds[n].air, this->Bounds[partner].air);
}

/// Bounds of all connections, kept for collectOfRay(), and the sum of these and of the mirror
/// paths.
double SecondaryReflection::sumOfBounds(const Beam& beam)
{
  double sum = 0.0;
  const auto rays = static_cast<std::uint32_t>(beam.hits.size());
  this->ConnectionBounds.assign(static_cast<std::size_t>(rays) * this->Shifts.size(), 0.0);
  for (std::uint32_t n = 0; n < rays; ++n)
  {
    askWhetherWanted(beam, n);
    if (!beam.hits[n].valid())
    {
      continue;
    }
    sum += this->mirrorBound(n);
    for (std::uint32_t k = 0; k < this->Shifts.size(); ++k)
    {
      const double bound = this->connectionBound(beam, n, (n + this->Shifts[k]) % rays);
      this->ConnectionBounds[static_cast<std::size_t>(n) * this->Shifts.size() + k] = bound;
      sum += bound;
    }
  }
  return sum;
}

double SecondaryReflection::scale(const RayHit& hit, double passedOn, const Material& second) const
{
  const Material& m = this->Setup.materials[hit.triangle];
  const double budget = std::max(0.0, m.kd + m.ks - hit.direct);
  const double passed = passedOn * (second.kd + second.ks);
  return passed > budget ? budget / passed : 1.0;
}

void SecondaryReflection::collectOfRay(const Beam& beam, std::uint32_t n, double threshold,
  std::vector<SecondaryPath>& paths, double& lost)
{
  const RayHit& hit = beam.hits[n];
  const std::size_t begin = paths.size();
  const double mirror = this->mirrorBound(n);
  if (mirror > 0.0 && mirror >= threshold)
  {
    this->followMirror(beam, n, paths);
  }
  else
  {
    lost += mirror;
  }
  for (std::uint32_t k = 0; k < this->Shifts.size(); ++k)
  {
    const double bound =
      this->ConnectionBounds[static_cast<std::size_t>(n) * this->Shifts.size() + k];
    if (bound > 0.0 && bound >= threshold)
    {
      this->connect(beam, n, k, paths);
    }
    else
    {
      lost += bound;
    }
  }
  // The random weights of the connections may together exceed 1: cut what passes the ray's budget.
  double sum = 0.0;
  for (std::size_t i = begin; i < paths.size(); ++i)
  {
    sum += paths[i].contribution.energy;
  }
  const Material& m = this->Setup.materials[hit.triangle];
  const double budget = std::max(0.0, m.kd + m.ks - hit.direct) * this->RayEnergy;
  if (sum > budget)
  {
    for (std::size_t i = begin; i < paths.size(); ++i)
    {
      paths[i].contribution.energy *= budget / sum;
    }
  }
}

Reflectance SecondaryReflection::secondReflectance(
  const Vec3& incident, const Vec3& point, const Vec3& normal, const Material& m) const
{
  const double range = safeLength(point);
  ReflectionGeometry geometry = reflectionGeometry(incident, -point / range, normal);
  const double aperture = this->Setup.sensor.receiverAperture;
  if (aperture > 0.0)
  {
    geometry.cosIncidence = geometry.cosOutgoing;
  }
  return throughAperture(
    reflectance(this->Setup.settings.reflectanceModel, m, geometry), m.kp, aperture, range);
}

void SecondaryReflection::followMirror(
  const Beam& beam, std::uint32_t n, std::vector<SecondaryPath>& paths)
{
  const RayHit& hit = beam.hits[n];
  const Vec3 direction = mirrorDirection(hit.direction, hit.normal);
  std::uint32_t& known = beam.trace.mirror[n];
  if (known == NotTraced)
  {
    known = this->traceMirror(beam, hit, direction);
  }
  if (known == NoTriangle)
  {
    return;
  }
  // The end point follows from the triangle alone, so that a path known from before gives the same
  // bits.
  const LocalTriangle end = localTriangle(*this->Setup.tree->mesh, known, beam.frame.origin);
  const double towards = glm::dot(end.normal, direction);
  const double length = glm::dot(end.normal, end.a - hit.point) / towards;
  const Vec3 point = hit.point + length * direction;
  const Material& m1 = this->Setup.materials[hit.triangle];
  const Material& m2 = this->Setup.materials[known];
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const double f1 = specularReflectance(model, m1, mirrorGeometry(hit.cosIncidence));
  const double f2 = this->secondReflectance(direction, point, end.normal, m2).total();
  const double total = hit.range + length + safeLength(point);
  const double energy = this->RayEnergy * f1 * f2 * this->scale(hit, this->Bounds[n].passed, m2) *
    transmission(this->Setup.settings.attenuationCoefficient, total);
  if (energy > 0.0)
  {
    const auto rays = static_cast<std::uint32_t>(beam.hits.size());
    const PathNumbers numbers{ rays, static_cast<std::uint32_t>(this->Shifts.size()) };
    paths.push_back(
      { { total, energy, numbers.mirror(n) }, known, std::acos(std::min(1.0, -towards)) });
  }
}

std::uint32_t SecondaryReflection::traceMirror(
  const Beam& beam, const RayHit& hit, const Vec3& direction) const
{
  const bool coneOnly = this->Setup.settings.beamConstraint;
  const double margin = surfaceMargin(hit.range);
  // With the beam constraint the search ends where the path leaves the cone.
  const double reach = coneOnly ? distanceInCone(beam.frame, hit.point, direction)
                                : std::numeric_limits<double>::infinity();
  const Hit end =
    beam.tracer.traceFrom(hit.point, direction, margin, hit.triangle, coneOnly, reach);
  if (!end.valid())
  {
    return NoTriangle;
  }
  const Vec3 point = hit.point + end.range * direction;
  if (!beam.frame.contains(point))
  {
    return NoTriangle;
  }
  const LocalTriangle triangle =
    localTriangle(*this->Setup.tree->mesh, end.triangle, beam.frame.origin);
  if (glm::dot(triangle.normal, direction) >= 0.0)
  {
    return NoTriangle; // it meets the side that looks away from the lidar
  }
  const Hit seen = beam.tracer.traceFromApex(point, coneOnly);
  const double range = safeLength(point);
  const bool visible =
    !seen.valid() || seen.triangle == end.triangle || seen.range >= range - surfaceMargin(range);
  return visible ? end.triangle : NoTriangle;
}

double SecondaryReflection::connectionShare(
  const Beam& beam, const RayHit& one, const RayHit& two, const Vec3& towards, double length) const
{
  // The solid angle under which P1 sees the part of the surface that fills the cone around P2, over
  // pi.
  const double cosOut = glm::dot(one.normal, towards);
  const double cosIn = -glm::dot(two.normal, towards);
  const double lit = two.range * two.range * coneSolidAngle(beam.frame.halfBeamwidth) /
    std::max(two.cosIncidence, 1e-300);
  return cosOut * cosIn * lit / (Pi * length * length);
}

void SecondaryReflection::connect(
  const Beam& beam, std::uint32_t n, std::uint32_t k, std::vector<SecondaryPath>& paths)
{
  const auto rays = static_cast<std::uint32_t>(beam.hits.size());
  const std::uint32_t partner = (n + this->Shifts[k]) % rays;
  const RayHit& one = beam.hits[n];
  const RayHit& two = beam.hits[partner];
  const Vec3 step = two.point - one.point;
  const double length = safeLength(step);
  const double margin = surfaceMargin(std::max(one.range, two.range));
  Visibility& visibility = beam.trace.links[static_cast<std::size_t>(n) * this->Shifts.size() + k];
  if (visibility == Visibility::Unknown)
  {
    const bool blocked = beam.tracer.occluded(one.point, two.point, margin, one.triangle,
      two.triangle, this->Setup.settings.beamConstraint);
    visibility = blocked ? Visibility::Blocked : Visibility::Clear;
  }
  if (visibility == Visibility::Blocked)
  {
    return;
  }
  const Vec3 towards = step / length;
  const Material& m1 = this->Setup.materials[one.triangle];
  const Material& m2 = this->Setup.materials[two.triangle];
  double f1 = 0.0;
  if (this->Setup.sensor.receiverAperture > 0.0)
  {
    f1 = m1.kd *
      std::min(1.0,
        this->partnerWeight(beam, n, partner) *
          this->connectionShare(beam, one, two, towards, length));
  }
  else
  {
    f1 = this->partnerWeight(beam, n, partner) *
      diffuseReflectance(this->Setup.settings.reflectanceModel, m1,
        reflectionGeometry(one.direction, towards, one.normal));
  }
  const double f2 = this->secondReflectance(towards, two.point, two.normal, m2).total();
  const double total = one.range + length + two.range;
  const double energy = this->RayEnergy * f1 * f2 * this->scale(one, this->Bounds[n].passed, m2) *
    transmission(this->Setup.settings.attenuationCoefficient, total);
  if (energy > 0.0)
  {
    const PathNumbers numbers{ rays, static_cast<std::uint32_t>(this->Shifts.size()) };
    const double cosIn = std::min(1.0, -glm::dot(two.normal, towards));
    paths.push_back(
      { { total, energy, numbers.connection(n, k) }, two.triangle, std::acos(cosIn) });
  }
}
}
