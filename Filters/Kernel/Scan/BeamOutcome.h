// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamOutcome.h
 * @brief How far limits and air may change before a beam's echoes do.
 *
 * Lighting a beam takes decisions: which units are perceived, which paths the light-energy
 * constraint drops. Each holds for a range of Qlow, and where they all hold, the echoes are the
 * same numbers, whatever Qlow is. A beam without an echo stays without one, also in other air, as
 * long as what its strongest unit received, scaled by the most that any of its paths can gain, is
 * below Qlow. So a scan lit again looks at some numbers a beam, and lights those beams alone for
 * which they do not hold; all margins lie on the safe side, so that nothing is kept that a fresh
 * scan would not find.
 *
 * Valid without noise, and while all else is as it was: materials of what the beam meets, ids,
 * pulse, gate, settings. About 80 bytes a beam that meets something.
 */
#ifndef avianlidar_BeamOutcome_h
#define avianlidar_BeamOutcome_h

#include "ScanSetup.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace avianlidar
{
/// What is compared is rounded differently.
constexpr double SurelyBelow = 1.0 - 1e-9;

/// J: more than all paths of a beam together can carry of which nothing, or only the first digits,
/// is left as a number. Clearer air may bring them back.
constexpr double LostInUnderflow = 1e-290;

/// Values of Qlow, J, for which a decision holds: [from, to).
struct LimitWindow
{
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
  void atLeast(double limit) { this->from = limit > this->from ? limit : this->from; }
  void below(double limit) { this->to = limit < this->to ? limit : this->to; }
  bool contains(double limit) const { return limit >= this->from && limit < this->to; }
};

/// Air and limits of a scan, and what follows from them for every beam.
struct LimitsAndAir
{
  double lower;         ///< Qlow, J
  double attenuation;   ///< 1/m
  double pathThreshold; ///< J: the light-energy constraint drops paths below it; 0 without it
};

struct BeamOutcome
{
  std::size_t firstEcho = 0; ///< among the echoes of the scan
  std::uint32_t echoes = 0;  ///< of the beam
  double attenuation = 0.0;  ///< 1/m, of the air in which it was lit
  LimitWindow window;        ///< of a beam with echoes
  double loudest = 0.0;      ///< J: with echoes, Qrec of the strongest return; without, a bound of
                             ///< what any one unit can have received
  double surest = 0.0;       ///< J, a direct path that arrives inside the gate, or any if none can:
                             ///< while it is not dropped, the report says the same
  double shortest = 0.0;     ///< m, way out and back of all paths
  double longest = 0.0;      ///< m

  /// True if the beam's echoes (but for `energy`, which Qhigh cuts) are what they were.
  bool holds(const LimitsAndAir& now) const;

  /// Of a beam without echoes that holds, the most that one unit can receive now, J.
  double loudestIn(double attenuation) const;
};

/// What outcomes depend on besides the geometry of beams, their materials, limits and air.
struct Circumstances
{
  std::array<double, 9> values{};
  SharedVector<int> objectIds;
  SharedVector<int> materialIds;

  Circumstances() = default;
  explicit Circumstances(const ScanSetup& setup);
  bool areThoseOf(const ScanSetup& setup) const;
};

/// What the run before found, if its result is still at hand.
struct ScanMemory
{
  std::uint64_t run = 0;             ///< number of the run; 0: nothing to go on from
  std::vector<std::uint32_t> lit;    ///< beams that meet something
  std::vector<BeamOutcome> outcomes; ///< theirs
  Circumstances circumstances;
  double smallestTarget = 0.0;   ///< of its needs
  double perceivableRange = 0.0; ///< m, likewise
  double attenuation = 0.0;      ///< 1/m
  std::size_t held = 0;          ///< bytes, by what is known of beams
  std::size_t resultBytes = 0;   ///< of the result that is kept for the next run

  std::size_t bytes() const
  {
    return this->resultBytes + this->lit.capacity() * sizeof(std::uint32_t) +
      this->outcomes.capacity() * sizeof(BeamOutcome);
  }
};
}

#endif
