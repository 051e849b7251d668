// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EchoLabels.h
 * @brief What the paths with a share in a return say of its surfaces: object and material of the
 * largest share of the energy, mean angle of incidence, share that came over two reflections.
 */
#ifndef avianlidar_EchoLabels_h
#define avianlidar_EchoLabels_h

#include "BeamSamples.h"
#include "LabelSums.h"
#include "RangeUnits.h"
#include "ScanSetup.h"
#include "SecondaryReflection.h"

#include <vector>

namespace avianlidar
{
/// One return of one beam.
struct Echo
{
  double range = 0.0;          ///< m along the axis
  double energyReceived = 0.0; ///< J, Qrec of the strongest unit (Eq. 10)
  double energy = 0.0;         ///< J, Qen of the strongest unit (Eq. 12)
  double returnEnergy = 0.0;   ///< J, sum of Qrec over the return
  double energyStdError = 0.0; ///< J, of energyReceived; NaN for N = 1
  int returnNumber = 1;
  int numberOfReturns = 1;
  int objectId = -1; ///< of the largest share of the paths' energy; -1 for a false alarm
  int materialId = -1;
  double labelShare = 0.0; ///< that share
  double incidenceAngle =
    0.0; ///< rad, energy-weighted mean at the last surface; NaN for a false alarm
  double secondaryShare = 0.0; ///< share of the energy that came over two reflections
};

/// Reusable without allocation; one per thread. A share costs some ns.
class EchoLabels
{
public:
  /// The setup must outlive it.
  explicit EchoLabels(const ScanSetup& setup)
    : Setup(setup)
  {
  }

  /// Fill in the labels of an echo. @param samples of the beam; null without any @param paths of
  /// the beam over two reflections, whose contributions come after those of the samples
  void label(const RangeShares& shares, const BeamSamples* samples,
    const std::vector<SecondaryPath>& paths, Echo& echo);

private:
  void findAngles(
    const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths);
  bool meetsOneThing(const BeamSamples& samples, const std::vector<SecondaryPath>& paths) const;
  void findLargest(
    const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths);

  const ScanSetup& Setup;
  LabelSums Sums;
  std::vector<double> Angles; ///< rad, of incidence, by contribution
};
}

#endif
