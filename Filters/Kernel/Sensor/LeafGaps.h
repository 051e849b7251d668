// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LeafGaps.h
 * @brief Leaves that stop a narrow beam one by one: where its parts end, and what lies behind.
 *
 * A beam of area A meets leaves of projected area a as 1 + A/a parts would, each of which ends at
 * the first leaf that it meets, or passes. By the mean law a share T(R) of the light is left at R
 * (Beer and Lambert); a part with a random number u has ended where T(R) <= u. What leaves return
 * in a range unit, and what is seen behind them, is scaled by the parts that end there, or are
 * left, over their mean. Beams of many parts are not divided: drops of that number stand for them
 * (AirEcho.h).
 *
 * Source: the Boolean model of leaves at random places (Nilson, Agricultural Meteorology 8, 1971).
 * Differs: the paper has no leaves.
 * Valid: A is taken where the beam meets its first leaves. Means are those of the law.
 * Test: TestBeamAir.cxx.
 */
#ifndef avianlidar_LeafGaps_h
#define avianlidar_LeafGaps_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
class BeamAir;

class LeafGaps
{
public:
  /// Of a beam that meets none, or so many that they need not be told apart.
  void clear() { this->Parts.clear(); }

  /// Of a beam. @param along its air, which must live as long
  void begin(BeamAir& along, double solidAngle, std::int32_t seed, std::uint64_t beam,
    std::int32_t revolution);

  bool any() const { return !this->Parts.empty(); }

  /// Parts that go on at a range, m, over their mean.
  double openAt(double range) const;

  /// What leaves return between two ranges, m, over its mean.
  double returnedBetween(double from, double to) const;

  static constexpr double MostParts = 64.0;

private:
  /// The share T at which it ends, and what its leaf returns over the mean of leaves.
  std::vector<std::array<double, 2>> Parts;
  const BeamAir* Along = nullptr;
};
}

#endif
