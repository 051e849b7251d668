// SPDX-License-Identifier: BSD-3-Clause
#include "StandardError.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace avianlidar
{
namespace
{
/// Least number of rays. Fewer rays do not show how much energies differ.
constexpr std::size_t FewestRays = 8;

/// Student's t over the normal 1.96, for 95 % intervals from FewestRays to 15 values.
constexpr double SmallSample[] = { 1.2066, 1.1765, 1.1541, 1.1367, 1.1230, 1.1117, 1.1020, 1.0943 };
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

void StandardErrorEstimator::begin()
{
  for (const std::size_t ray : this->Touched)
  {
    this->Energies[ray] = 0.0;
  }
  this->Touched.clear();
}

void StandardErrorEstimator::add(std::size_t ray, double energy)
{
  if (energy > 0.0)
  {
    if (this->Energies[ray] == 0.0)
    {
      this->Touched.push_back(ray);
    }
    this->Energies[ray] += energy;
  }
}

double StandardErrorEstimator::largest() const
{
  double most = 0.0;
  for (const std::size_t ray : this->Touched)
  {
    most = std::max(most, this->Energies[ray]);
  }
  return most;
}

double StandardErrorEstimator::smallest() const
{
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

double StandardErrorEstimator::monteCarlo(const UnseenEnergy& unseen) const
{
  const double rays = static_cast<double>(this->Energies.size());
  const double all = rays + 4.0;
  double sum = 2.0 * (unseen.least + unseen.most);
  for (const std::size_t ray : this->Touched)
  {
    sum += this->Energies[ray];
  }
  const double mean = sum / all;
  const auto square = [mean](double energy) { return (energy - mean) * (energy - mean); };
  double squares = 2.0 * (square(unseen.least) + square(unseen.most));
  for (const std::size_t ray : this->Touched)
  {
    squares += square(this->Energies[ray]);
  }
  squares += (rays - static_cast<double>(this->Touched.size())) * square(0.0);
  return std::sqrt(rays * squares / (all - 1.0));
}

double StandardErrorEstimator::stratified(const UnseenEnergy& unseen)
{
  const double step = unseen.most - unseen.least;
  const double* const x = this->Energies.data();
  const std::size_t last = this->Energies.size() / 2 - 1; // every cell before it holds two rays
  double variance = step * step;
  std::size_t next = 0; // first pair not yet counted
  for (const std::size_t ray : this->Touched)
  {
    const std::size_t pair = ray / 2;
    if (pair >= next && pair < last)
    {
      const double difference = x[2 * pair] - x[2 * pair + 1];
      variance += difference * difference;
      next = pair + 1;
    }
  }
  const double a = x[2 * last] - x[2 * last + 1];
  if (this->Strata->raysInCell(last) == 2)
  {
    return std::sqrt(variance + a * a);
  }
  // Three rays add 3 s^2. Their squared deviations, 2 s^2, are a third of the squared differences.
  const double b = x[2 * last + 1] - x[2 * last + 2];
  const double c = x[2 * last + 2] - x[2 * last];
  return std::sqrt(variance + 0.5 * (a * a + b * b + c * c));
}
}
