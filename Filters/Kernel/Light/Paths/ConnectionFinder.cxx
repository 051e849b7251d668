// SPDX-License-Identifier: BSD-3-Clause
#include "ConnectionFinder.h"

#include "LaneMath.h"
#include "Multiversion.h"
#include "Random.h"

#include <algorithm>
#include <bitset>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Largest number of surfaces that are tested in pairs.
constexpr std::size_t FewSurfaces = 8;

/// Points, normals and margins of the hits of rays, in lanes.
struct RayHits
{
  const double* px;
  const double* py;
  const double* pz;
  const double* nx;
  const double* ny;
  const double* nz;
  const double* margin;
};

/// Set a bit for each ray whose hit P1 faces the hit P2 of its partner, `shift` rays further: the
/// segment leaves P1 and reaches P2 on the sides that face the apex, by more than rounding. Two
/// hits on one plane do not face each other.
AVIANLIDAR_MULTIVERSION void facingPartners(const RayHits& rayHits, std::size_t shift,
  std::uint64_t bit, std::uint64_t* partners, std::size_t count)
{
  const RayHits h = rayHits;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::size_t j = i + shift;
    const double x = h.px[j] - h.px[i];
    const double y = h.py[j] - h.py[i];
    const double z = h.pz[j] - h.pz[i];
    const double margin = h.margin[i] > h.margin[j] ? h.margin[i] : h.margin[j];
    const double above = (h.nx[i] * x + h.ny[i] * y) + h.nz[i] * z;
    const double below = (h.nx[j] * x + h.ny[j] * y) + h.nz[j] * z;
    const double square = (x * x + y * y) + z * z;
    const bool face = (above > margin) & (below < -margin) & (square > 4.0 * margin * margin);
    partners[i] |= face ? bit : std::uint64_t{ 0 };
  }
}
}

ConnectionFinder::ConnectionFinder(const ScanSetup& setup)
  : Setup(setup)
  , Shape(setup.sensor)
{
}

bool ConnectionFinder::findFacing(const BeamSamples& hits, const SampleGeometry& geometry)
{
  const std::size_t count = geometry.surfaces.size();
  this->Facing.clear();
  if (count > FewSurfaces)
  {
    return true;
  }
  this->Facing.assign(count * count, 0);
  // Height of the highest hit of each surface above the plane of each surface.
  this->Heights.assign(count * count, 0.0);
  for (std::uint32_t hit = 0; hit < hits.size(); ++hit)
  {
    const Vec3 point = hits.range[hit] * geometry.direction(hit);
    double* heights = this->Heights.data() + geometry.surface[hit] * count;
    for (std::size_t s = 0; s < count; ++s)
    {
      const SampleGeometry::Surface& surface = geometry.surfaces[s];
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

bool ConnectionFinder::faces(std::uint32_t surface, std::size_t surfaces) const
{
  const auto row = this->Facing.begin() + (this->Facing.empty() ? 0 : surface * surfaces);
  return this->Facing.empty() || std::find(row, row + surfaces, char{ 1 }) != row + surfaces;
}

void ConnectionFinder::find(const SecondaryBeam& beam, std::uint32_t partners)
{
  if (!this->findFacing(beam.samples, beam.geometry))
  {
    return;
  }
  const std::vector<std::uint32_t>& surface = beam.geometry.surface;
  const auto mayFace = [&](std::uint32_t one, std::uint32_t two)
  {
    return this->Facing.empty()
      ? surface[one] != surface[two]
      : this->Facing[surface[one] * beam.geometry.surfaces.size() + surface[two]] != 0;
  };
  const std::uint32_t rays = beam.samples.rays;
  this->chooseShifts(beam.id, rays, partners);
  this->findPartners(beam.samples, beam.geometry);
  // Because rows have 64 partners, the partners of a ray come in the order of path numbers.
  const std::uint32_t rows = (partners + 63) / 64;
  std::size_t found = 0;
  for (const std::uint64_t ofRay : this->Partners)
  {
    found += std::bitset<64>(ofRay).count();
  }
  SecondaryConnections& connections = beam.trace.connections;
  connections.reserve(found);
  const bool uniform = this->Setup.sensor.beamProfile == BeamProfile::Uniform;
  const double weight = found > 0 ? this->partnerWeight(beam, 0, rays - 1, 1.0) : 0.0;
  for (std::uint32_t one = 0; one < beam.samples.size(); ++one)
  {
    beam.throwIfStopped(one);
    const std::uint32_t n = beam.samples.ray[one];
    for (std::uint32_t row = 0; row < rows; ++row)
    {
      std::uint64_t ofRay = this->Partners[std::size_t{ row } * rays + n];
      for (std::uint32_t k = 64 * row; ofRay != 0; ++k, ofRay >>= 1)
      {
        if ((ofRay & 1) == 0)
        {
          continue;
        }
        const std::uint32_t sum = n + this->Shifts[k];
        const std::uint32_t partner = sum < rays ? sum : sum - rays;
        const std::uint32_t two = this->HitOfRay[partner];
        if (mayFace(one, two))
        {
          // A stratum holds at most three rays, with consecutive numbers.
          const bool distant = partner > n + 2 || n > partner + 2;
          connections.add(one, two,
            uniform && distant
              ? weight
              : this->partnerWeight(beam, n, partner, this->solidAngleShare(beam, partner)));
        }
      }
    }
  }
  connections.measure(beam.samples, beam.geometry);
}

/// Set HitOfRay, Rays and Partners.
void ConnectionFinder::findPartners(const BeamSamples& hits, const SampleGeometry& geometry)
{
  const std::size_t rays = hits.rays;
  RayLanes& lanes = this->Rays;
  for (std::vector<double>* v :
    { &lanes.px, &lanes.py, &lanes.pz, &lanes.nx, &lanes.ny, &lanes.nz, &lanes.margin })
  {
    v->assign(2 * rays, 0.0);
  }
  this->HitOfRay.resize(rays);
  for (std::uint32_t hit = 0; hit < hits.size(); ++hit)
  {
    const std::uint32_t ray = hits.ray[hit];
    this->HitOfRay[ray] = hit;
    const Vec3 point = hits.range[hit] * geometry.direction(hit);
    for (const std::size_t i : { std::size_t{ ray }, rays + ray })
    {
      lanes.px[i] = point.x;
      lanes.py[i] = point.y;
      lanes.pz[i] = point.z;
      lanes.nx[i] = geometry.nx[hit];
      lanes.ny[i] = geometry.ny[hit];
      lanes.nz[i] = geometry.nz[hit];
      lanes.margin[i] = surfaceMargin(hits.range[hit]);
    }
  }
  const RayHits rayHits{ lanes.px.data(), lanes.py.data(), lanes.pz.data(), lanes.nx.data(),
    lanes.ny.data(), lanes.nz.data(), lanes.margin.data() };
  this->Partners.assign((this->Shifts.size() + 63) / 64 * rays, 0);
  for (std::size_t k = 0; k < this->Shifts.size(); ++k)
  {
    facingPartners(rayHits, this->Shifts[k], std::uint64_t{ 1 } << (k % 64),
      this->Partners.data() + k / 64 * rays, rays);
  }
}

void ConnectionFinder::chooseShifts(std::uint64_t beam, std::uint32_t rays, std::uint32_t count)
{
  this->Shifts.clear();
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

/// Solid angle that a ray stands for, over the mean of all rays. The angle is less where rays are
/// denser.
double ConnectionFinder::solidAngleShare(const SecondaryBeam& beam, std::uint32_t ray) const
{
  if (this->Setup.sensor.beamProfile == BeamProfile::Uniform)
  {
    return 1.0; // all rays have the same share
  }
  return 1.0 / this->Shape.density(beam.rays.x[ray], beam.rays.y[ray]);
}

/// Weight of a connection: the sum of weight times value over the M connections of a ray estimates
/// the mean of the value over the cone. Partners in the ray's own stratum stand for the whole
/// stratum, as a ray is not its own partner. @param partnerShare solidAngleShare() of the partner
double ConnectionFinder::partnerWeight(
  const SecondaryBeam& beam, std::uint32_t n, std::uint32_t partner, double partnerShare) const
{
  const double rays = static_cast<double>(beam.samples.rays);
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

namespace
{
/// secondaryScale() in lanes. @param cosine of incidence at P1
template <class Model>
AVIANLIDAR_ALWAYS_INLINE double scaleOf(
  Material first, Material second, double cosine, double direct, double aperture)
{
  const double bound = Model::bound(first, cosine).total();
  const double passed = (aperture > 0.0 ? first.albedo() : bound) * second.albedo();
  const double budget = lanes::larger(first.albedo() - direct, 0.0);
  return passed > budget ? budget / passed : 1.0;
}

/// Inputs of the throughputs of connections: connections, samples, materials of the samples.
struct ConnectionLanes
{
  const std::uint32_t *one, *two;
  const double *weight, *length, *cosOut, *differenceOne;
  const double *cosIn, *cosLobe, *sin2Lobe, *sin2Half, *differenceTwo;
  const double *cosine, *range, *direct;
  MaterialLanes::View material;
  double share;      ///< share of the pulse of each ray
  double aperture;   ///< area of the aperture, m2
  double solidAngle; ///< solid angle of the cone, sr
};

template <class Model>
AVIANLIDAR_ALWAYS_INLINE double throughputOf(const ConnectionLanes& h, std::size_t i)
{
  const std::uint32_t a = h.one[i];
  const std::uint32_t b = h.two[i];
  const Material first = h.material[a];
  const Material second = h.material[b];
  const double cosBack = h.cosine[b];
  const bool gathers = h.aperture > 0.0;
  const auto roughTerm = [](double in, double out, double difference)
  { return roughTermOf(in, out, 2.0 * difference * difference - 1.0); };
  const ReflectionGeometry out{ h.cosine[a], h.cosOut[i], 1.0, 0.0, 0.0, h.differenceOne[i],
    roughTerm(h.cosine[a], h.cosOut[i], h.differenceOne[i]) };
  const double diffuse = h.weight[i] * Model::of(first, out).diffuse;
  const double form =
    formFactor(h.cosOut[i], h.cosIn[i], h.length[i], h.range[b], cosBack, h.solidAngle);
  const double received = first.kd * h.weight[i] * lanes::smaller(form, MostFormFactor) *
    Model::unlikeLambert(first, out);
  const ReflectionGeometry back{ gathers ? cosBack : h.cosIn[i], cosBack, h.cosLobe[i],
    h.sin2Lobe[i], h.sin2Half[i], h.differenceTwo[i],
    roughTerm(h.cosIn[i], cosBack, h.differenceTwo[i]) };
  const Reflectance returned =
    throughAperture(Model::of(second, back), second, h.aperture, h.range[b]);
  return h.share * (gathers ? received * returned.diffuse : diffuse * returned.total()) *
    scaleOf<Model>(first, second, h.cosine[a], h.direct[a], h.aperture);
}

template <class Model>
AVIANLIDAR_ALWAYS_INLINE void throughputsOf(
  const ConnectionLanes& lanes, double* throughputs, std::size_t count)
{
  const ConnectionLanes h = lanes;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    throughputs[i] = throughputOf<Model>(h, i);
  }
}

AVIANLIDAR_MULTIVERSION void throughputsOfAll(
  ReflectanceModel model, const ConnectionLanes& lanes, double* throughputs, std::size_t count)
{
  withModel(model,
    [=, &lanes](auto m) AVIANLIDAR_INLINE_LAMBDA
    { throughputsOf<decltype(m)>(lanes, throughputs, count); });
}
}

double secondaryScale(const ScanSetup& setup, const Material& first, const Material& second,
  double cosIncidence, double direct)
{
  return withModel(setup.settings.reflectanceModel,
    [&](auto m)
    {
      return scaleOf<decltype(m)>(
        first, second, cosIncidence, direct, setup.sensor.receiverAperture);
    });
}

void connectionThroughputs(const ScanSetup& setup, const SecondaryBeam& beam,
  const MaterialLanes& materials, std::vector<double>& throughputs)
{
  const SecondaryConnections& connections = beam.trace.connections;
  throughputs.resize(connections.size());
  throughputsOfAll(setup.settings.reflectanceModel,
    { connections.one.data(), connections.two.data(), connections.weight.data(),
      connections.length.data(), connections.cosOut.data(), connections.differenceOne.data(),
      connections.cosIn.data(), connections.cosLobe.data(), connections.sin2Lobe.data(),
      connections.sin2Half.data(), connections.differenceTwo.data(), beam.samples.cosine.data(),
      beam.samples.range.data(), beam.direct.reflected.data(), materials.view(),
      1.0 / beam.samples.rays, setup.sensor.receiverAperture, setup.sensor.solidAngle() },
    throughputs.data(), connections.size());
  for (std::size_t i = 0; setup.sensor.losesNearRange() && i < connections.size(); ++i)
  {
    throughputs[i] *= setup.sensor.nearRangeShare(beam.samples.range[connections.two[i]]);
  }
}
}
