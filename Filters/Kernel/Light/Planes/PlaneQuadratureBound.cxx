// SPDX-License-Identifier: BSD-3-Clause
// How wrong the nodes of PlaneQuadrature.h may be.
#include "PlaneQuadrature.h"

#include "Propagation.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
/// Corners and ranges are rounded, and the ranges of the patch's triangles may differ a little.
double PlaneQuadrature::shiftOf(const VisiblePatch& patch, const PatchPlane& plane) const
{
  const PlaneDisc& disc = this->Disc;
  const double corners = 8.0 * RoundOffDouble * plane.size / disc.cosMost;
  const double ranges = (16.0 * RoundOffDouble / disc.cosMost + patch.apart) * disc.farthest();
  const double shift = corners + ranges;
  return this->Ranges.isParted(disc.nearest() - shift, disc.farthest() + shift) ? shift : 0.0;
}

/// Energy, J, that a shift in range brings over the borders of units: no more than it is long on
/// the pulse, of all energy; and than what lies in a strip as wide.
double PlaneQuadrature::shiftedOf(
  const RangeShares& shares, const std::vector<double>& energies) const
{
  if (this->Nodes.shift == 0.0)
  {
    return 0.0;
  }
  const std::vector<double>& ranges = this->Nodes.samples.range;
  const std::vector<BeamSamples::Surface>& panels = this->Nodes.samples.surfaces;
  constexpr double surely = 4.0; // between nodes there may be more than at them
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
