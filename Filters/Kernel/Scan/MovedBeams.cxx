// SPDX-License-Identifier: BSD-3-Clause
#include "MovedBeams.h"

#include "PhotonReceiver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace avianlidar
{
namespace
{
/// Number of beams, some columns of the scan, for which movers are found together at first.
constexpr std::size_t BeamsTogether = 512;

/// Margin for the rounding of distances (relative) and angles (rad).
constexpr double Slack = 1e-6;

/// False if no ray of the beam meets the sphere.
bool meets(const BeamFrame& beam, const MoverSphere& sphere)
{
  const Vec3 v = sphere.center - beam.origin;
  const double distance = safeLength(v);
  const double along = glm::dot(v, beam.axis);
  const double across = safeLength(v - along * beam.axis);
  if (distance <= sphere.radius * (1.0 + Slack) ||
    along * beam.cosHalf + across * beam.sinHalf <= 0.0) // the apex is the cone's nearest point
  {
    return distance <= sphere.radius * (1.0 + Slack);
  }
  return across * beam.cosHalf - along * beam.sinHalf <=
    sphere.radius + Slack * (sphere.radius + distance * beam.sinHalf);
}

/// A cone about consecutive beams, and the time in which they are fired.
struct ConeOfBeams
{
  Vec3 apex{ 0.0 };
  double apart = 0.0; ///< distance of the farthest origin from `apex`, m
  Vec3 axis{ 0.0 };
  double angle = Pi; ///< largest angle between axis and a ray, rad
  double begin = std::numeric_limits<double>::infinity(); ///< time of the first firing, s
  double end = -std::numeric_limits<double>::infinity();

  ConeOfBeams(const ScanBeams& beams, std::size_t first, std::size_t last, double halfBeamwidth)
    : apex(beams.origins[first])
  {
    for (std::size_t b = first; b < last; ++b)
    {
      this->apart = std::max(this->apart, safeLength(beams.origins[b] - this->apex));
      this->axis += unitVector(beams.directions[b]);
      this->begin = std::min(this->begin, beams.timeOf(b));
      this->end = std::max(this->end, beams.timeOf(b));
    }
    if (this->axis == Vec3(0.0))
    {
      return;
    }
    this->axis = unitVector(this->axis);
    double least = 1.0;
    for (std::size_t b = first; b < last; ++b)
    {
      least = std::min(least, glm::dot(this->axis, unitVector(beams.directions[b])));
    }
    this->angle = std::acos(std::clamp(least, -1.0, 1.0)) + halfBeamwidth + Slack;
  }

  bool meets(const MoverSphere& sphere) const
  {
    const Vec3 v = sphere.center - this->apex;
    const double distance = safeLength(v);
    const double radius = (sphere.radius + this->apart) * (1.0 + Slack);
    if (distance <= radius)
    {
      return true;
    }
    const double cosine = std::clamp(glm::dot(v, this->axis) / distance, -1.0, 1.0);
    return std::acos(cosine) <= this->angle + std::asin(radius / distance) + Slack;
  }
};
}

MovedBeams::MovedBeams(const ScanSetup& setup, const ScanAir& air, const ScanBeams& beams,
  BeamSampler& sampler, std::function<bool()> wanted, bool sights)
  : Setup(setup)
  , Beams(beams)
  , Width(BeamShape(setup.sensor).width())
  , Sights(sights)
  , All(setup.movers->size())
  , Simulator(setup, air, this->CurrentBeam, { false, sights }, sampler, std::move(wanted))
  , AirAlong(air)
  , LightOfAir(air)
  , Units(setup.sensor)
{
  this->CurrentBeam.ids.resize(1);
  this->CurrentBeam.origins.resize(1);
  this->CurrentBeam.directions.resize(1);
  this->CurrentBeam.times.resize(1);
  std::iota(this->All.begin(), this->All.end(), 0u);
}

void MovedBeams::findAmong(const std::vector<std::uint32_t>& movers, std::size_t begin,
  std::size_t end, std::vector<std::uint32_t>& found) const
{
  found.clear();
  if (movers.empty())
  {
    return;
  }
  const ConeOfBeams cone(this->Beams, begin, end, this->Width.half);
  MoverSphere sphere;
  for (const std::uint32_t m : movers)
  {
    if (sphereBetween((*this->Setup.movers)[m], cone.begin, cone.end, sphere) && cone.meets(sphere))
    {
      found.push_back(m);
    }
  }
}

void MovedBeams::find(std::size_t begin, std::size_t end)
{
  this->First = begin;
  if (begin < this->ManyBegin || end > this->ManyEnd)
  {
    this->ManyBegin = begin;
    this->ManyEnd = std::min(this->Beams.size(), std::max(end, begin + BeamsTogether));
    this->findAmong(this->All, this->ManyBegin, this->ManyEnd, this->NearMany);
  }
  this->findAmong(this->NearMany, begin, end, this->NearBlock);
  this->Touching.resize(std::max(this->Touching.size(), end - begin));
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    std::vector<Touch>& touching = this->Touching[beam - begin];
    touching.clear();
    if (this->NearBlock.empty())
    {
      continue;
    }
    const BeamFrame frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
    for (const std::uint32_t m : this->NearBlock)
    {
      const Mover& mover = (*this->Setup.movers)[m];
      Touch touch{ m, {} };
      if (poseAt(mover, this->Beams.timeOf(beam), touch.pose) &&
        meets(frame, sphereAt(mover, touch.pose)))
      {
        touching.push_back(touch);
      }
    }
  }
}

/// Add the energies of the samples on triangles [begin, end).
void MovedBeams::addLightOf(std::uint32_t begin, std::uint32_t end, const BeamLight& light)
{
  const std::vector<double>& energies = light.meanEnergies();
  if (!light.samples() || energies.empty())
  {
    return;
  }
  const BeamSamples& samples = *light.samples();
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t first, std::uint32_t last)
    {
      if (triangle >= begin && triangle < end)
      {
        this->Units.add(&samples.range[first], &energies[first], last - first);
      }
    });
}

/// @param air light of the air along the beam
MoverLight MovedBeams::sightOf(
  const Touch& touch, const BeamFrame& frame, const BeamLight& light, AirLight& air)
{
  const Mover& mover = (*this->Setup.movers)[touch.mover];
  const std::uint32_t first = this->Setup.firstTriangles[touch.mover];
  const auto end = static_cast<std::uint32_t>(first + mover.mesh.size());
  const Vec3 to = touch.pose.position - frame.origin;
  MoverLight sight{ touch.mover, 0, 0.0, 0.0,
    std::atan2(safeLength(glm::cross(frame.axis, to)), glm::dot(frame.axis, to)), false };
  sight.held = this->Width.isRound ? sight.offAxis <= this->Width.half : frame.contains(to);
  this->Units.clear();
  this->addLightOf(first, end, light);
  this->Units.accumulate();
  const Sensor sensor = lookingAt(this->Setup.sensor, light.radiance);
  const PhotonReceiver receiver(sensor);
  double missed = 1.0;
  for (const RangeUnit& unit : this->Units.units())
  {
    sight.energy = std::max(sight.energy, unit.energy);
    missed *= 1.0 - perceptionProbability(sensor, receiver, unit.energy, air.followed(unit.index));
  }
  sight.probability = 1.0 - missed;
  return sight;
}

MovedBeams::Followed MovedBeams::simulate(std::size_t beam, BeamResults& results,
  BeamReport& report, std::vector<MoverLight>& sights, BeamLight&& memory)
{
  const std::vector<Touch>& touching = this->Touching[beam - this->First];
  SceneTriangles& scene = this->Simulator.scene();
  scene.clear();
  for (const Touch& touch : touching)
  {
    this->Mesh.points.clear();
    this->Mesh.triangles.clear();
    place((*this->Setup.movers)[touch.mover], touch.pose, this->Mesh);
    scene.place(this->Setup.firstTriangles[touch.mover], this->Mesh);
  }
  scene.finish();
  this->CurrentBeam.ids[0] = this->Beams.ids[beam];
  this->CurrentBeam.origins[0] = this->Beams.origins[beam];
  this->CurrentBeam.directions[0] = this->Beams.directions[beam];
  this->CurrentBeam.times[0] = this->Beams.timeOf(beam);
  const std::size_t stretches = results.waveforms.stretches.size();
  std::vector<KeptBeam> kept(1);
  this->Traced = this->Simulator.trace(0, 1, kept, {}, std::move(this->Traced));
  BeamLight light =
    this->Simulator.follow(0, this->Traced.of(0), kept[0], results, report, std::move(memory));
  for (std::size_t i = stretches; i < results.waveforms.stretches.size(); ++i)
  {
    results.waveforms.stretches[i].beam = beam;
  }
  if (this->Sights)
  {
    const BeamFrame frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
    const BeamAir air = this->AirAlong.along(frame, this->Beams.timeOf(beam));
    this->LightOfAir.begin(air, light.surfaces);
    for (const Touch& touch : touching)
    {
      sights.push_back(this->sightOf(touch, frame, light, this->LightOfAir));
      sights.back().beam = beam;
    }
    this->LightOfAir.end();
  }
  return { std::move(kept[0].view), std::move(light) };
}
}
