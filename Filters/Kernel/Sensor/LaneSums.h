// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LaneSums.h
 * @brief Sums in eight partial sums, and such sums over the shares of paths in range units.
 *
 * Summands go to the partial sums in turn, and these are added up in one order. So a loop may add
 * eight summands at a time, or four, or two: the bits are the same for every width of vectors. A
 * contribution belongs to the partial sum of its number modulo eight, whether shares are given for
 * all contributions or only for those that have one: zeros change no sum.
 *
 * Source: none.
 * Valid: finite values. The rounding error is that of a sum an eighth as long.
 * Test: TestRangeShares.cxx, TestStandardError.cxx.
 */
#ifndef avianlidar_LaneSums_h
#define avianlidar_LaneSums_h

#include "Multiversion.h"
#include "RangeUnits.h"

#include <cstddef>

namespace avianlidar
{
/// Summand i belongs to partial sum i modulo this.
constexpr std::size_t SumLanes = 8;

/// Total of the partial sums: three times the upper half is added to the lower.
AVIANLIDAR_ALWAYS_INLINE double totalOf(const double (&lane)[SumLanes])
{
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

/// Energy (J) and energy times a value.
struct WeightedSum
{
  double energy = 0.0;
  double moment = 0.0;
};

/// Sums over the shares of energy and of energy times (value - reference). @param values finite, by
/// contribution
WeightedSum sumShares(const RangeShares& shares, const double* values, double reference);

/// Sum of the energies of contributions from number `first` on.
double sumSharesFrom(const RangeShares& shares, std::size_t first);
}

#endif
