// SPDX-License-Identifier: BSD-3-Clause
#include "MovedBeams.h"

#include "CollisionTreeBuilder.h"
#include "ParallelLoop.h"
#include "PhotonReceiver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Beams for which movers are found first: some columns of the scan.
constexpr std::size_t BeamsTogether = 512;

/// Rounding of distances and angles.
constexpr double Slack = 1e-6;

/// Built for one beam, a tree must be made fast. For a beam that is integrated it is one leaf, as
/// no rays descend it.
TreeOptions optionsOfSmallScene(std::size_t triangles, const EchoSettings& settings)
{
  const std::size_t few = mostTrianglesIntegrated(settings);
  return { SplitRule::Median, BoundingVolumeType::AABB,
    triangles <= few ? static_cast<int>(few) + 1 : 4 };
}

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

/// A cone about the beams of a block, and the time while they are fired.
struct BlockCone
{
  Vec3 apex{ 0.0 };
  double apart = 0.0; ///< m, farthest origin from `apex`
  Vec3 axis{ 0.0 };
  double angle = Pi;                                      ///< rad, between the axis and any ray
  double begin = std::numeric_limits<double>::infinity(); ///< s
  double end = -std::numeric_limits<double>::infinity();

  BlockCone(const ScanBeams& beams, std::size_t first, std::size_t last, double halfBeamwidth)
    : apex(beams.origins[first])
  {
    for (std::size_t b = first; b < last; ++b)
    {
      this->apart = std::max(this->apart, safeLength(beams.origins[b] - this->apex));
      this->axis += unitVector(beams.directions[b]);
      this->begin = std::min(this->begin, beams.times[b]);
      this->end = std::max(this->end, beams.times[b]);
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

MovedBeams::MovedBeams(const ScanSetup& setup, const ScanBeams& beams, BeamSampler& sampler,
  std::function<bool()> wanted, bool sights)
  : Setup(setup)
  , Beams(beams)
  , Width(BeamShape(setup.sensor).width())
  , Sampler(sampler)
  , Wanted(std::move(wanted))
  , Sights(sights)
  , Scene(setup)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate,
      setup.sensor.minimumRange)
  , Trace(1)
{
  this->One.ids.resize(1);
  this->One.origins.resize(1);
  this->One.directions.resize(1);
  std::size_t number = setup.tree->mesh->size();
  for (const Mover& mover : *setup.movers)
  {
    this->All.push_back(static_cast<std::uint32_t>(this->All.size()));
    this->Numbers.push_back(number);
    number += mover.mesh.size();
  }
}

/// Find movers that beams [begin, end) may touch.
void MovedBeams::findAmong(const std::vector<std::uint32_t>& movers, std::size_t begin,
  std::size_t end, std::vector<std::uint32_t>& found) const
{
  found.clear();
  if (movers.empty())
  {
    return;
  }
  const BlockCone cone(this->Beams, begin, end, this->Width.half);
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
    this->findAmong(this->All, this->ManyBegin, this->ManyEnd, this->OfMany);
  }
  this->findAmong(this->OfMany, begin, end, this->OfBlock);
  this->Touching.resize(std::max(this->Touching.size(), end - begin));
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    std::vector<Touch>& touching = this->Touching[beam - begin];
    touching.clear();
    if (this->OfBlock.empty())
    {
      continue;
    }
    const BeamFrame frame =
      makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
    for (const std::uint32_t m : this->OfBlock)
    {
      const Mover& mover = (*this->Setup.movers)[m];
      Touch touch{ m, {}, 0 };
      if (poseAt(mover, this->Beams.times[beam], touch.pose) &&
        meets(frame, sphereAt(mover, touch.pose)))
      {
        touching.push_back(touch);
      }
    }
  }
}

/// Begin triangle `number` of the scene of all. Triangles whose numbers are not consecutive there
/// must not be so here, as two that are may be one surface: one that nothing hits stands between.
void MovedBeams::addTriangle(std::size_t number)
{
  TriangleMesh& mesh = *this->Mesh;
  if (!mesh.triangles.empty() && number != this->Last + 1)
  {
    const std::uint32_t corner = mesh.triangles.back()[0];
    mesh.triangles.push_back({ corner, corner, corner });
    this->Materials.push_back(this->Materials.back());
    this->ObjectIds.push_back(this->ObjectIds.back());
    this->MaterialIds.push_back(this->MaterialIds.back());
  }
  this->Last = number;
}

void MovedBeams::addStatic(const BeamFrame& frame)
{
  const CollisionTree& tree = *this->Setup.tree;
  this->Candidates.begin(tree, &frame, 1, false);
  this->Static.clear();
  if (this->Candidates.next())
  {
    this->Static = this->Candidates.triangles();
  }
  std::sort(this->Static.begin(), this->Static.end());
  TriangleMesh& mesh = *this->Mesh;
  for (const std::uint32_t t : this->Static)
  {
    this->addTriangle(t);
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (int c = 0; c < 3; ++c)
    {
      mesh.points.push_back(tree.mesh->corner(t, c));
    }
    mesh.triangles.push_back({ first, first + 1, first + 2 });
    this->Materials.push_back(this->Setup.materials[t]);
    this->ObjectIds.push_back(this->Setup.objectIds[t]);
    this->MaterialIds.push_back(this->Setup.materialIds[t]);
  }
}

/// Make the scene of a beam.
void MovedBeams::makeScene(const BeamFrame& frame, std::vector<Touch>& touching)
{
  this->Mesh = std::make_shared<TriangleMesh>();
  this->Materials.clear();
  this->ObjectIds.clear();
  this->MaterialIds.clear();
  this->addStatic(frame);
  const auto append = [](const auto& more, auto& all)
  { all.insert(all.end(), more.begin(), more.end()); };
  for (Touch& touch : touching)
  {
    const Mover& mover = (*this->Setup.movers)[touch.mover];
    this->addTriangle(this->Numbers[touch.mover]);
    this->Last = this->Numbers[touch.mover] + mover.mesh.size() - 1;
    touch.firstTriangle = this->Mesh->size();
    place(mover, touch.pose, *this->Mesh);
    append(mover.materials, this->Materials);
    append(mover.objectIds, this->ObjectIds);
    append(mover.materialIds, this->MaterialIds);
  }
  this->Scene.materials = this->Materials;
  this->Scene.objectIds = this->ObjectIds;
  this->Scene.materialIds = this->MaterialIds;
  this->Scene.tree = buildCollisionTree(
    this->Mesh, optionsOfSmallScene(this->Mesh->size(), this->Setup.settings), {}, 1);
}

/// Add the energies of the samples of the beam lit last that lie on triangles [begin, end).
void MovedBeams::addLightOf(std::size_t begin, std::size_t end, const BeamLighting& lighting)
{
  const std::vector<double>& energies = lighting.energies();
  if (!lighting.samples() || energies.empty())
  {
    return;
  }
  const BeamSamples& samples = *lighting.samples();
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t first, std::uint32_t last)
    {
      if (triangle >= begin && triangle < end)
      {
        this->Units.add(&samples.range[first], &energies[first], last - first);
      }
    });
}

/// What the beam lit last receives of a mover.
MoverSight MovedBeams::sightOf(
  const Touch& touch, const BeamFrame& frame, const BeamLighting& lighting)
{
  const Mover& mover = (*this->Setup.movers)[touch.mover];
  const std::size_t end = touch.firstTriangle + mover.mesh.size();
  const Vec3 to = touch.pose.position - frame.origin;
  MoverSight sight{ touch.mover, 0, 0.0, 0.0,
    std::atan2(safeLength(glm::cross(frame.axis, to)), glm::dot(frame.axis, to)), false };
  sight.held = this->Width.isRound ? sight.offAxis <= this->Width.half : frame.contains(to);
  this->Units.clear();
  this->addLightOf(touch.firstTriangle, end, lighting);
  this->Units.accumulate();
  const Sensor sensor = lookingAt(this->Setup.sensor, lighting.radiance());
  const PhotonReceiver receiver(sensor);
  double missed = 1.0;
  for (const RangeUnit& unit : this->Units.units())
  {
    sight.energy = std::max(sight.energy, unit.energy);
    missed *= 1.0 -
      perceptionProbability(sensor, receiver, unit.energy, this->Simulator->followedIn(unit.index));
  }
  sight.probability = 1.0 - missed;
  return sight;
}

void MovedBeams::simulate(
  std::size_t beam, std::vector<Echo>& echoes, BeamReport& report, std::vector<MoverSight>& sights)
{
  const BeamFrame frame =
    makeBeamFrame(this->Beams.origins[beam], this->Beams.directions[beam], this->Width);
  std::vector<Touch>& touching = this->Touching[beam - this->First];
  this->makeScene(frame, touching);
  this->One.ids[0] = this->Beams.ids[beam];
  this->One.origins[0] = this->Beams.origins[beam];
  this->One.directions[0] = this->Beams.directions[beam];
  this->One.times.assign(1, this->Beams.timeOf(beam));
  this->Trace[0] = BeamTrace{};
  if (!this->Simulator)
  {
    this->Simulator =
      std::make_unique<BeamSimulator>(this->Scene, this->One, false, this->Sampler, this->Wanted);
    if (this->Sights)
    {
      this->Simulator->lightAll(); // the mover report says what is not perceived, too
    }
  }
  this->Simulator->followSurfaces();
  this->Simulator->trace(0, 1, this->Trace);
  this->Simulator->light(0, this->Trace[0], echoes, report);
  for (std::size_t k = 0; this->Sights && k < touching.size(); ++k)
  {
    sights.push_back(this->sightOf(touching[k], frame, this->Simulator->lighting()));
    sights.back().beam = beam;
  }
}
}
