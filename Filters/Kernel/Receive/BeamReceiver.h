// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamReceiver.h
 * @brief Makes returns from the energies in range units.
 *
 * Energies are sums over paths (RangeUnits.h) plus noise (BeamNoise.h), limited to the dynamic
 * range. A
 * **return** is a maximal run of consecutive perceived range units. The range of a return is the
 * mean range (half the path length) of its paths, weighted with the energies that these paths put
 * into the run. A run of false alarms has no paths. In each unit of such a run the noise has a
 * random place (BeamNoise::place()). The range of the return is then the mean of these places,
 * weighted with the energies of the units.
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
 * Valid: on a plane at any tilt the range of a return differs from the range on the axis by at most
 * theta0.5^2/4, relative. A range unit is c tau_s/2 long.
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
#include "RangeShares.h"
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

/// A range unit with its noise.
struct ReceivedUnit
{
  std::int64_t index = 0;  ///< number m of the range unit
  double energy = 0.0;     ///< energy Qrec, noise included, J
  double noise = 0.0;      ///< energy Qn of the noise, J
  std::uint32_t paths = 0; ///< number of paths with a share; 0: a false alarm, or only air
  double air = 0.0;        ///< part of `energy` from air that a threshold may follow, J
  double leaves = 0.0;     ///< part of `energy` from media that no threshold follows, J
  int medium = -1;         ///< object id of the medium with the largest part of `leaves`
  double lower = 0.0;      ///< lower limit of this unit, J
  double upper = 0.0;      ///< upper limit of this unit, J
};

struct Return
{
  std::size_t firstUnit = 0; ///< units [firstUnit, lastUnit) of Received::units
  std::size_t lastUnit = 0;
  std::size_t strongestUnit = 0; ///< nearest unit with the largest Qrec
  double energyReceived = 0.0;   ///< Qrec of the strongest unit (Eq. 10), J
  double energy = 0.0;           ///< Qen of the strongest unit (Eq. 12), J
  double returnEnergy = 0.0;     ///< sum of Qrec over the run, J
  bool hasLight = false;         ///< whether light of paths arrived; false: only noise or air
  double air = 0.0;              ///< sum of ReceivedUnit::air, J
  double leaves = 0.0;           ///< sum of ReceivedUnit::leaves, J
  int medium = -1;               ///< ReceivedUnit::medium of the unit with most `leaves`
  double rangeOfLeaves = 0.0;    ///< mean range of the light in `leaves`, m
  double range = 0.0;            ///< range, m, as defined by rangeOf()
  // returnNumber and numberOfReturns count all returns of the beam, before ReturnMode selects.
  int returnNumber = 1;    ///< number of the return, from 1, nearest first
  int numberOfReturns = 1; ///< number of returns of the beam
};

/// What the receiver makes of the light in one beam.
struct Received
{
  NoiseKey key;    ///< key of the beam's random numbers
  double radiance; ///< spectral radiance in the beam, W/(m2 sr nm)
  /// Units with light or false alarms, ascending, perceived or not. A unit that is perceived only
  /// with rare noise is left out unless it has rare noise.
  std::vector<ReceivedUnit> units;
  std::vector<Return> returns;     ///< the returns that the mode selects, nearest first
  std::optional<Return> strongest; ///< the strongest return of the beam, in every mode
};

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

  /// Range of a return, m. For returns without light, and for all returns in the mode RangeUnits,
  /// the result is Return::range. @param shares shares of the beam's paths in the return's units
  /// @param lengths lengths of these paths, m
  double rangeOf(const Received& received, const Return& run, const RangeShares& shares,
    const std::vector<double>& lengths) const;

  /// The range that the receiver reports for a return at `range`, m: with noise, walk and quantum
  /// (RangeErrors.h), or `range` unchanged in the mode RangeUnits.
  double measured(const Received& received, const Return& run, double range);

  /// True if units without paths may be perceived in any beam. In this case no beam can be left
  /// out.
  bool mayAlarm() const { return this->Sky.plan.active || this->Scan.fillsScene(); }

private:
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
  /// Reception of one beam.
  class Reception;

  const Exposure& exposureTo(double radiance);
  void planAir();
  double varianceWith(const Exposure& exposure, const std::vector<AirLight::Share>& shares) const;
  double rangeOfNoise(const Received& received, const Return& run) const;
  double placeIn(std::int64_t unit, double place) const;

  const Sensor Instrument;
  const ScanAir& Scan;
  const double UnitLength;
  const bool FollowsAir;
  const std::int32_t Seed;
  const std::int32_t Revolution;
  const ReturnMode Mode;
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
