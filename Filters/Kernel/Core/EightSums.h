// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EightSums.h
 * @brief Eight partial sums, to which summands go in turn, and the one order in which they are
 * added up.
 *
 * A loop over lanes may add eight summands at a time, or four, or two: each partial sum is the same
 * bits, and so is the total. Its rounding error is that of a sum an eighth as long.
 */
#ifndef avianlidar_EightSums_h
#define avianlidar_EightSums_h

#include "Multiversion.h"

#include <cstddef>

namespace avianlidar
{
/// Summand i belongs to partial sum i modulo this.
constexpr std::size_t SumLanes = 8;

/// As lanes that are halved three times: the upper half is added to the lower.
AVIANLIDAR_ALWAYS_INLINE double totalOf(const double (&lane)[SumLanes])
{
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}
}

#endif
