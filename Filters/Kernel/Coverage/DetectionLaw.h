// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DetectionLaw.h
 * @brief The probability that a target is detected in one scan, as a function of the energy that
 * one beam receives of it and of the number of beams that do.
 *
 * The echo, a pulse as wide as the target is deep, is shared by the range units that it overlaps;
 * where in a unit it lies is uniform over the targets' ranges and the same for all beams, as they
 * begin at one point. The target's depth is taken as a normal distribution for each pose. A beam
 * detects the target if one of its units is perceived: with a photon receiver with the probability
 * of PhotonReceiver.h, otherwise if the energy exceeds Qlow. Noise is independent from pulse to
 * pulse, while the target shows the same area to all beams of a scan. So the probability is the
 * mean over poses and places in the unit of 1 - (1 - p)^K, K the number of beams. It is tabulated
 * over the logarithm of the energy. Where borders of beams cross the target, each beam has a share
 * of it: the target's place across the line of sight is taken as a normal distribution for each
 * pose, the beam as a disc.
 *
 * Source: none.
 * Differs: the paper perceives what exceeds Qlow in a unit at the target's own range.
 * Valid: 1 to MostBeams beams (more count as so many, or as the most that are asked for). Off by
 * less than 3e-4 with a photon receiver, by 0.01 where beams hold shares; without noise the step of
 * one area lies within 0.8 % of its energy.
 * Test: TestDetectionLaw.cxx.
 */
#ifndef avianlidar_DetectionLaw_h
#define avianlidar_DetectionLaw_h

#include "Sensor.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
/// What a target shows of itself.
struct TargetPose
{
  double area;             ///< effective area, relative to the mean of all poses
  double horizontal = 0.0; ///< m, root mean square distance of the area from the target's middle
  double vertical = 0.0;   ///< m, likewise; both across the line of sight
  double depth = 0.0;      ///< m, likewise along it
};

/// A beam that may hold some of a target.
struct BeamAtTarget
{
  double radius;     ///< of the beam there, m
  double distance;   ///< from the beam's axis to the target's middle, m
  double horizontal; ///< share of the horizontal in that way: |sine| of its angle from the vertical
  double vertical;   ///< |cosine|
  double irradiance; ///< of the beam there, over that of a uniform beam
};

/// Share of a target that a beam holds: 0 to 1, off by less than 0.07.
double shareHeld(const BeamAtTarget& beam, const TargetPose& pose);

class DetectionLaw
{
public:
  static constexpr int MostBeams = 64;

  /// @param sensor with its limits set @param poses of the target, equally likely; not empty, areas
  /// above 0 @param mostBeams that are asked for, 1 to MostBeams
  DetectionLaw(
    const Sensor& sensor, const std::vector<TargetPose>& poses, int mostBeams = MostBeams);

  /// Probability of detection in one scan. @param energy that one beam receives of the target at
  /// its mean area, J @param beams that receive it
  double probability(double energy, int beams) const
  {
    return energy > 0.0 ? this->probabilityAt(this->stepOf(energy), beams) : 0.0;
  }

  /// Where an energy, J, above 0, lies in the tables, in steps.
  double stepOf(double energy) const;

  /// The probability of an energy that lies there.
  double probabilityAt(double step, int beams) const;

  /// The same where beams hold shares of the target. @param energy that a beam that holds all of
  /// the target's mean area receives, J @param most that a beam receives which the target fills, J
  double probability(
    double energy, double most, const BeamAtTarget* beams, std::size_t count) const;

  /// Distance, m, from which on outside a beam the target has no share in it, or inside lies all in
  /// it.
  double reach() const { return this->Reach; }

  /// The least energy, J, at which it is `wanted`; infinity if it never is. @param wanted above 0
  double energyFor(double wanted, int beams) const;

private:
  static constexpr std::size_t PointsPerDecade = 300;
  static constexpr double FirstDecade = -3.0; ///< of energies over Qlow
  static constexpr std::size_t Decades = 7;
  static constexpr std::size_t Points = Decades * PointsPerDecade + 1;

  int Most; ///< beams
  /// By one beam: by place in the unit, then energy.
  using MissedTable = std::vector<std::vector<double>>;

  double Reach; ///< m
  std::vector<TargetPose> Poses;
  std::vector<MissedTable> Missed;  ///< by class of depth
  std::vector<std::size_t> DepthOf; ///< class of each pose
  std::vector<double> Table;        ///< by number of beams, then energy
  double Limit;                     ///< Qlow, J
};

constexpr int MostScans = 100;

/// Probability that at least `needed` of `scans` scans detect a target, each with probability `p`.
/// @param needed 1 to scans @param scans 1 to MostScans
double trackProbability(double p, int needed, int scans);
}

#endif
