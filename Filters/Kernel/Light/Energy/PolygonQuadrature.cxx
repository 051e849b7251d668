// SPDX-License-Identifier: BSD-3-Clause
#include "PolygonQuadrature.h"

#include "Reflectance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Factor that covers the rounding of bounds.
constexpr double Surely = 1.0 + 1e-5;
}

PolygonQuadrature::PolygonQuadrature(const ScanSetup& setup)
  : Setup(setup)
  , Rule(setup)
{
}

void PolygonQuadrature::begin(const BeamFrame& frame, const VisiblePolygons& seen)
{
  this->Frame = frame;
  this->Seen = &seen;
  this->Polygons.clear();
  this->Whole = { std::numeric_limits<double>::infinity(), 0.0, 0.0, 0.0, 0.0 };
  double largest = 0.0;
  seen.forEach(
    [&](const PlaneSurface& surface, const PlaneRing& ring)
    {
      const Bounds bounds = this->boundsOf(surface, ring);
      this->Polygons.push_back(bounds);
      this->Whole.nearest = std::min(this->Whole.nearest, (1.0 - 1e-9) / bounds.extent.mostInverse);
      this->Whole.farthest = std::max(this->Whole.farthest,
        Surely * std::sqrt(1.0 + this->Rule.tangent2()) / bounds.extent.leastInverse);
      this->Whole.returnBound += bounds.returned * bounds.share;
      this->Whole.mostInUnit += bounds.inUnit;
      largest = std::max(largest, bounds.returned);
      for (const std::uint32_t triangle : { surface.triangle, surface.other })
      {
        this->Whole.mostAlbedo = std::max(this->Whole.mostAlbedo,
          triangle == NoTriangle ? 0.0 : this->Setup.material(triangle).albedo());
      }
    });
  // The rules are exact only below the cap of throughAperture().
  this->Gathers = this->Setup.sensor.receiverAperture > 0.0 && largest >= 1.0 - 1e-9;
  this->Whole.returnBound = Surely * this->Setup.sensor.pulseEnergy *
    std::min(this->Whole.returnBound, largest) *
    transmission(this->Setup.attenuation(), 2.0 * this->Whole.nearest);
  this->Whole.mostInUnit = std::min(this->Whole.returnBound, this->Whole.mostInUnit);
  this->drop();
}

/// Bound of a triangle's reflectance through the aperture. @param mostInverse largest 1/z, 1/m
double PolygonQuadrature::mostReturnedBy(
  std::uint32_t triangle, double height, double mostInverse) const
{
  const Material& material = this->Setup.material(triangle);
  const Reflectance f = mostStraightBack(
    this->Setup.settings.reflectanceModel, material, std::min(1.0, height * mostInverse));
  return throughAperture(f, material, this->Setup.sensor.receiverAperture, 1.0 / mostInverse)
    .total();
}

PolygonQuadrature::Bounds PolygonQuadrature::boundsOf(
  const PlaneSurface& surface, const PlaneRing& ring) const
{
  const Sensor& sensor = this->Setup.sensor;
  const PlaneLine& w = surface.inverse;
  const double slope = w.slope();
  Bounds bounds{ PolygonRule::extentOf(surface, ring), 0.0, 0.0, 0.0, false, false };
  double least = 1.0; // lower end of the extent across the gradient, times the slope
  double most = -1.0;
  for (int i = 0; i < ring.size; ++i)
  {
    const PlanePoint& p = ring.corners[i];
    least = std::min(least, w.x * p.y - w.y * p.x);
    most = std::max(most, w.x * p.y - w.y * p.x);
  }
  bounds.returned =
    this->mostReturnedBy(surface.triangle, surface.height, bounds.extent.mostInverse);
  if (surface.other != NoTriangle &&
    this->Setup.material(surface.other) != this->Setup.material(surface.triangle))
  {
    bounds.returned = std::max(bounds.returned,
      this->mostReturnedBy(surface.other, surface.height, bounds.extent.mostInverse));
  }
  const double dense = Surely * this->Rule.mostDensity() * this->Rule.shareOfArea();
  const double area = ring.area();
  bounds.share = std::min(1.0, dense * area);
  // The energy of a unit comes from a strip across the gradient, whose sides are curved.
  const double length =
    this->Rule.unitLength() * (1.0 + 2.0 * MostCurved) + this->Rule.pulseLength();
  const double chord =
    slope > 0.0 ? std::min(most / slope, 1.0) - std::max(least / slope, -1.0) : 2.0;
  const double strip =
    chord * length * bounds.extent.mostInverse * bounds.extent.mostInverse / slope;
  bounds.inUnit = sensor.pulseEnergy * bounds.returned *
    std::min(1.0, dense * (strip < area ? strip : area)) *
    transmission(this->Setup.attenuation(), 2.0 / bounds.extent.mostInverse);
  return bounds;
}

/// Mark the faintest polygons over many units as dropped, and the next polygons as faint, as long
/// as no unit loses too much.
void PolygonQuadrature::drop()
{
  this->Dropped = 0.0;
  // A surface that returns little laser light may be bright in the sun.
  if (!dropsFaintPaths(this->Setup.settings) || this->Setup.sensor.seesDaylight())
  {
    return;
  }
  this->Faint.clear();
  for (std::uint32_t k = 0; k < this->Polygons.size(); ++k)
  {
    const Bounds& bounds = this->Polygons[k];
    if (1.0 / bounds.extent.leastInverse - 1.0 / bounds.extent.mostInverse >
      FewUnits * this->Rule.unitLength())
    {
      this->Faint.emplace_back(bounds.inUnit, k);
    }
  }
  std::sort(this->Faint.begin(), this->Faint.end());
  const double most = 0.5 * lightEnergyTolerance(this->Setup);
  for (const auto& [energy, polygon] : this->Faint)
  {
    Bounds& bounds = this->Polygons[polygon];
    bounds.dropped = this->Dropped + energy <= most;
    const double lacking = bounds.dropped ? energy : MostFaintStretch * energy;
    bounds.faint = this->Dropped + lacking <= most;
    this->Dropped += bounds.faint ? lacking : 0.0;
  }
}

/// Call f(surface, triangle, ring, bounds) for each polygon that is not dropped, and for each half
/// of a quadrilateral separately if the halves differ in object or material.
template <class F>
void PolygonQuadrature::forEachPart(F f)
{
  std::size_t number = 0;
  this->Seen->forEach(
    [&](const PlaneSurface& surface, const PlaneRing& ring)
    {
      const Bounds& bounds = this->Polygons[number++];
      const std::uint32_t one = surface.triangle;
      const std::uint32_t two = surface.other;
      PlaneRing first;
      PlaneRing second;
      if (bounds.dropped)
      {
        return;
      }
      if (two == NoTriangle ||
        (this->Setup.material(one) == this->Setup.material(two) &&
          this->Setup.objectId(one) == this->Setup.objectId(two) &&
          this->Setup.materialId(one) == this->Setup.materialId(two)))
      {
        f(surface, one, ring, bounds);
      }
      else if (ring.mayBeCut() &&
        cutRing(ring, surface.diagonal, first, second) == SideOfLine::Both)
      {
        f(surface, one, first, bounds);
        f(surface, two, second, bounds);
      }
      else
      {
        PlanePoint centre{ 0.0, 0.0 };
        for (int i = 0; i < ring.size; ++i)
        {
          centre.x += ring.corners[i].x / ring.size;
          centre.y += ring.corners[i].y / ring.size;
        }
        f(surface, surface.triangleAt(centre), ring, bounds);
      }
    });
}

const PolygonNodes& PolygonQuadrature::place()
{
  BeamSamples& samples = this->Nodes.samples;
  samples.range.clear();
  samples.cosine.clear();
  samples.weight.clear();
  samples.surfaces.clear();
  samples.nearest = this->Whole.nearest;
  samples.farthest = this->Whole.farthest;
  this->Nodes.uncertain.clear();
  // Rounded corners move the sides, as seen from the apex.
  this->Misplaced = this->Seen->lost + 64.0 * RoundOffDouble / this->Frame.tanHalf;
  this->forEachPart(
    [&](const PlaneSurface& surface, std::uint32_t triangle, const PlaneRing& ring,
      const Bounds& bounds)
    {
      this->Rule.set(surface, triangle, bounds.extent, bounds.faint);
      this->Rule.place(surface, ring, this->Nodes);
    });
  return this->Nodes;
}

double PolygonQuadrature::boundOf(
  const RangeShares& shares, const std::vector<double>& energies) const
{
  const std::vector<double>& uncertain = this->Nodes.uncertain;
  double bound = 0.0;
  double energy = 0.0;
  std::size_t next = 0; // first node whose uncertainty is not yet counted
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t node = shares.contribution[s];
    if (node >= energies.size())
    {
      break; // the other shares belong to paths with two reflections
    }
    energy += shares.energies[s];
    // The neighbouring nodes belong to the parts beyond the borders.
    const std::size_t first = std::max(next, node >= 2 ? node - 2 : 0);
    next = std::min(node + 3, energies.size());
    for (std::size_t k = first; k < next; ++k)
    {
      bound += energies[k] * uncertain[k];
    }
  }
  return bound + (this->Gathers ? ErrorOfGathered : ErrorOfUnit) * energy +
    this->Misplaced * this->Whole.returnBound;
}
}
