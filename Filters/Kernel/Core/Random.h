// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Random.h
 * @brief Counter-based random numbers: each number is a pure function of (seed, beam, index,
 * purpose).
 *
 * Results thus do not depend on threads, the order of draws, the pieces of a scan, or other draws.
 *
 * Source: Philox4x32-10 (Salmon et al., SC'11), written out for SIMD loops.
 * Differs: doubles are odd multiples of 2^-53, so they are never 0 or 1.
 * Valid: all seeds, beams and indices; with a revolution, index < 2^52 and purpose < 4096.
 * Test: TestRandom.cxx (comparison with the authors' library Random123).
 */
#ifndef avianlidar_Random_h
#define avianlidar_Random_h

#include "LaneMath.h"

#include <array>
#include <cstdint>

namespace avianlidar
{
/// Purpose of a random number. Each purpose has its own stream. Values of former purposes are not
/// used again.
enum class RandomPurpose : std::uint32_t
{
  Rays = 0,
  Connections = 1,
  Noise = 2,
  FalseAlarms = 3,
  Patterns = 6,       ///< rays of a pattern that beams share; `beam` is the number of the pattern
  Turns = 7,          ///< pattern of a beam, and the turn of this pattern
  MastSway = 9,       ///< mast sway; `beam` is the axis
  EncoderJitter = 10, ///< encoder jitter; `beam` is the column
  Flights = 11,       ///< flights of birds; `beam` is the number of the bird
  FlockPlaces = 12,   ///< place of a bird in its flock; `beam` is the number of the bird
  RareNoise = 13,     ///< range units with a rare deviate
  Cells = 14,         ///< cells of jittered rays; `beam` is the number of the pattern
  Mirrors = 15,       ///< rays of mirror paths (MirrorRegions.h)
  RangeNoise = 16,    ///< noise of a return's range, by the return's strongest range unit
  Drops = 17,         ///< drops, by range unit
  Leaves = 18,        ///< leaves at which parts of a beam end
  ShortPaths = 19,    ///< directions of paths from a hit to a near hit
  Lobes = 20,         ///< directions of light from a mirror of finite lobe
  Waveforms = 21      ///< noise in the samples of a range unit
};

/// Two independent uniform doubles of 53 bits in the open interval (0, 1). @param seed any int
/// @param beam id of the beam @param index number of the ray, range unit or draw
std::array<double, 2> uniformPair(
  std::int32_t seed, std::uint64_t beam, std::uint64_t index, RandomPurpose purpose);

/// Two independent uniform doubles in (0, 1) that differ between revolutions of the sensor.
/// Revolution 0 has the stream of the function without revolution.
/// @param index number below 2^52 @param purpose purpose below 4096
std::array<double, 2> uniformPair(std::int32_t seed, std::uint64_t beam, std::uint64_t index,
  RandomPurpose purpose, std::int32_t revolution);

namespace lanes
{
/// Uniform double in (0, 1) from 52 of the 64 bits and a last bit of 1. The result u is an odd
/// multiple of 2^-53, so 1 - u is as exact as u.
AVIANLIDAR_ALWAYS_INLINE double openInterval(std::uint32_t low, std::uint32_t high)
{
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32) | low;
  const double whole = fromBits((bits >> 12) | 0x4330000000000000u) - 4503599627370496.0;
  return (whole + 0.5) * 0x1p-52;
}

/// avianlidar::uniformPair() for a loop over lanes.
AVIANLIDAR_ALWAYS_INLINE void uniformPair(std::int32_t seed, std::uint64_t beam,
  std::uint64_t index, RandomPurpose purpose, double& first, double& second)
{
  std::uint32_t a = static_cast<std::uint32_t>(beam);
  std::uint32_t b = static_cast<std::uint32_t>(beam >> 32);
  std::uint32_t c = static_cast<std::uint32_t>(index);
  std::uint32_t d = static_cast<std::uint32_t>(index >> 32);
  std::uint32_t key0 = static_cast<std::uint32_t>(seed);
  std::uint32_t key1 = static_cast<std::uint32_t>(purpose);
  for (int round = 0; round < 10; ++round)
  {
    const std::uint64_t one = std::uint64_t{ 0xD2511F53u } * a;
    const std::uint64_t two = std::uint64_t{ 0xCD9E8D57u } * c;
    a = static_cast<std::uint32_t>(two >> 32) ^ b ^ key0;
    c = static_cast<std::uint32_t>(one >> 32) ^ d ^ key1;
    b = static_cast<std::uint32_t>(two);
    d = static_cast<std::uint32_t>(one);
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  first = openInterval(a, b);
  second = openInterval(c, d);
}
}
}

#endif
