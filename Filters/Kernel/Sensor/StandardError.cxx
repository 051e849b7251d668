// SPDX-License-Identifier: BSD-3-Clause
#include "StandardError.h"

#include "LaneSums.h"
#include "Multiversion.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace avianlidar
{
namespace
{
/// Of so many rays one at least must have energy for all to be looked at.
constexpr std::size_t ManyRays = 4;

/// Fewer rays say too little of how much energies differ.
constexpr std::size_t FewestRays = 8;

/// Student's t over the normal distribution's 1.96, for intervals of 95 % from FewestRays ... 15
/// values.
constexpr double SmallSample[] = { 1.2066, 1.1765, 1.1541, 1.1367, 1.1230, 1.1117, 1.1020, 1.0943 };

AVIANLIDAR_MULTIVERSION double largestOf(const double* values, std::size_t count)
{
  double most = 0.0;
#pragma omp simd reduction(max : most)
  for (std::size_t i = 0; i < count; ++i)
  {
    most = values[i] > most ? values[i] : most;
  }
  return most;
}

/// Sum of squared differences of neighbours.
AVIANLIDAR_MULTIVERSION double squaresOfPairs(const double* values, std::size_t pairs)
{
  constexpr std::size_t lanes = SumLanes;
  double sum[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= pairs; i += lanes)
  {
#pragma omp simd
    for (std::size_t k = 0; k < lanes; ++k)
    {
      const double difference = values[2 * (i + k)] - values[2 * (i + k) + 1];
      sum[k] += difference * difference;
    }
  }
  for (std::size_t k = 0; i + k < pairs; ++k)
  {
    const double difference = values[2 * (i + k)] - values[2 * (i + k) + 1];
    sum[k] += difference * difference;
  }
  return totalOf(sum);
}

/// The same, bit for bit, where the values of all others are 0. @param which of the values, in
/// ascending order
double squaresOfSome(const double* values, std::size_t pairs, const std::vector<std::size_t>& which)
{
  double sum[SumLanes] = {};
  std::size_t next = 0;
  for (const std::size_t one : which)
  {
    const std::size_t pair = one / 2;
    if (pair >= next && pair < pairs)
    {
      const double difference = values[2 * pair] - values[2 * pair + 1];
      sum[pair % SumLanes] += difference * difference;
      next = pair + 1;
    }
  }
  return totalOf(sum);
}
}

StandardErrorEstimator::StandardErrorEstimator(
  Sampling sampling, std::size_t numberOfRays, const StrataPartition* strata)
  : Method(sampling)
  , Strata(strata)
  , Energies(numberOfRays, 0.0)
{
  if (sampling == Sampling::Stratified && (!strata || strata->numberOfRays() != numberOfRays))
  {
    throw std::invalid_argument("strata do not fit the number of rays");
  }
}

void StandardErrorEstimator::begin(std::size_t expected)
{
  if (this->All)
  {
    std::fill(this->Energies.begin(), this->Energies.end(), 0.0);
  }
  for (const std::size_t ray : this->Touched)
  {
    this->Energies[ray] = 0.0;
  }
  this->Touched.clear();
  this->All = ManyRays * expected >= this->Energies.size();
}

void StandardErrorEstimator::add(std::size_t ray, double energy)
{
  if (energy > 0.0)
  {
    if (!this->All && this->Energies[ray] == 0.0)
    {
      this->Touched.push_back(ray);
    }
    this->Energies[ray] += energy;
  }
}

double StandardErrorEstimator::largest() const
{
  if (this->All)
  {
    return largestOf(this->Energies.data(), this->Energies.size());
  }
  double most = 0.0;
  for (const std::size_t ray : this->Touched)
  {
    most = std::max(most, this->Energies[ray]);
  }
  return most;
}

double StandardErrorEstimator::smallest() const
{
  if (this->All)
  {
    return *std::min_element(this->Energies.begin(), this->Energies.end());
  }
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t ray : this->Touched)
  {
    least = std::min(least, this->Energies[ray]);
  }
  return this->Touched.size() < this->Energies.size() ? 0.0 : least;
}

double StandardErrorEstimator::estimate(const UnseenEnergy& unseen)
{
  const std::size_t rays = this->Energies.size();
  if (rays < FewestRays)
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (!std::is_sorted(this->Touched.begin(), this->Touched.end()))
  {
    std::sort(this->Touched.begin(), this->Touched.end());
  }
  const double error =
    this->Method == Sampling::MonteCarlo ? this->monteCarlo(unseen) : this->stratified(unseen);
  const std::size_t few = rays - FewestRays;
  return few < std::size(SmallSample) ? SmallSample[few] * error : error;
}

/// Call take(energy) for the rays with energy, in the order of their numbers.
template <class F>
void StandardErrorEstimator::forEachRay(F take) const
{
  for (std::size_t n = 0; this->All && n < this->Energies.size(); ++n)
  {
    if (this->Energies[n] > 0.0)
    {
      take(this->Energies[n]);
    }
  }
  for (const std::size_t ray : this->Touched)
  {
    take(this->Energies[ray]);
  }
}

double StandardErrorEstimator::monteCarlo(const UnseenEnergy& unseen) const
{
  const double rays = static_cast<double>(this->Energies.size());
  const double all = rays + 4.0;
  double sum = 2.0 * (unseen.least + unseen.most);
  this->forEachRay([&](double energy) { sum += energy; });
  const double mean = sum / all;
  const auto square = [mean](double energy) { return (energy - mean) * (energy - mean); };
  double squares = 2.0 * (square(unseen.least) + square(unseen.most));
  std::size_t seen = 0;
  this->forEachRay(
    [&](double energy)
    {
      squares += square(energy);
      ++seen;
    });
  squares += (rays - static_cast<double>(seen)) * square(0.0);
  return std::sqrt(rays * squares / (all - 1.0));
}

double StandardErrorEstimator::stratified(const UnseenEnergy& unseen)
{
  const double step = unseen.most - unseen.least;
  const double* const x = this->Energies.data();
  const std::size_t last = this->Energies.size() / 2 - 1; // every cell before it holds two rays
  double variance = step * step;
  if (this->All || this->Energies.size() <= ManyRays * this->Touched.size())
  {
    variance += squaresOfPairs(x, last);
  }
  else
  {
    variance += squaresOfSome(x, last, this->Touched);
  }
  const double a = x[2 * last] - x[2 * last + 1];
  if (this->Strata->raysInCell(last) == 2)
  {
    return std::sqrt(variance + a * a);
  }
  // Three: 3 s^2, and the sum of squared deviations, 2 s^2, is a third of the squared differences.
  const double b = x[2 * last + 1] - x[2 * last + 2];
  const double c = x[2 * last + 2] - x[2 * last];
  return std::sqrt(variance + 0.5 * (a * a + b * b + c * c));
}
}
