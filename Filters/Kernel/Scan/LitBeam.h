// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LitBeam.h
 * @brief The part of a beam's light that is kept, with known returns, for scans that have the same
 * beams and differ only in noise, or in movers that touch other beams.
 *
 * The units that form a return depend on noise. Range, labels and standard error of a return follow
 * from its first, last and strongest unit. The values of the first MostReturns returns with
 * different units are kept. For any other return the beam is lit again.
 *
 * Source: none.
 * Valid: for one lightKey() and the samples of one trace. Echoes are bitwise identical with and
 * without a LitBeam.
 * Test: TestScanAgain.cxx.
 */
#ifndef avianlidar_LitBeam_h
#define avianlidar_LitBeam_h

#include "BeamEchoes.h"
#include "BeamLight.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct LitBeam
{
  static constexpr std::size_t MostReturns = 16;

  std::vector<RangeUnit> units;
  std::vector<LightEcho> returns;   ///< known returns
  std::vector<MetSurface> surfaces; ///< samples of surfaces, which shadow the air
  double radiance;                  ///< BeamLight::radiance, W/(m2 sr nm)
  bool outsideGate;                 ///< BeamLight::isOutsideGate()
  double lost;                      ///< BeamReport::lost, J
  std::uint32_t skipped;            ///< BeamReport::skipped

  explicit LitBeam(const BeamLight& light)
    : units(light.units.units())
    , surfaces(light.surfaces)
    , radiance(light.radiance)
    , outsideGate(light.isOutsideGate())
    , lost(light.lost)
    , skipped(light.skipped)
  {
  }

  /// Keep returns that are not known yet.
  void add(const std::vector<LightEcho>& found);

  /// True if all returns with light are known.
  bool knows(const Received& received) const;

  ArrivingLight arriving() const { return { this->units, this->surfaces, this->radiance }; }

  std::size_t bytes() const
  {
    return sizeof(LitBeam) + this->units.capacity() * sizeof(RangeUnit) +
      this->returns.capacity() * sizeof(LightEcho) + this->surfaces.capacity() * sizeof(MetSurface);
  }
};

/// Checksum of all inputs, besides a trace, on which energies in range units and labels depend.
std::uint64_t lightKey(const ScanSetup& setup);
}

#endif
