// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryReflection.h"

#include "LaneMath.h"
#include "ParallelLoop.h"
#include "Propagation.h"
#include "Random.h"
#include "TraceVisitors.h"

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
    , normal(geometry.normal(hit))
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
    glm::dot(step, step) > 4.0 * margin * margin;
}

/// What the energies of links are made from: links, hits, materials of hits.
struct LinkLanes
{
  const std::uint32_t* one;
  const std::uint32_t* two;
  const double* weight;
  const double* length;
  const double* cosIn;
  const double* cosLobe;
  const double* sin2Lobe;
  const double* range;
  const double* cosine;
  const double* kd;
  const double* ks;
  const double* kp;
  const double* reflected;
};

/// LambertBlinnPhong (see Reflectance.h): f_d at P1, the whole f_sur at P2, and the scale that
/// keeps P1 from passing on more than its direct echo leaves.
AVIANLIDAR_MULTIVERSION void lightAll(
  const LinkLanes& links, double rayEnergy, double attenuation, double* energies, std::size_t count)
{
  const LinkLanes h = links;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::uint32_t a = h.one[i];
    const std::uint32_t b = h.two[i];
    const double diffuse = h.kd[a] * h.cosine[a];
    const double second = h.kd[b] + h.ks[b];
    const double left = h.kd[a] + h.ks[a] - h.reflected[a];
    const double budget = left > 0.0 ? left : 0.0;
    const double passed = (diffuse + h.ks[a]) * second;
    const double scale = passed > budget ? budget / passed : 1.0;
    const double c = h.cosIn[i] < 1.0 ? h.cosIn[i] : 1.0;
    const double f2 = h.kd[b] * c + h.ks[b] * lanes::lobe(h.cosLobe[i], h.sin2Lobe[i], h.kp[b]);
    const double length = h.range[a] + h.length[i] + h.range[b];
    energies[i] =
      rayEnergy * (h.weight[i] * diffuse) * f2 * scale * lanes::exp(-attenuation * length);
  }
}

/// More are not looked at in pairs.
constexpr std::size_t FewSurfaces = 8;

constexpr std::uint32_t NoHit = 0xffffffffu;

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
    trace.links.clear();
    trace.connections = connections;
    // Points of one plane do not look at each other.
    if (connections > 0 && !beam.hits.coplanar)
    {
      this->findLinks(beam, connections);
    }
    trace.linksKnown = true;
    trace.unseen = trace.links.size();
  }
}

/// Pairs of surfaces of which some hits may look at each other: those of either lie, some of them,
/// before the plane of the other. @return false if there are none
bool SecondaryReflection::findFacingSurfaces(const PrimaryHits& hits, const HitGeometry& geometry)
{
  const std::size_t count = geometry.surfaces.size();
  this->Facing.clear();
  if (count > FewSurfaces)
  {
    return true;
  }
  this->Facing.assign(count * count, 0);
  // Highest hit of each surface above the plane of each.
  this->Heights.assign(count * count, 0.0);
  for (std::uint32_t hit = 0; hit < hits.size(); ++hit)
  {
    const Vec3 point = hits.range[hit] * geometry.direction(hit);
    double* heights = this->Heights.data() + geometry.surface[hit] * count;
    for (std::size_t s = 0; s < count; ++s)
    {
      const HitGeometry::Surface& surface = geometry.surfaces[s];
      heights[s] = std::max(heights[s], glm::dot(surface.normal, point) + surface.height);
    }
  }
  bool any = false;
  for (std::size_t one = 0; one < count; ++one)
  {
    for (std::size_t two = 0; two < count; ++two)
    {
      const bool facing = one != two && this->Heights[one * count + two] > 0.0 &&
        this->Heights[two * count + one] > 0.0;
      this->Facing[one * count + two] = facing;
      any = any || facing;
    }
  }
  return any;
}

void SecondaryReflection::findLinks(const Beam& beam, std::uint32_t connections)
{
  const Scene scene = beam.scene();
  if (!this->findFacingSurfaces(beam.hits, scene.geometry))
  {
    return;
  }
  const std::vector<std::uint32_t>& surface = scene.geometry.surface;
  const auto mayFace = [&](std::uint32_t one, std::uint32_t two)
  {
    return this->Facing.empty()
      ? surface[one] != surface[two]
      : this->Facing[surface[one] * scene.geometry.surfaces.size() + surface[two]] != 0;
  };
  const std::uint32_t rays = beam.hits.rays;
  this->chooseShifts(beam.id, rays);
  this->HitOfRay.assign(rays, NoHit);
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
      if (two != NoHit && mayFace(one, two) &&
        faceEachOther(from, HitPoint(beam.hits, scene.geometry, two)))
      {
        const double share = this->solidAngleShare(scene, partner);
        beam.trace.links.add(one, two, k, this->partnerWeight(beam, n, partner, share));
      }
    }
  }
  beam.trace.links.measure(beam.hits, scene.geometry);
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
    sum += this->budgetOf(beam, hit);
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
  return this->RayEnergy * f1 * f2 * this->scale(beam, path.one, second) *
    transmission(this->Setup.settings.attenuationCoefficient, path.length);
}

/// LinkEnergies: in lanes for the paper's own model without an aperture.
void SecondaryReflection::lightLinks(const Beam& beam)
{
  const SecondaryLinks& links = beam.trace.links;
  const std::size_t count = links.size();
  this->LinkEnergies.resize(count);
  if (this->Setup.settings.reflectanceModel != ReflectanceModel::LambertBlinnPhong ||
    this->Setup.sensor.receiverAperture > 0.0)
  {
    this->lightLinksOneByOne(beam);
    return;
  }
  const DirectLight& light = beam.light;
  const LinkLanes lanes{ links.one.data(), links.two.data(), links.weight.data(),
    links.length.data(), links.cosIn.data(), links.cosLobe.data(), links.sin2Lobe.data(),
    beam.hits.range.data(), beam.hits.cosine.data(), light.kd.data(), light.ks.data(),
    light.kp.data(), light.reflected.data() };
  lightAll(lanes, this->RayEnergy, this->Setup.settings.attenuationCoefficient,
    this->LinkEnergies.data(), count);
}

void SecondaryReflection::lightLinksOneByOne(const Beam& beam)
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const double aperture = this->Setup.sensor.receiverAperture;
  const SecondaryLinks& links = beam.trace.links;
  const DirectLight& light = beam.light;
  for (std::size_t i = 0; i < links.size(); ++i)
  {
    const std::uint32_t one = links.one[i];
    const std::uint32_t two = links.two[i];
    const Material first{ light.kd[one], light.ks[one], light.kp[one] };
    const Material second{ light.kd[two], light.ks[two], light.kp[two] };
    const double range = beam.hits.range[two];
    const double cosBack = beam.hits.cosine[two];
    double f1 = 0.0;
    if (aperture > 0.0)
    {
      // The solid angle under which P1 sees the part of the surface that fills the cone around P2,
      // over pi.
      const double lit = range * range * coneSolidAngle(this->Setup.sensor.halfBeamwidth) /
        std::max(cosBack, 1e-300);
      const double form =
        links.cosOut[i] * links.cosIn[i] * lit / (Pi * links.length[i] * links.length[i]);
      f1 = first.kd * std::min(1.0, links.weight[i] * form);
    }
    else
    {
      ReflectionGeometry out;
      out.cosIncidence = beam.hits.cosine[one];
      out.cosOutgoing = links.cosOut[i];
      out.cosDifference = links.differenceOne[i];
      f1 = links.weight[i] * diffuseReflectance(model, first, out);
    }
    const ReflectionGeometry back{ aperture > 0.0 ? cosBack : links.cosIn[i], cosBack,
      links.cosLobe[i], links.sin2Lobe[i], links.sin2Half[i], links.differenceTwo[i] };
    const double f2 =
      throughAperture(reflectance(model, second, back), second.kp, aperture, range).total();
    const double length = beam.hits.range[one] + links.length[i] + range;
    this->LinkEnergies[i] = this->RayEnergy * f1 * f2 * this->scale(beam, one, second) *
      transmission(this->Setup.settings.attenuationCoefficient, length);
  }
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
    askWhetherWanted(beam, hit);
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
    askWhetherWanted(beam, link);
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
  this->lightLinks(beam);
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
    const double budget = this->budgetOf(beam, paths[i].one) * this->RayEnergy;
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
