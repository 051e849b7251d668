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

double StandardErrorEstimator::estimate(double largest, bool onePlane)
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
  for (const std::size_t ray : this->Touched)
  {
    sum += this->Energies[ray];
  }
  const double mean = sum / (rays + pseudo);
  double squares = onePlane ? 0.0 : 2.0 * mean * mean + 2.0 * (largest - mean) * (largest - mean);
  for (const std::size_t ray : this->Touched)
  {
    squares += (this->Energies[ray] - mean) * (this->Energies[ray] - mean);
  }
  squares += (rays - static_cast<double>(this->Touched.size())) * mean * mean;
  const double variance = squares / (rays + pseudo - 1.0);
  return rays * std::sqrt(variance / (rays + pseudo));
}

double StandardErrorEstimator::stratified(double largest, bool onePlane)
{
  double variance = onePlane ? 0.0 : largest * largest;
  const auto addCell = [&](std::size_t cell)
  {
    // Every cell but the last holds two rays.
    const double* x = this->Energies.data() + 2 * cell;
    if (this->Strata->raysInCell(cell) == 2)
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
  };
  // Cells in ascending order, each once; those without energy add nothing.
  if (this->Energies.size() <= 4 * this->Touched.size())
  {
    const std::size_t cells = this->Strata->cellOfRay(this->Energies.size() - 1) + 1;
    for (std::size_t cell = 0; cell + 1 < cells; ++cell)
    {
      const double difference = this->Energies[2 * cell] - this->Energies[2 * cell + 1];
      variance += difference * difference;
    }
    addCell(cells - 1);
    return std::sqrt(variance);
  }
  if (!std::is_sorted(this->Touched.begin(), this->Touched.end()))
  {
    std::sort(this->Touched.begin(), this->Touched.end());
  }
  std::size_t next = 0;
  for (const std::size_t ray : this->Touched)
  {
    const std::size_t cell = this->Strata->cellOfRay(ray);
    if (cell >= next)
    {
      addCell(cell);
      next = cell + 1;
    }
  }
  return std::sqrt(variance);
}
}
