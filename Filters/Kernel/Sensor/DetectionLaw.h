// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DetectionLaw.h
 * @brief The probability that a target is detected in one scan, as a function of the energy that
 * one beam receives of it and of the number of beams that do.
 *
 * The pulse is shared by the range units that it overlaps; where in a unit it lies is uniform over
 * the targets' ranges and the same for all beams, as they begin at one point. A beam detects the
 * target if one of its units is perceived: with a photon receiver with the probability of
 * PhotonReceiver.h, otherwise if the energy exceeds Qlow. Noise is independent from pulse to pulse,
 * while the target shows the same area to all beams of a scan. So the probability is the mean over
 * areas and places in the unit of 1 - (1 - p)^K, K the number of beams. It is tabulated over the
 * logarithm of the energy.
 *
 * Source: none.
 * Differs: the paper perceives what exceeds Qlow in a unit at the target's own range.
 * Valid: 1 to MostBeams beams (more count as so many). Off by less than 3e-4 with a photon
 * receiver; without noise the step of one area lies within 0.8 % of its energy.
 * Test: TestDetectionLaw.cxx.
 */
#ifndef avianlidar_DetectionLaw_h
#define avianlidar_DetectionLaw_h

#include "Sensor.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
class DetectionLaw
{
public:
  static constexpr int MostBeams = 64;

  /// @param sensor with its limits set @param areas of the target, relative to their mean, equally
  /// likely; not empty, above 0
  DetectionLaw(const Sensor& sensor, const std::vector<double>& areas);

  /// Probability of detection in one scan. @param energy that one beam receives of the target at
  /// its mean area, J @param beams that receive it
  double probability(double energy, int beams) const;

  /// The least energy, J, at which it is `wanted`; infinity if it never is. @param wanted above 0
  double energyFor(double wanted, int beams) const;

private:
  static constexpr std::size_t PointsPerDecade = 300;
  static constexpr double FirstDecade = -3.0; ///< of energies over Qlow
  static constexpr std::size_t Decades = 7;
  static constexpr std::size_t Points = Decades * PointsPerDecade + 1;

  std::vector<double> Table; ///< by number of beams, then energy
  double Limit;              ///< Qlow, J
};

/// Probability that at least `needed` of `scans` scans detect a target, each with probability `p`.
/// @param needed 1 to scans
double trackProbability(double p, int needed, int scans);
}

#endif
