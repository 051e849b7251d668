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

PolygonQuadrature::PolygonQuadrature(const ScanSetup& setup, double parts)
  : Setup(setup)
  , Rule(setup, parts)
{
}

void PolygonQuadrature::bound(const VisiblePolygons& seen, PolygonBounds& bounds)
{
  bounds.polygons.clear();
  bounds.nearest = std::numeric_limits<double>::infinity();
  bounds.farthest = bounds.returned = bounds.mostInUnit = bounds.mostAlbedo = 0.0;
  double largest = 0.0;
  seen.forEach(
    [&](const PlaneSurface& surface, const PlaneRing& ring)
    {
      const PolygonBounds::One one = this->boundsOf(surface, ring);
      bounds.polygons.push_back(one);
      bounds.nearest = std::min(bounds.nearest, (1.0 - 1e-9) / one.extent.mostInverse);
      bounds.farthest = std::max(
        bounds.farthest, Surely * std::sqrt(1.0 + this->Rule.tangent2()) / one.extent.leastInverse);
      bounds.returned += one.returned * one.share;
      bounds.mostInUnit += one.inUnit;
      largest = std::max(largest, one.returned);
      for (const std::uint32_t triangle : { surface.triangle, surface.other })
      {
        bounds.mostAlbedo = std::max(bounds.mostAlbedo,
          triangle == NoTriangle ? 0.0 : this->Setup.material(triangle).albedo());
      }
    });
  // The rules are exact only below the cap of throughAperture().
  bounds.gathers = this->Setup.sensor.receiverAperture > 0.0 && largest >= 1.0 - 1e-9;
  bounds.returned = Surely * this->Setup.sensor.pulseEnergy * std::min(bounds.returned, largest) *
    transmission(this->Setup.attenuation(), 2.0 * bounds.nearest);
  bounds.mostInUnit = std::min(bounds.returned, bounds.mostInUnit);
  this->drop(bounds);
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

PolygonBounds::One PolygonQuadrature::boundsOf(
  const PlaneSurface& surface, const PlaneRing& ring) const
{
  const Sensor& sensor = this->Setup.sensor;
  const PlaneLine& w = surface.inverse;
  const double slope = w.slope();
  PolygonBounds::One bounds{ PolygonRule::extentOf(surface, ring), 0.0, 0.0, 0.0, false, false };
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
void PolygonQuadrature::drop(PolygonBounds& bounds)
{
  bounds.dropped = 0.0;
  // A surface that returns little laser light may be bright in the sun.
  if (!dropsFaintPaths(this->Setup.settings) || this->Setup.sensor.seesDaylight())
  {
    return;
  }
  this->Faint.clear();
  for (std::uint32_t k = 0; k < bounds.polygons.size(); ++k)
  {
    const PolygonBounds::One& one = bounds.polygons[k];
    if (1.0 / one.extent.leastInverse - 1.0 / one.extent.mostInverse >
      FewUnits * this->Rule.unitLength())
    {
      this->Faint.emplace_back(one.inUnit, k);
    }
  }
  std::sort(this->Faint.begin(), this->Faint.end());
  const double most = 0.5 * lightEnergyTolerance(this->Setup);
  for (const auto& [energy, polygon] : this->Faint)
  {
    PolygonBounds::One& one = bounds.polygons[polygon];
    one.dropped = bounds.dropped + energy <= most;
    const double lacking = one.dropped ? energy : MostFaintStretch * energy;
    one.faint = bounds.dropped + lacking <= most;
    bounds.dropped += one.faint ? lacking : 0.0;
  }
}

/// Call f(surface, triangle, ring, bounds) for each polygon that is not dropped, and for each half
/// of a quadrilateral separately if the halves differ in object or material.
template <class F>
void PolygonQuadrature::forEachPart(
  const VisiblePolygons& seen, const PolygonBounds& all, F f) const
{
  std::size_t number = 0;
  seen.forEach(
    [&](const PlaneSurface& surface, const PlaneRing& ring)
    {
      const PolygonBounds::One& bounds = all.polygons[number++];
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

void PolygonQuadrature::place(const BeamFrame& frame, const VisiblePolygons& seen,
  const PolygonBounds& bounds, PolygonNodes& nodes)
{
  BeamSamples& samples = nodes.samples;
  samples.range.clear();
  samples.cosine.clear();
  samples.weight.clear();
  samples.surfaces.clear();
  samples.nearest = bounds.nearest;
  samples.farthest = bounds.farthest;
  nodes.uncertain.clear();
  // Rounded corners move the sides, as seen from the apex.
  nodes.misplaced = (seen.lost + 64.0 * RoundOffDouble / frame.tanHalf) * bounds.returned;
  nodes.error = bounds.gathers ? ErrorOfGathered : ErrorOfUnit;
  this->forEachPart(seen, bounds,
    [&](const PlaneSurface& surface, std::uint32_t triangle, const PlaneRing& ring,
      const PolygonBounds::One& one)
    {
      this->Rule.set(surface, triangle, one.extent, one.faint);
      this->Rule.place(surface, ring, nodes);
    });
}

double boundOfNodes(
  const PolygonNodes& nodes, const RangeShares& shares, const std::vector<double>& energies)
{
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
      bound += energies[k] * nodes.uncertain[k];
    }
  }
  return bound + nodes.error * energy + nodes.misplaced;
}
}
