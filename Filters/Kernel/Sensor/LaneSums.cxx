// SPDX-License-Identifier: BSD-3-Clause
#include "LaneSums.h"

namespace avianlidar
{
namespace
{
AVIANLIDAR_MULTIVERSION void sumAll(const double* energies, const double* values, double reference,
  std::size_t count, double* energy, double* moment)
{
  double e[SumLanes] = {};
  double m[SumLanes] = {};
  std::size_t i = 0;
  for (; i + SumLanes <= count; i += SumLanes)
  {
#pragma omp simd
    for (std::size_t k = 0; k < SumLanes; ++k)
    {
      e[k] += energies[i + k];
      m[k] += energies[i + k] * (values[i + k] - reference);
    }
  }
  for (std::size_t k = 0; i + k < count; ++k)
  {
    e[k] += energies[i + k];
    m[k] += energies[i + k] * (values[i + k] - reference);
  }
  for (std::size_t k = 0; k < SumLanes; ++k)
  {
    energy[k] = e[k];
    moment[k] = m[k];
  }
}
}

WeightedSum sumShares(const RangeShares& shares, const double* values, double reference)
{
  double energy[SumLanes] = {};
  double moment[SumLanes] = {};
  if (!shares.which)
  {
    sumAll(shares.energies, values, reference, shares.count, energy, moment);
  }
  for (std::size_t s = 0; shares.which && s < shares.count; ++s)
  {
    const std::uint32_t c = shares.which[s];
    energy[c % SumLanes] += shares.energies[s];
    moment[c % SumLanes] += shares.energies[s] * (values[c] - reference);
  }
  return { totalOf(energy), totalOf(moment) };
}

double sumSharesFrom(const RangeShares& shares, std::size_t first)
{
  double energy[SumLanes] = {};
  for (std::size_t s = shares.which ? 0 : first; s < shares.count; ++s)
  {
    const std::size_t c = shares.contribution(s);
    energy[c % SumLanes] += c >= first ? shares.energies[s] : 0.0;
  }
  return totalOf(energy);
}
}
