// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LaneSums.h
 * @brief Sums over the shares of paths in eight partial sums (EightSums.h): as fast as lanes allow,
 * and the same bits for every width of vectors.
 *
 * A contribution belongs to the partial sum of its number modulo eight, whether shares are given
 * for all contributions or for those alone that have one: zeros change no sum.
 */
#ifndef avianlidar_LaneSums_h
#define avianlidar_LaneSums_h

#include "RangeUnits.h"

#include <cstddef>

namespace avianlidar
{
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
