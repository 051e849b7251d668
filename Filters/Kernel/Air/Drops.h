// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Drops.h
 * @brief Draws the difference between the light of a medium's drops in a range unit and the mean of
 * this light.
 *
 * The number of drops in the unit's part of the beam is Poisson distributed. The energy of a drop
 * follows from its exponentially distributed diameter (DropLight). The energy of a leaf is
 * proportional to the square of its cosine of incidence. Below, leaves count as drops. Up to
 * FewDrops drops are drawn one by one. The energy of more than FewDrops drops is a gamma variate
 * with the mean and variance of drops that are drawn one by one.
 *
 * The pulse of a drop is divided among the units that it overlaps, as for surfaces (RangeUnits.h).
 * So the energy of a unit varies less than with undivided pulses. The energies of neighbouring
 * units are correlated. Each drop that is drawn alone has its own place in its unit. Drops that are
 * drawn together all lie at one of two equally likely places. With these two places, units have the
 * variances, covariances and third moments that uniformly distributed places would give, if the
 * pulse is no wider than a unit or as wide as a whole number of units.
 *
 * Source: G. Marsaglia and W. W. Tsang, ACM Trans. Math. Softw. 26, 2000 (gamma variates).
 * Differs: the paper's air sends nothing back.
 * Valid: the mean energy must change little within a pulse. This condition holds beyond the first
 * few units. The model illuminates all drops of the beam evenly.
 * Test: TestAir.cxx.
 */
#ifndef avianlidar_Drops_h
#define avianlidar_Drops_h

#include "Air.h"
#include "ReceivedPulse.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Divides the pulse of a drop among range units.
class PulseShares
{
public:
  /// @param pulse pulse, in units
  explicit PulseShares(const ReceivedPulse& pulse = 0.0);

  /// Number of units that a pulse reaches on each side of its own unit.
  std::int64_t reach() const { return this->Reach; }

  /// Add the energy of a pulse to 2 reach() + 1 units, with the pulse's own unit in the middle.
  /// @param place place of the drop in its own unit, as a share of the unit, 0 to 1
  void add(double energy, double place, double* units) const;

  /// One of the two places of drops that are drawn together, as a share of the unit, in [0, 1]. The
  /// other place is 1 - placeOfMany().
  double placeOfMany() const { return this->Place; }

private:
  ReceivedPulse Pulse;
  std::int64_t Reach;
  double Place;
};

/// Largest mean number of drops in a unit at which the drops are drawn one by one.
constexpr double FewDrops = 40.0;

/// Add the light of a unit's drops, minus the mean of this light, to 2 reach() + 1 units (compound
/// Poisson law).
/// @param number number of the unit, or another unique number @param mean mean energy, J
/// @param drops mean number of drops @param medium medium whose `squareOfDrops` and `renewed` are
/// used @param units sums, J
void addDropsBeyondMean(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double mean, double drops, const Medium& medium,
  const PulseShares& pulse, double* units);

/// Sums the light of a beam's drops beyond the mean of this light, unit by unit. If units are
/// requested in ascending order, the drops of each unit are drawn once. Each thread needs its own
/// object.
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

  /// Light in a unit minus the mean of this light, J. @param draw function that adds the light of a
  /// unit's drops to 2 reach() + 1 sums, which are 0 before the call
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
  std::vector<std::int64_t> Numbers; ///< units whose drops are drawn
  std::vector<double> Shares;        ///< light of the drops of `Numbers` in 2 Reach + 1 units, J
};
}

#endif
