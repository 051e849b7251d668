// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LitBeam.h
 * @brief What is kept of a beam that was lit, for scans of the same beams that differ by noise or
 * by movers in other beams alone: energies in range units, and what is known of returns.
 *
 * Noise decides which units form a return. Range, labels and standard error of a return follow from
 * its first, last and strongest unit; they are kept for the first MostReturns that occur. For
 * others the beam is lit again.
 *
 * Source: none.
 * Valid: for one LightKey, and for the samples of the trace that it belongs to. Echoes have the
 * same bits with it and without.
 * Test: TestScanAgain.cxx.
 */
#ifndef avianlidar_LitBeam_h
#define avianlidar_LitBeam_h

#include "BeamAir.h"
#include "Echo.h"
#include "RangeUnits.h"
#include "ScanSetup.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct LitBeam
{
  static constexpr std::size_t MostReturns = 16;

  /// What does not depend on noise.
  struct KnownReturn
  {
    std::int64_t first, last, strongest; ///< units
    Echo echo;
  };
  std::vector<RangeUnit> units;
  std::vector<KnownReturn> returns;
  std::vector<MetSurface> surfaces; ///< that take of the air's light
  double radiance = 0.0;            ///< see BeamLighting::radiance()
  bool outsideGate = false;         ///< see BeamLighting::isOutsideGate()
  double lost = 0.0;                ///< J, see BeamReport
  std::uint32_t skipped = 0;        ///< see BeamReport

  std::size_t bytes() const
  {
    return sizeof(LitBeam) + this->units.capacity() * sizeof(RangeUnit) +
      this->returns.capacity() * sizeof(KnownReturn) +
      this->surfaces.capacity() * sizeof(MetSurface);
  }
};

/// Everything that energies in range units and labels depend on besides what a trace holds.
struct LightKey
{
  SharedVector<Material> materials;
  SharedVector<int> objectIds;
  SharedVector<int> materialIds;
  std::uint64_t numbers = 0; ///< hash of all others
};

/// Take over a setup. @return false if anything differs
bool takeOver(LightKey& key, const ScanSetup& setup);
}

#endif
