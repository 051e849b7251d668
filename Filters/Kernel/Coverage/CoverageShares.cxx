// SPDX-License-Identifier: BSD-3-Clause
#include "CoverageShares.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
void WeightedMean::add(double w, double v)
{
  this->weight[0] += 1.0;
  this->weight[1] += w;
  this->weight[2] += w * w;
  this->value[0] += w * v;
  this->value[1] += w * w * v;
  this->square += w * w * v * v;
}

void WeightedMean::add(const WeightedMean& other)
{
  for (std::size_t i = 0; i < 3; ++i)
  {
    this->weight[i] += other.weight[i];
  }
  this->value[0] += other.value[0];
  this->value[1] += other.value[1];
  this->square += other.square;
}

double WeightedMean::mean() const
{
  return this->weight[1] > 0.0 ? this->value[0] / this->weight[1]
                               : std::numeric_limits<double>::quiet_NaN();
}

double WeightedMean::stdError() const
{
  const double count = this->weight[0];
  if (!(count > 1.0) || !(this->weight[1] > 0.0))
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double m = this->mean();
  const double spread = this->square - 2.0 * m * this->value[1] + m * m * this->weight[2];
  return std::sqrt(std::max(0.0, spread) * count / (count - 1.0)) / this->weight[1];
}

void CoverageShares::add(double weight, const CoverageValue& value, double trackProbability)
{
  this->detected.add(weight, value.probability);
  this->tracked.add(weight, trackProbability);
  this->byStatus[static_cast<std::size_t>(value.status)] += weight;
}

void CoverageShares::add(const CoverageShares& other)
{
  this->detected.add(other.detected);
  this->tracked.add(other.tracked);
  for (std::size_t s = 0; s < Statuses; ++s)
  {
    this->byStatus[s] += other.byStatus[s];
  }
}

double strikeHeightDensity(double height)
{
  constexpr double foot = 0.3048;
  constexpr double low = 500.0 * foot;
  constexpr double shareBelow = 0.74;
  if (!(height >= 0.0))
  {
    return 0.0;
  }
  if (height <= low)
  {
    return shareBelow / low;
  }
  const double rate = -std::log(1.0 - 0.32) / (1000.0 * foot);
  return (1.0 - shareBelow) * rate * std::exp(-rate * (height - low));
}
}
