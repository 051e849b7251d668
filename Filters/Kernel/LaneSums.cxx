// SPDX-License-Identifier: BSD-3-Clause
#include "LaneSums.h"

#include "Multiversion.h"

namespace avianlidar
{
namespace
{
constexpr std::size_t Lanes = 8;

double totalOf(const double* lane)
{
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

AVIANLIDAR_MULTIVERSION void sumAll(const double* energies, const double* values, double reference,
  std::size_t count, double* energy, double* moment)
{
  double e[Lanes] = {};
  double m[Lanes] = {};
  std::size_t i = 0;
  for (; i + Lanes <= count; i += Lanes)
  {
#pragma omp simd
    for (std::size_t k = 0; k < Lanes; ++k)
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
  for (std::size_t k = 0; k < Lanes; ++k)
  {
    energy[k] = e[k];
    moment[k] = m[k];
  }
}
}

WeightedSum sumShares(const RangeShares& shares, const double* values, double reference)
{
  double energy[Lanes] = {};
  double moment[Lanes] = {};
  if (!shares.which)
  {
    sumAll(shares.energies, values, reference, shares.count, energy, moment);
  }
  for (std::size_t s = 0; shares.which && s < shares.count; ++s)
  {
    const std::uint32_t c = shares.which[s];
    energy[c % Lanes] += shares.energies[s];
    moment[c % Lanes] += shares.energies[s] * (values[c] - reference);
  }
  return { totalOf(energy), totalOf(moment) };
}

double sumSharesFrom(const RangeShares& shares, std::size_t first)
{
  double energy[Lanes] = {};
  for (std::size_t s = shares.which ? 0 : first; s < shares.count; ++s)
  {
    const std::size_t c = shares.contribution(s);
    energy[c % Lanes] += c >= first ? shares.energies[s] : 0.0;
  }
  return totalOf(energy);
}
}
