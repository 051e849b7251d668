// SPDX-License-Identifier: BSD-3-Clause
#include "EnergyErrors.h"

#include "PolygonQuadrature.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Standard error, J, of the energy in some range units. @param shares shares of the samples in
/// these units, before any shares of paths with two reflections
double errorOfCells(const CellSamples& cells, const RangeShares& shares, const ScanSetup& setup)
{
  const auto sampleOf = [&](std::size_t s) { return shares.contribution[s]; };
  const auto perWeight = [&](std::size_t s)
  { return shares.energies[s] / cells.samples.weight[sampleOf(s)]; };
  // Weight that moves over the diagonal counts if the material differs there.
  const auto halvesDiffer = [&](std::size_t k)
  {
    return cells.others[k] != NoTriangle && !cells.halves.empty() &&
      setup.material(cells.others[k]) != setup.material(cells.samples.surfaces[k].triangle);
  };
  auto surface = cells.samples.surfaces.begin();
  bool differ = !cells.others.empty() && halvesDiffer(0);
  std::size_t first = 0; // first sample of the surface
  double sum = 0.0;
  const auto addStep = [&](std::size_t sample, double step)
  { sum += step * step * (cells.moves[sample] + cells.moves[sample + 1]); };
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t sample = sampleOf(s);
    if (sample >= cells.samples.size())
    {
      break;
    }
    while (surface->end <= sample)
    {
      first = surface->end;
      ++surface;
      differ = halvesDiffer(surface - cells.samples.surfaces.begin());
    }
    const double energy = perWeight(s);
    // The previous sample has no share in these units.
    if (sample > first && (s == 0 || sampleOf(s - 1) + 1 != sample))
    {
      addStep(sample - 1, energy);
    }
    sum += energy * energy * (cells.variance[sample] + (differ ? cells.halves[sample] : 0.0));
    if (sample + 1 < surface->end)
    {
      const bool isNext = s + 1 < shares.count && sampleOf(s + 1) == sample + 1;
      addStep(sample, energy - (isNext ? perWeight(s + 1) : 0.0));
    }
  }
  return std::sqrt(sum);
}

/// Error of the energy that mirror paths put into a unit, by the width of the mirrors' lobes, J.
double errorOfLobes(const BeamLight& light, const RangeShares& shares)
{
  double sum = 0.0;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const SecondaryPath* const path = light.pathOf(shares.contribution[s]);
    sum += path ? shares.energies[s] * path->unsure : 0.0;
  }
  return sum;
}

/// Standard error of the energy that mirror paths by regions put into a unit, J. A stratum is two
/// neighbouring samples, one of which may not arrive. Few samples that all arrive do not show that
/// every sample would arrive, so the square of the largest energy is added, as in StandardError.h.
double errorOfMirrors(const BeamLight& light, const RangeShares& shares)
{
  const auto isMirror = [&](std::size_t s)
  {
    const SecondaryPath* const path = light.pathOf(shares.contribution[s]);
    return path && path->one == NoSample;
  };
  const auto sampleOf = [&](std::size_t s) { return light.pathOf(shares.contribution[s])->two; };
  double variance = 0.0;
  double most = 0.0; // largest energy of a sample, J
  std::uint32_t last = NoSample;
  double waiting = 0.0;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    if (!isMirror(s))
    {
      continue;
    }
    double energy = shares.energies[s];
    // Both directions of a path belong to one sample.
    for (; s + 1 < shares.count && isMirror(s + 1) && sampleOf(s + 1) == sampleOf(s); ++s)
    {
      energy += shares.energies[s + 1];
    }
    most = std::max(most, energy);
    const std::uint32_t stratum = sampleOf(s) / 2;
    if (stratum == last)
    {
      variance -= waiting * waiting;
      variance += (energy - waiting) * (energy - waiting);
      last = NoSample;
      continue;
    }
    variance += energy * energy;
    waiting = energy;
    last = stratum;
  }
  return std::sqrt(std::max(0.0, variance) + most * most);
}
}

double EnergyErrors::of(
  const BeamLight& light, const RangeShares& shares, std::uint32_t paths) const
{
  if (paths == 0)
  {
    return 0.0; // a false alarm: no sample has a share in it
  }
  const double sampling = this->ofSamples(light, shares, paths);
  const double lobes = errorOfLobes(light, shares);
  return lobes > 0.0 ? std::hypot(sampling, lobes) : sampling;
}

/// Sampling error of the energy in a unit, J.
double EnergyErrors::ofSamples(
  const BeamLight& light, const RangeShares& shares, std::uint32_t paths) const
{
  if (light.raysAreLit())
  {
    return this->ofRays(
      light, shares, paths >= light.samples()->rays && light.samples()->onOnePlane());
  }
  const bool pathsArrive = !light.paths.empty();
  const bool fromRays = pathsArrive && light.paths.back().one != NoSample;
  const double ofPaths =
    std::hypot(fromRays ? this->ofRays(light, shares, false) : 0.0, errorOfMirrors(light, shares));
  if (light.cells)
  {
    const double ofCells = errorOfCells(*light.cells, shares, this->Setup);
    return pathsArrive ? std::sqrt(ofCells * ofCells + ofPaths * ofPaths) : ofCells;
  }
  return ofPaths + boundOfNodes(light.nodes, shares, light.energies);
}

/// Standard error of the energy that rays put into a unit, J: on paths with two reflections and, if
/// the rays are the samples, as direct echoes. @param filled true if every ray put energy into the
/// unit and one plane fills the beam, so that no ray puts less
double EnergyErrors::ofRays(const BeamLight& light, const RangeShares& shares, bool filled) const
{
  const std::vector<std::uint32_t>& rays = light.starts->ray;
  StandardErrorEstimator& error = this->OfRays;
  error.begin();
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::uint32_t contribution = shares.contribution[s];
    const SecondaryPath* const path = light.pathOf(contribution);
    if (!path)
    {
      if (light.raysAreLit())
      {
        error.add(rays[contribution], shares.energies[s]);
      }
      continue;
    }
    // A connection depends on both its rays.
    if (path->one == NoSample)
    {
      continue;
    }
    error.add(rays[path->one], shares.energies[s]);
    if (path->two != NoSample)
    {
      error.add(rays[path->two], shares.energies[s]);
    }
  }
  return error.estimate({ filled ? error.smallest() : 0.0, error.largest() });
}
}
