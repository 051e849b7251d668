// SPDX-License-Identifier: BSD-3-Clause
// ScanBlock's small targets: which a beam has, their rays, and hits of these and the others.
#include "ScanBlock.h"

#include <algorithm>

namespace avianlidar
{
/// The beam's small targets: they are looked for when they are needed.
const BeamTargets& ScanBlock::targetsOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (!slot.targets.found && this->Setup.objects && !slot.integrated)
  {
    this->Targets.find(this->frameOf(beam), slot.targets);
  }
  return slot.targets;
}

/// How many rays each of the beam's small targets needs, in the order of its sampling cones.
TargetRays ScanBlock::raysOfTargets(std::size_t beam, RandomPurpose purpose)
{
  const BeamTargets& targets = this->targetsOf(beam);
  if (purpose == RandomPurpose::Pilot)
  {
    return TargetRays(targets.guards.size(), PilotRays);
  }
  return targets.wanted.empty() ? TargetRays(targets.guards.size(), RaysOfTarget) : targets.wanted;
}

/// Targets' own rays, of the beams that tracePrimary() was for.
void ScanBlock::traceTargets(std::size_t begin, std::size_t end, RandomPurpose purpose)
{
  this->Frames.clear();
  this->Missing.clear();
  this->Traced.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    // Whether a plane fills the beam was found out with the other rays.
    Slot& slot = this->slotOf(beam);
    if (slot.raysMissing == 0 || slot.integrated)
    {
      continue;
    }
    // They are not even drawn where nothing can be met, nor looked for, unless a kept pilot says
    // how many rays each gets.
    if (slot.raysDrawn != slot.raysMissing || slot.purpose != purpose)
    {
      slot.targets.found = slot.targets.found || slot.targets.wanted.empty();
      continue;
    }
    if (const std::uint32_t rays = sumOf(this->raysOfTargets(beam, purpose)))
    {
      this->Frames.push_back(this->frameOf(beam));
      this->Missing.push_back(rays);
      this->Traced.push_back(beam);
    }
  }
  if (this->Traced.empty())
  {
    return;
  }
  const BlockHits& found = this->traceBeams([this, purpose](std::size_t k) -> const BeamRays&
    { return this->drawTargets(this->Traced[k], purpose).rays; },
    nullptr, true);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    const std::uint32_t* const triangles = found.triangles[k];
    if (!triangles)
    {
      continue;
    }
    this->Own.assign(triangles, triangles + this->Missing[k]);
    const std::size_t beam = this->Traced[k];
    Slot& slot = this->slotOf(beam);
    if (this->Targets.keepOwn(slot.targets, this->raysOfTargets(beam, purpose), this->Own.data()))
    {
      slot.triangles.resize(slot.raysMissing, NoTriangle);
      slot.triangles.insert(slot.triangles.end(), this->Own.begin(), this->Own.end());
    }
  }
}

/// The rays of the beam's small targets, and their shares.
const BeamTargets& ScanBlock::drawTargets(std::size_t beam, RandomPurpose purpose)
{
  this->targetsOf(beam);
  Slot& slot = this->slotOf(beam);
  if (slot.targets.shares.empty() || slot.targetsDrawn != purpose)
  {
    this->Targets.draw(this->Beams.ids[beam], this->frameOf(beam), purpose,
      this->raysOfTargets(beam, purpose), slot.targets);
    slot.targetsDrawn = purpose;
  }
  return slot.targets;
}

/// `rays` ordinary ones, and those of small targets.
const BeamRays& ScanBlock::allRaysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose)
{
  this->AllRays = this->raysOf(beam, rays, purpose);
  const BeamRays& more = this->drawTargets(beam, purpose).rays;
  this->AllRays.x.insert(this->AllRays.x.end(), more.x.begin(), more.x.end());
  this->AllRays.y.insert(this->AllRays.y.end(), more.y.begin(), more.y.end());
  return this->AllRays;
}

/// Of the triangles just found.
void ScanBlock::makeHits(
  std::size_t beam, std::uint32_t rays, RandomPurpose purpose, BeamSamples& samples)
{
  const Slot& slot = this->slotOf(beam);
  const TriangleMesh& mesh = *this->Setup.tree->mesh;
  if (this->targetsOf(beam).guards.empty())
  {
    this->Finder.find(
      mesh, slot.frame, this->raysOf(beam, rays, purpose), slot.triangles, samples, this->Geometry);
    return;
  }
  this->Finder.find(mesh, slot.frame, this->allRaysOf(beam, rays, purpose), slot.triangles, samples,
    this->Geometry);
  this->Targets.weigh(slot.targets, rays, samples);
}
}
