// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Random.h
 * @brief Counter-based random numbers: Philox4x32-10 (Salmon et al., SC'11; library Random123).
 *
 * Every number is a pure function of (seed, beam, index, purpose): the result does not depend on
 * threads, order, pieces, or on how many numbers anything else has drawn.
 */
#ifndef avianlidar_Random_h
#define avianlidar_Random_h

#include <array>
#include <cstdint>

namespace avianlidar
{
/// What a number is drawn for; each purpose is a stream of its own.
enum class RandomPurpose : std::uint32_t
{
  Rays = 0,
  Connections = 1,
  Noise = 2,
  FalseAlarms = 3,
  Pilot = 4
};

/// Two independent uniform doubles in the open interval (0, 1), 53 bits each.
/// @param seed any int; @param beam beam id; @param index ray, range unit or draw number
std::array<double, 2> uniformPair(
  std::int32_t seed, std::uint64_t beam, std::uint64_t index, RandomPurpose purpose);
}

#endif
