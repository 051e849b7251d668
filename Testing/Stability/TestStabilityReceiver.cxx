// SPDX-License-Identifier: BSD-3-Clause
// Range units from a picosecond to a millisecond over 100 km, and photon noise from 1e-12 to 1e12
// photons, beside the Poisson distribution summed term by term.
#include "Distributions.h"
#include "EchoTestScene.h"
#include "Memory.h"
#include "Random.h"
#include "RangeUnits.h"
#include "Sanitized.h"
#include "StabilityTable.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include <gtest/gtest.h>

using namespace echotest;
using stability::record;
using stability::Worst;

TEST(StabilityReceiver, RangeUnitsOver100Kilometres)
{
  Worst energy;
  Worst units;
  Worst bytes;
  constexpr double Farthest = 1e5; // m
  std::vector<Contribution> paths; // there and back
  for (std::size_t n = 0; n < 20000; ++n)
  {
    const auto u = uniformPair(11, 0, n, RandomPurpose::Rays);
    paths.push_back({ 2.0 * Farthest * u[0], 1e-6 * u[1] });
  }
  for (int decade = -12; decade <= -3; ++decade)
  {
    const double interval = std::pow(10.0, decade);
    for (const double width : { 0.0, 0.5, 1.0, 1.5, 100.0, 1000.0 })
    {
      const std::size_t before = benchmarks::heapBytes();
      RangeUnitAccumulator accumulator(interval, width * interval, Farthest);
      long double sum = 0.0L;
      for (const Contribution& c : paths)
      {
        accumulator.add(c);
        sum += c.energy;
      }
      accumulator.accumulate();
      long double received = accumulator.energyBeyondGate();
      for (const RangeUnit& unit : accumulator.units())
      {
        received += unit.energy;
      }
      energy.see(static_cast<double>(std::fabs(received / sum - 1.0L)));
      const double most = static_cast<double>(paths.size()) * (width + 2.0);
      units.see(static_cast<double>(accumulator.units().size()) / most);
      bytes.see(static_cast<double>(benchmarks::heapBytes() - before) / most);
    }
  }
  const std::string range = "1e-12 to 1e-3 s, pulse 0 to 1000 of them, 20,000 paths over 100 km";
  record({ "Range unit", range, "-", "relative loss of energy", 1e-12, energy.value() });
  record({ "Range unit", range, "-", "units that are kept, over paths x (2 + pulse width/unit)",
    1.0, units.value() });
  if (!IsSanitized)
  {
    record({ "Range unit", range, "-", "heap bytes, over paths x (2 + pulse width/unit)", 200.0,
      bytes.value() });
  }
}

namespace
{
using Digits50 = boost::multiprecision::cpp_bin_float_50;

/// ln k!, by Stirling's series from 1000 on.
Digits50 logFactorial(double k)
{
  if (k < 1000.0)
  {
    Digits50 product = 1;
    for (double i = 2.0; i <= k; i += 1.0)
    {
      product *= i;
    }
    return log(product);
  }
  const Digits50 n = k;
  const Digits50 pi = boost::math::constants::pi<Digits50>();
  const Digits50 s = 1 / (n * n);
  return n * log(n) - n + log(2 * pi * n) / 2 +
    (Digits50(1) / 12 - s * (Digits50(1) / 360 - s * (Digits50(1) / 1260 - s / 1680))) / n;
}

/// P(X > count) or P(X <= count) for X ~ Poisson(mean), term by term: the first in 50 digits, the
/// others from it in long double.
long double summed(double mean, double count, bool tail)
{
  const double start = tail ? count + 1.0 : count;
  if (start < 0.0)
  {
    return 0.0L;
  }
  const Digits50 logTerm = start * log(Digits50(mean)) - Digits50(mean) - logFactorial(start);
  const long double first = exp(logTerm).convert_to<long double>();
  long double sum = 1.0L;
  long double term = 1.0L;
  for (long double k = start; term > 1e-20L * sum && (tail || k > 0.0L); k += tail ? 1.0L : -1.0L)
  {
    term *= tail ? mean / (k + 1.0L) : k / mean;
    sum += term;
  }
  return first * sum;
}
}

TEST(StabilityReceiver, PoissonTailsFrom1e12thToA1e12Photons)
{
  Worst error;
  Worst wrong;
  for (int decade = -12; decade <= 12; ++decade)
  {
    const double mean = std::pow(10.0, decade);
    for (const double small : { 1e-200, 1e-30, 1e-12, 1e-6, 1e-3, 0.3 })
    {
      // Quantiles at both ends, and the tails there.
      const double high = poissonQuantile(mean, 1.0 - small, small);
      const double low = poissonQuantile(mean, small, 1.0 - small);
      if (mean > 1e9 && small == 0.3)
      {
        continue; // too many terms to add
      }
      const long double above = summed(mean, high, true);
      if (above > 1e-300L)
      {
        error.see(static_cast<double>(std::fabs(poissonTail(mean, high) / above - 1.0L)));
      }
      // At both sides of the quantile, but for the rounding of the tails themselves.
      wrong.see(above <= small * (1.0 + 1e-10) ? 0.0 : 1.0);
      wrong.see(high == 0.0 || summed(mean, high - 1.0, true) > small * (1.0 - 1e-10) ? 0.0 : 1.0);
      const long double below = summed(mean, low, false);
      if (mean > 1.0)
      {
        error.see(static_cast<double>(std::fabs(poissonCdf(mean, low) / below - 1.0L)));
        wrong.see(below >= small * (1.0 - 1e-10) ? 0.0 : 1.0);
        wrong.see(low == 0.0 || summed(mean, low - 1.0, false) < small * (1.0 + 1e-10) ? 0.0 : 1.0);
      }
    }
  }
  const std::string range = "means of 1e-12 to 1e12 photons, tails of 0.3 to 1e-200";
  record({ "Noise", range, "-",
    "relative error of the tails, beside the sum of the distribution's terms", 1e-10,
    error.value() });
  record({ "Noise", range, "-", "quantiles that are not the smallest count with that probability",
    0.0, wrong.value() });
}
