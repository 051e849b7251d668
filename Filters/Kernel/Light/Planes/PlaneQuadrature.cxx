// SPDX-License-Identifier: BSD-3-Clause
#include "PlaneQuadrature.h"

#include "LaneMath.h"
#include "Multiversion.h"
#include "PatchPreTest.h"
#include "Propagation.h"
#include "Reflectance.h"
#include "Throughput.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace avianlidar
{
namespace
{
/// Panels whose two rules differ by more of what they hold are halved, unless that is as little of
/// the beam.
constexpr double FineOfPanel = 3e-6;
constexpr double FineOfBeam = 1e-10;
constexpr int MostHalvings = 24;
}

PlaneQuadrature::PlaneQuadrature(const ScanSetup& setup)
  : Setup(setup)
  , Ranges(setup)
{
}

double PlaneQuadrature::footprintOf(const BeamFrame& frame, const PatchPlane& plane)
{
  const PlaneDisc disc = planeDisc(frame, plane);
  return disc.cosMost > 0.0 ? disc.farthest() - disc.nearest()
                            : std::numeric_limits<double>::infinity();
}

/// True if two triangles are of one object and one material.
bool PlaneQuadrature::isAlike(std::uint32_t one, std::uint32_t two) const
{
  return one == two ||
    (this->Setup.materials[one] == this->Setup.materials[two] &&
      this->Setup.objectIds[one] == this->Setup.objectIds[two] &&
      this->Setup.materialIds[one] == this->Setup.materialIds[two]);
}

void PlaneQuadrature::findSurfaces(const VisiblePatch& patch)
{
  this->Surfaces.clear();
  this->SurfaceOf.clear();
  for (std::size_t k = 0; k < patch.triangles.size(); ++k)
  {
    const std::uint32_t t = patch.triangles[k];
    const auto same = std::find_if(this->Surfaces.begin(), this->Surfaces.end(),
      [&](const PatchSurface& surface)
      { return surface.plane == patch.planeOf[k] && this->isAlike(surface.triangle, t); });
    this->SurfaceOf.push_back(static_cast<std::uint8_t>(same - this->Surfaces.begin()));
    if (same == this->Surfaces.end())
    {
      this->Surfaces.push_back({ t, patch.planeOf[k], this->Setup.materials[t] });
    }
  }
}

/// Begin a plane of the patch. @return false if borders of surfaces do not fit together
bool PlaneQuadrature::beginPlane(
  const BeamFrame& frame, const VisiblePatch& patch, std::size_t plane)
{
  std::uint8_t numbers[MostPatchTriangles];
  this->PlaneSurfaces.clear();
  for (std::size_t k = 0; k < this->Surfaces.size(); ++k)
  {
    const bool here = this->Surfaces[k].plane == plane;
    numbers[k] = here ? static_cast<std::uint8_t>(this->PlaneSurfaces.size()) : Elsewhere;
    if (here)
    {
      this->PlaneSurfaces.push_back(this->Surfaces[k]);
    }
  }
  this->PlaneSurfaceOf.clear();
  for (const std::uint8_t surface : this->SurfaceOf)
  {
    this->PlaneSurfaceOf.push_back(numbers[surface]);
  }
  this->Disc = planeDisc(frame, patch.planes[plane]);
  this->Sides.set(*this->Setup.tree->mesh, frame, patch, this->PlaneSurfaceOf, this->Disc);
  return this->Arcs.set(this->Disc, this->Sides);
}

/// True if it meets a surface of the plane.
bool PlaneQuadrature::isSeen(const PlaneInterval& interval) const
{
  for (std::uint32_t k = interval.arcs[0]; k < interval.arcs[1]; ++k)
  {
    if (this->Arcs.arc(k).surface != Elsewhere)
    {
      return true;
    }
  }
  return false;
}

/// Most nodes for which an integral takes no longer than the rays.
double PlaneQuadrature::mostNodes(bool borders) const
{
  const double rays = this->Setup.settings.raysPerBeam - RaysLikeAnIntegral;
  return (rays - (borders ? RaysLikeBorders : 0.0)) / RaysLikeANode;
}

/// True if the triangles, but for a few, are alike.
bool PlaneQuadrature::isOneSurface(const std::uint32_t* triangles, std::size_t count) const
{
  const std::size_t mostOff = mostRaysOff(count);
  for (const std::uint32_t first : { triangles[0], triangles[count - 1] })
  {
    std::size_t off = first == NoTriangle ? count : 0;
    for (std::size_t i = 0; i < count && off <= mostOff; ++i)
    {
      off += triangles[i] == NoTriangle || !this->isAlike(first, triangles[i]) ? 1 : 0;
    }
    if (off <= mostOff)
    {
      return true;
    }
  }
  return false;
}

std::size_t PlaneQuadrature::mostPlanes() const
{
  const bool borders = 2.0 * Kronrod5.points <= this->mostNodes(true);
  return borders ? MostPatchPlanes : 1;
}

bool PlaneQuadrature::mayFit(
  double footprint, const std::uint32_t* triangles, std::size_t count) const
{
  const double length = std::fabs(footprint);
  if (!this->Ranges.mayFit(length))
  {
    return false;
  }
  const bool borders = footprint < 0.0 || !this->isOneSurface(triangles, count);
  const double fewest = std::max(borders ? 2.0 : 1.0, this->Ranges.fewestPanels(length));
  return fewest * Kronrod5.points <= this->mostNodes(borders);
}

/// Nodes of the plane's panels before any is refined; above `most`, a lower bound of them.
double PlaneQuadrature::countNodes(double most)
{
  double count = 0.0;
  this->Ranges.set(this->Disc, this->PlaneSurfaces);
  for (const PlaneInterval& interval : this->Arcs.intervals())
  {
    if (!this->isSeen(interval))
    {
      continue;
    }
    this->Panels.clear();
    this->Ranges.add(this->Arcs, interval, this->Panels);
    int points = 0;
    for (const PlanePanel& panel : this->Panels)
    {
      points += panel.rule->points;
    }
    count += points *
      static_cast<double>(
        std::min<std::size_t>(interval.arcs[1] - interval.arcs[0], this->PlaneSurfaces.size()));
    if (!(count <= most))
    {
      break;
    }
  }
  return count;
}

/// True if all fits together, and the integral takes no longer than the rays.
bool PlaneQuadrature::takesLess(const BeamFrame& frame, const VisiblePatch& patch)
{
  const double most = this->mostNodes(this->Surfaces.size() > 1);
  double count = 0.0;
  for (std::size_t plane = 0; plane < patch.planes.size() && count <= most; ++plane)
  {
    const PlaneDisc disc = planeDisc(frame, patch.planes[plane]);
    // mayFit(), which takes the whole footprint of any of the planes, must not contradict this.
    const double fewest = this->Ranges.fewestPanels(disc.farthest() - disc.nearest());
    if (!(fewest * Kronrod5.points <= most) || !this->beginPlane(frame, patch, plane))
    {
      return false;
    }
    count += this->countNodes(most - count);
  }
  return count <= most;
}

/// True if the receiver's aperture gathers nearly all from the nearest point.
bool PlaneQuadrature::reachesAperture(const PatchSurface& surface) const
{
  const PlaneDisc& disc = this->Disc;
  const Reflectance f = reflectance(
    this->Setup.settings.reflectanceModel, surface.material, monostaticGeometry(disc.cosLeast));
  // The cap of throughAperture() must be out of reach.
  const double aperture = this->Setup.sensor.receiverAperture;
  return throughAperture(f, surface.material, aperture, disc.nearest()).total() >= 1.0 - 1e-9;
}

bool PlaneQuadrature::fits(const BeamFrame& frame, const VisiblePatch& patch)
{
  const bool several = patch.planes.size() > 1;
  if ((several && this->mostPlanes() < patch.planes.size()) ||
    (patch.facing && this->Setup.settings.numberOfReflections > 1) ||
    !std::all_of(patch.planes.begin(), patch.planes.end(),
      [&](const PatchPlane& plane) { return this->Ranges.fits(planeDisc(frame, plane)); }))
  {
    return false;
  }
  this->findSurfaces(patch);
  if (!this->takesLess(frame, patch))
  {
    return false;
  }
  return this->Setup.sensor.receiverAperture <= 0.0 ||
    std::none_of(this->Surfaces.begin(), this->Surfaces.end(),
      [&](const PatchSurface& surface)
      {
        this->Disc = planeDisc(frame, patch.planes[surface.plane]);
        return this->reachesAperture(surface);
      });
}

PlaneQuadrature::Extent PlaneQuadrature::extentOf(
  const BeamFrame& frame, const VisiblePatch& patch) const
{
  // All models fall with the angle of incidence, and so do aperture and air with the range.
  Extent extent{ std::numeric_limits<double>::infinity(), 0.0, 0.0 };
  constexpr double surely = 1.0 + 1e-6; // the shares of the nodes are rounded
  for (std::size_t k = 0; k < patch.triangles.size(); ++k)
  {
    const PlaneDisc disc = planeDisc(frame, patch.planes[patch.planeOf[k]]);
    const Material& material = this->Setup.materials[patch.triangles[k]];
    const Reflectance f = reflectance(
      this->Setup.settings.reflectanceModel, material, monostaticGeometry(disc.cosLeast));
    const double gathered =
      throughAperture(f, material, this->Setup.sensor.receiverAperture, disc.nearest()).total();
    extent.nearest = std::min(extent.nearest, disc.nearest() * (1.0 - 1e-9));
    extent.farthest = std::max(extent.farthest, disc.farthest() * surely);
    extent.mostReturned = std::max(extent.mostReturned, gathered * surely);
  }
  extent.mostReturned *=
    transmission(this->Setup.settings.attenuationCoefficient, 2.0 * extent.nearest);
  return extent;
}

//--- panels ---------------------------------------------------------------------------------------

void PlaneQuadrature::addInterval(const PlaneInterval& interval)
{
  this->Panels.clear();
  this->Ranges.add(this->Arcs, interval, this->Panels);
  while (!this->Panels.empty())
  {
    this->placePanels(interval);
    this->Coarse.clear();
    std::size_t first = 0;
    for (const PlanePanel& panel : this->Panels)
    {
      if (this->isFine(interval, panel, first))
      {
        this->keep(interval, panel, first);
      }
      else
      {
        this->refine(panel);
      }
      first += static_cast<std::size_t>(panel.rule->points);
    }
    std::swap(this->Panels, this->Coarse);
  }
}

void PlaneQuadrature::placePanels(const PlaneInterval& interval)
{
  this->Placed.clear();
  for (const PlanePanel& panel : this->Panels)
  {
    const double half = 0.5 * (panel.upper - panel.lower);
    for (int i = 0; i < panel.rule->points; ++i)
    {
      this->Placed.variable.push_back(panel.lower + half * (1.0 + panel.rule->place[i]));
      this->Placed.weight.push_back(half * panel.rule->weight[i]);
    }
  }
  this->Arcs.place(interval, this->Setup.sensor.beamProfile == BeamProfile::Gaussian, this->Placed);
}

/// Approximate f_sur at the nodes of a panel, for the test of its rules.
void PlaneQuadrature::findThroughputs(const Material& m, std::size_t first, int count)
{
  const double width2 = lobeWidth2(m);
  const double* const sines = this->Placed.sine.data() + first;
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const double least = std::min(sines[0], sines[count - 1]);
  if (width2 == 0.0 ||
    (model != ReflectanceModel::Microfacet && least * least > NoLobe * width2 && m.isMatt()))
  {
    std::fill_n(this->NodeThroughputs, count,
      aboutReturned(model, m, std::numeric_limits<double>::infinity()));
    return;
  }
  const double inverse = 1.0 / width2;
  for (int i = 0; i < count; ++i)
  {
    const double fall = sines[i] * sines[i] * inverse;
    this->NodeThroughputs[i] = aboutReturned(model, m, fall);
  }
}

/// True if the two rules of a panel agree.
bool PlaneQuadrature::isFine(
  const PlaneInterval& interval, const PlanePanel& panel, std::size_t first)
{
  if (panel.halvings >= MostHalvings)
  {
    return true;
  }
  const GaussKronrodRule& rule = *panel.rule;
  double held = 0.0;
  double apart = 0.0;
  double most = 0.0;
  for (std::uint32_t k = interval.arcs[0]; k < interval.arcs[1]; ++k)
  {
    const PatchArc& arc = this->Arcs.arc(k);
    if (arc.surface == Elsewhere)
    {
      continue;
    }
    const double* const shares =
      this->Placed.shares.data() + (k - interval.arcs[0]) * this->Placed.size() + first;
    this->findThroughputs(this->PlaneSurfaces[arc.surface].material, first, rule.points);
    double sum = 0.0;
    double difference = 0.0;
    double ofRamp = 0.0; // as a pulse enters a range unit
    for (int i = 0; i < rule.points; ++i)
    {
      const double energy = this->NodeThroughputs[i] * shares[i];
      const double each = energy * rule.errorWeight[i];
      most = std::max(most, this->NodeThroughputs[i]);
      sum += energy;
      difference += each;
      ofRamp += each * rule.place[i];
    }
    held += sum;
    apart += std::fabs(difference) + std::fabs(ofRamp);
  }
  return apart <= FineOfPanel * held + FineOfBeam * most;
}

/// Place a panel again: with the best rule first, then in halves.
void PlaneQuadrature::refine(const PlanePanel& panel)
{
  const GaussKronrodRule* const best = &Kronrod15;
  if (panel.rule != best)
  {
    this->Coarse.push_back({ panel.lower, panel.upper, best, panel.halvings });
    return;
  }
  const double middle = 0.5 * (panel.lower + panel.upper);
  this->Coarse.push_back({ panel.lower, middle, best, panel.halvings + 1 });
  this->Coarse.push_back({ middle, panel.upper, best, panel.halvings + 1 });
}

/// Keep the nodes of a panel, surface by surface.
void PlaneQuadrature::keep(
  const PlaneInterval& interval, const PlanePanel& panel, std::size_t first)
{
  BeamSamples& samples = this->Nodes.samples;
  const GaussKronrodRule& rule = *panel.rule;
  const auto points = static_cast<std::size_t>(rule.points);
  for (std::uint32_t k = interval.arcs[0]; k < interval.arcs[1]; ++k)
  {
    const std::uint8_t surface = this->Arcs.arc(k).surface;
    const auto sameSurface = [&](std::uint32_t other)
    { return this->Arcs.arc(other).surface == surface; };
    bool before = surface == Elsewhere;
    for (std::uint32_t j = interval.arcs[0]; j < k && !before; ++j)
    {
      before = sameSurface(j);
    }
    if (before)
    {
      continue;
    }
    const std::size_t begin = samples.range.size();
    for (std::size_t i = 0; i < points; ++i)
    {
      samples.range.push_back(this->Placed.range[first + i]);
      samples.cosine.push_back(this->Placed.cosine[first + i]);
      this->Nodes.errorWeight.push_back(rule.errorWeight[i]);
    }
    samples.weight.resize(begin + points, 0.0);
    for (std::uint32_t j = k; j < interval.arcs[1]; ++j)
    {
      for (std::size_t i = 0; i < points && sameSurface(j); ++i)
      {
        samples.weight[begin + i] +=
          this->Placed.shares[(j - interval.arcs[0]) * this->Placed.size() + first + i];
      }
    }
    // Turns that differ by rounding alone.
    for (std::size_t i = begin; i < begin + points; ++i)
    {
      samples.weight[i] = std::max(0.0, samples.weight[i]);
    }
    samples.surfaces.push_back(
      { this->PlaneSurfaces[surface].triangle, static_cast<std::uint32_t>(samples.range.size()) });
  }
}

const BeamNodes& PlaneQuadrature::place(const BeamFrame& frame, const VisiblePatch& patch)
{
  BeamSamples& samples = this->Nodes.samples;
  samples.range.clear();
  samples.cosine.clear();
  samples.weight.clear();
  samples.surfaces.clear();
  samples.nearest = std::numeric_limits<double>::infinity();
  samples.farthest = 0.0;
  this->Nodes.errorWeight.clear();
  // The energy in the rim may be missing.
  const double width = rimOf(frame);
  this->Nodes.misplaced = width * std::sqrt(width) * static_cast<double>(MostPatchTriangles);
  this->Nodes.shift = 0.0;
  this->findSurfaces(patch);
  for (std::size_t plane = 0; plane < patch.planes.size(); ++plane)
  {
    this->beginPlane(frame, patch, plane);
    this->Ranges.set(this->Disc, this->PlaneSurfaces);
    for (const PlaneInterval& interval : this->Arcs.intervals())
    {
      if (this->isSeen(interval))
      {
        this->addInterval(interval);
      }
    }
    samples.nearest = std::min(samples.nearest, this->Disc.nearest() * (1.0 - 1e-9));
    samples.farthest = std::max(samples.farthest, this->Disc.farthest());
    this->Nodes.shift = std::max(this->Nodes.shift, this->shiftOf(patch, patch.planes[plane]));
    // Borders of surfaces are rounded.
    this->Nodes.misplaced += this->Arcs.uncertain() + 2.0 * this->Sides.rounding();
  }
  const std::size_t count = samples.range.size();
  samples.ray.resize(count);
  std::iota(samples.ray.begin(), samples.ray.end(), 0u);
  samples.rays = static_cast<std::uint32_t>(count);
  samples.pathStep = 0;
  samples.coplanar = true;
  return this->Nodes;
}

/// Corners and ranges are rounded, and the ranges of the patch's triangles may differ a little.
double PlaneQuadrature::shiftOf(const VisiblePatch& patch, const PatchPlane& plane) const
{
  const PlaneDisc& disc = this->Disc;
  const double corners = 8.0 * RoundOffDouble * plane.size / disc.cosMost;
  const double ranges = (16.0 * RoundOffDouble / disc.cosMost + patch.apart) * disc.farthest();
  const double shift = corners + ranges;
  return this->Ranges.isParted(disc.nearest() - shift, disc.farthest() + shift) ? shift : 0.0;
}

/// Energy, J, that a shift in range moves across the borders of units: at most the share of the
/// pulse that the shift covers, and at most the energy in a strip as wide.
double PlaneQuadrature::shiftedOf(
  const RangeShares& shares, const std::vector<double>& energies) const
{
  if (this->Nodes.shift == 0.0)
  {
    return 0.0;
  }
  const std::vector<double>& ranges = this->Nodes.samples.range;
  const std::vector<BeamSamples::Surface>& panels = this->Nodes.samples.surfaces;
  constexpr double surely = 4.0; // energy between nodes may exceed that at them
  const double shift = this->Nodes.shift;
  double all = 0.0;
  double near = 0.0;    // of nodes that the shift may bring past each other
  double densest = 0.0; // J/m, of the others
  std::size_t panel = 0;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t node = shares.contribution(s);
    if (!(shares.energies[s] > 0.0))
    {
      continue;
    }
    while (node >= panels[panel].end)
    {
      ++panel;
    }
    const std::size_t first = panel == 0 ? 0 : panels[panel - 1].end;
    const std::size_t before = node == first ? node : node - 1;
    const std::size_t after = node + 1 == panels[panel].end ? node : node + 1;
    const double apart = 0.5 * std::fabs(ranges[after] - ranges[before]);
    all += energies[node];
    if (apart > shift)
    {
      densest = std::max(densest, energies[node] / apart);
    }
    else
    {
      near += energies[node];
    }
  }
  const double pulse = 0.5 * SpeedOfLight * this->Setup.sensor.pulseWidth;
  return std::min(all * std::min(1.0, shift / pulse), surely * (shift * densest + near));
}

double PlaneQuadrature::boundOf(
  const RangeShares& shares, const std::vector<double>& energies, double most) const
{
  double bound = 0.0;
  double energy = 0.0;
  std::size_t panel = 0;
  double difference = 0.0;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t node = shares.contribution(s);
    while (node >= this->Nodes.samples.surfaces[panel].end)
    {
      bound += std::fabs(difference);
      difference = 0.0;
      ++panel;
    }
    difference += shares.energies[s] * this->Nodes.errorWeight[node];
    energy += shares.energies[s];
  }
  constexpr double ofShares = 1e-9;
  return bound + std::fabs(difference) + ofShares * energy + this->shiftedOf(shares, energies) +
    this->Nodes.misplaced * most;
}
}
