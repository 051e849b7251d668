// SPDX-License-Identifier: BSD-3-Clause
#include "StandardError.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace avianlidar
{
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

void StandardErrorEstimator::clear()
{
  std::fill(this->Energies.begin(), this->Energies.end(), 0.0);
}

void StandardErrorEstimator::add(std::size_t ray, double energy)
{
  this->Energies[ray] += energy;
}

double StandardErrorEstimator::estimate(double largest, bool onePlane) const
{
  if (this->Energies.size() < 2)
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return this->Method == Sampling::MonteCarlo ? this->monteCarlo(largest, onePlane)
                                              : this->stratified(largest, onePlane);
}

double StandardErrorEstimator::monteCarlo(double largest, bool onePlane) const
{
  const double rays = static_cast<double>(this->Energies.size());
  const double pseudo = onePlane ? 0.0 : 4.0;
  double sum = onePlane ? 0.0 : 2.0 * largest;
  for (const double x : this->Energies)
  {
    sum += x;
  }
  const double mean = sum / (rays + pseudo);
  double squares = onePlane ? 0.0 : 2.0 * mean * mean + 2.0 * (largest - mean) * (largest - mean);
  for (const double x : this->Energies)
  {
    squares += (x - mean) * (x - mean);
  }
  const double variance = squares / (rays + pseudo - 1.0);
  return rays * std::sqrt(variance / (rays + pseudo));
}

double StandardErrorEstimator::stratified(double largest, bool onePlane) const
{
  double variance = onePlane ? 0.0 : largest * largest;
  for (std::size_t first = 0, cell = 0; cell < this->Strata->cells().size(); ++cell)
  {
    const std::size_t rays = this->Strata->raysInCell(cell);
    const double* x = this->Energies.data() + first;
    if (rays == 2)
    {
      variance += (x[0] - x[1]) * (x[0] - x[1]);
    }
    else
    {
      // Three: 3 s^2, and the sum of squared deviations, 2 s^2, is a third of the squared
      // differences.
      const double a = x[0] - x[1];
      const double b = x[1] - x[2];
      const double c = x[2] - x[0];
      variance += 0.5 * (a * a + b * b + c * c);
    }
    first += rays;
  }
  return std::sqrt(variance);
}
}
