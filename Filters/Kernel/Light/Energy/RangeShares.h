// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeShares.h
 * @brief The energies that single paths of a beam put into range units.
 *
 * Source: paper, Eq. 10.
 * Differs: see RangeUnits.h.
 * Valid: see RangeUnits.h.
 * Test: TestRangeUnits.cxx.
 */
#ifndef avianlidar_RangeShares_h
#define avianlidar_RangeShares_h

#include "RangeUnits.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Energies that contributions put into some consecutive range units, in the order of the
/// contributions. Contributions that put nothing into these units are left out.
struct RangeShares
{
  const double* energies = nullptr;            ///< energies of the shares, J, above 0
  const std::uint32_t* contribution = nullptr; ///< number of the contribution of each share
  std::size_t count = 0;
};

/// Sums of energies, J, and of energies times a value.
struct WeightedSum
{
  double energy = 0.0;
  double moment = 0.0;
};

/// Sums over shares, in the order of the shares. @param value function of the number of a share
template <class F>
WeightedSum sumShares(const RangeShares& shares, F value)
{
  WeightedSum sum;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    sum.energy += shares.energies[s];
    sum.moment += shares.energies[s] * value(s);
  }
  return sum;
}

/// Finds the shares of one beam after the other. An object is reused without allocation. Each
/// thread needs its own object.
class ShareFinder
{
public:
  /// Begin a beam. @param units range units after accumulate(), which must outlive the use of the
  /// object
  void begin(const RangeUnitAccumulator& units);
  /// Forget the beam, and keep the memory.
  void end() { this->Units = nullptr; }

  /// Shares of the paths in units [first, last), which must lie inside the gate. The shares are
  /// valid until the next call.
  RangeShares sharesOf(std::int64_t first, std::int64_t last);

private:
  void findShares(double first, double last);
  const std::vector<std::uint32_t>& contributionsNear(double first, double last);

  const RangeUnitAccumulator* Units = nullptr;
  // The shares requested last, in units [ShareFirst, ShareLast).
  std::vector<double> Portions;
  std::vector<std::uint32_t> Sharers;
  std::size_t ShareCount = 0;
  std::int64_t ShareFirst = 0;
  std::int64_t ShareLast = 0;
  int Requests = 0;                   ///< number of requests since begin()
  std::vector<std::uint32_t> ByFirst; ///< contributions sorted by first unit, after some requests
  std::vector<std::uint32_t> Near;    ///< contributions near the requested units, by number
};
}

#endif
