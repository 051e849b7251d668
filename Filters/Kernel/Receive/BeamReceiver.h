// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamReceiver.h
 * @brief Makes returns from the energies in range units.
 *
 * Energies are sums over paths (RangeUnits.h) plus noise (BeamNoise.h), limited to the dynamic
 * range. A **return** is a maximal run of consecutive perceived range units. For the ranges of
 * returns see ReturnRanges.h.
 *
 * Where the air scatters (AirLight.h), each unit receives light from the air. If the threshold
 * follows the air, the receiver subtracts the mean n_air of this light. The threshold is then as
 * many standard deviations of the noise as without air: n_T (1 + F n_air/sigma0^2)^(1/2)
 * (PhotonReceiver.h). So every unit has the same probability of a false alarm. Echoes of surfaces,
 * and light of drops above the mean, remain. With a fixed threshold the receiver subtracts nothing.
 * All light counts for saturation with either threshold. No threshold follows the leaves of trees:
 * light from leaves is treated like light from surfaces. Behind a surface the light of the air is
 * reduced by the share of the pulse that the surface has met.
 *
 * Source: paper, Sec. 2.4, Eq. 10-12.
 * Differs: ReturnMode::RangeUnits follows the paper literally, with a point at the centre of each
 * perceived range unit.
 * Valid: a range unit is c tau_s/2 long.
 * Test: TestReceiver.cxx.
 */
#ifndef avianlidar_BeamReceiver_h
#define avianlidar_BeamReceiver_h

#include "AirLight.h"
#include "BeamLight.h"
#include "BeamNoise.h"
#include "Drops.h"
#include "EchoSettings.h"
#include "LeafGaps.h"
#include "PhotonReceiver.h"
#include "RangeErrors.h"
#include "Received.h"
#include "ReturnRanges.h"
#include "Sensor.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace avianlidar
{
/// Energy that the receiver perceives (paper, Eq. 12), J: 0 for received <= lower, and at most
/// upper. The limits may be equal.
double perceivedEnergy(double received, double lower, double upper);

/// Receives one beam after the other. Each thread needs its own object.
class BeamReceiver
{
public:
  /// @param air media of the scan; must outlive the object
  /// @param wanted function called every 512 units for which noise is drawn, counted over all
  /// beams; WorkStopped is thrown if it returns false
  BeamReceiver(const Sensor& sensor, const NoisePlan& noise, std::int32_t seed, ReturnMode mode,
    const ScanAir& air, std::int32_t revolution = 0, std::function<bool()> wanted = {});

  /// Receive the light of a beam. @param air, leaves air along the beam, and leaves drawn in it
  Received receive(
    std::uint64_t beam, const ArrivingLight& light, const BeamAir& air, const DrawnLeaves& leaves);

  /// True if units without paths may be perceived in any beam. In this case no beam can be left
  /// out.
  bool mayAlarm() const { return this->Sky.plan.active || this->Scan.fillsScene(); }

  /// Limits, noise and errors of ranges in a background.
  struct Exposure
  {
    Exposure(const Sensor& sensor, const NoisePlan& noise);

    double radiance;
    double lower, upper; ///< limits, J
    NoisePlan plan;
    RangeErrors errors;
    PhotonReceiver photons;
  };
  /// Exposure to a background. @param radiance spectral radiance, W/(m2 sr nm)
  const Exposure& exposureTo(double radiance);

  /// Lower limit of a unit, J. @param air mean energy that the air returns in the unit, J
  double lowerIn(const Exposure& exposure, double air) const
  {
    return this->FollowsAir
      ? exposure.lower * exposure.photons.growthInAir(exposure.photons.electronsPerJoule * air)
      : exposure.lower;
  }

private:
  /// Reception of one beam.
  class Reception;

  void planAir();
  double varianceWith(const Exposure& exposure, const std::vector<AirLight::Share>& shares) const;
  const Sensor Instrument;
  const ScanAir& Scan;
  const double UnitLength;
  const bool FollowsAir;
  const std::int32_t Seed;
  const std::int32_t Revolution;
  const ReturnMode Mode;
  const ReturnRanges Ranges;
  const std::function<bool()> Wanted;
  const PulseShares Pulse;
  const Exposure Sky;            ///< exposure to the sensor's background
  std::optional<Exposure> Other; ///< exposure to the last other background
  std::int64_t Looked = 0;       ///< number of units in which the air alone may be perceived
  std::uint64_t Drawn = 0;       ///< number of units for which noise was drawn
  // Memory that receptions use in turn.
  AirLight Light;
  SharedDrops Drops; ///< light of drops, divided among range units
  BeamNoise Noise;
};
}

#endif
