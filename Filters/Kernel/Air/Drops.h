// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Drops.h
 * @brief How the drops of a medium change what it sends back in a range unit, beside the mean.
 *
 * Drops are a Poisson number in the unit's part of the beam's cone, and the energy of each is the
 * square of an exponential diameter, or of a leaf's cosine (Air.h): up to FewDrops are drawn one by
 * one, more are a gamma distribution of the same mean and variance.
 *
 * A drop shares its pulse with the units that the pulse overlaps, as surfaces do (RangeUnits.h), so
 * drops vary less in a unit, and neighbouring units vary together. Each of few drops has a place of
 * its own in its unit. Many vary as if all were at one of two places, either equally likely, which
 * are chosen such that variances, covariances and third moments of units are those of drops
 * anywhere (of pulses no wider than a unit, or of whole units).
 *
 * Source: G. Marsaglia and W. W. Tsang, ACM Trans. Math. Softw. 26, 2000 (gamma variates).
 * Differs: the paper's air sends nothing back.
 * Valid: the mean changes little within a pulse, as beyond the first few units; the beam is evenly
 * lit as far as drops are concerned.
 * Test: TestAir.cxx.
 */
#ifndef avianlidar_Drops_h
#define avianlidar_Drops_h

#include "Air.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// How the pulse of a drop is divided among range units.
class PulseShares
{
public:
  /// @param width tau_e/tau_s, 0 to 1000
  explicit PulseShares(double width = 0.0);

  /// Units that a pulse reaches before and behind its own.
  std::int64_t reach() const { return this->Reach; }

  /// Add the energy of a pulse to 2 reach() + 1 units, its own in the middle. @param place in its
  /// own unit, 0 to 1
  void add(double energy, double place, double* units) const;

  /// One of the two places of many drops, in [0, 1]; the other is as far from the other end.
  double placeOfMany() const { return this->Place; }

private:
  double Width;
  std::int64_t Reach;
  double Place;
};

/// Up to so many drops in a unit, on average, are drawn one by one.
constexpr double FewDrops = 40.0;

/// Add what the drops of a unit return beyond their mean to 2 reach() + 1 units: a compound Poisson
/// law. @param mean J @param drops on average @param number of the unit, or one that no other has
/// @param medium whose squareOfDrops and `renewed` count
void addDropsBeyondMean(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double mean, double drops, const Medium& medium,
  const PulseShares& pulse, double* units);

/// What all drops of a beam return beyond their mean in each unit. Units are drawn once, if they
/// are asked for in order. One per thread.
class SharedDrops
{
public:
  explicit SharedDrops(const PulseShares& pulse)
    : Reach(pulse.reach())
    , Numbers(static_cast<std::size_t>(2 * Reach + 1), -1)
    , Shares(Numbers.size() * Numbers.size(), 0.0)
  {
  }

  /// Begin a beam.
  void clear() { this->Numbers.assign(this->Numbers.size(), -1); }

  /// J. @param draw called with a unit and a pointer to its 2 reach() + 1 sums, which are 0
  template <class F>
  double in(std::int64_t unit, F draw)
  {
    double sum = 0.0;
    const std::int64_t reach = this->Reach;
    const std::int64_t count = 2 * reach + 1;
    for (std::int64_t of = std::max<std::int64_t>(0, unit - reach); of <= unit + reach; ++of)
    {
      double* const shares = this->Shares.data() + (of % count) * count;
      std::int64_t& number = this->Numbers[static_cast<std::size_t>(of % count)];
      if (number != of)
      {
        number = of;
        std::fill_n(shares, count, 0.0);
        draw(of, shares);
      }
      sum += shares[unit - of + reach];
    }
    return sum;
  }

private:
  std::int64_t Reach;
  std::vector<std::int64_t> Numbers; ///< units whose drops are known
  std::vector<double> Shares;        ///< J, of each in 2 Reach + 1 units
};
}

#endif
