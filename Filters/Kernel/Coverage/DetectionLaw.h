// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DetectionLaw.h
 * @brief The probability that a target is detected in one scan, as a function of the energy that
 * one beam receives of it and of the number of beams that do.
 *
 * A beam receives the energy of the part of the target that it lights (Silhouette.h), whatever is
 * larger, beam or target. The echo, a pulse as wide as that part is deep, is shared by the range
 * units that it overlaps; where in a unit the target lies is uniform over its ranges and the same
 * for all beams, as they begin at one point. The depth is taken as a normal distribution about the
 * mean of that part. A beam detects the target if one of its units is perceived: with a photon
 * receiver with the probability of PhotonReceiver.h, otherwise if the energy exceeds Qlow. Noise is
 * independent from pulse to pulse, while the target is the same for all beams of a scan. So the
 * probability is the mean over poses and places in the unit of 1 - product of (1 - p) over beams.
 * Where K beams hold all of the target, it is tabulated over the logarithm of the energy.
 *
 * What a target shows depends on the elevation of the line of sight. It is drawn for some of them;
 * between two each pose takes that of one or of the other, as many as a linear interpolation would.
 *
 * A pose stands for those around it: its energies are spread by 15 %.
 *
 * Source: none.
 * Differs: the paper perceives what exceeds Qlow in a unit at the target's own range.
 * Valid: 1 to MostBeams beams (more count as so many, or as the most that are asked for). Off by
 * less than 3e-4 with a photon receiver where beams hold all of the target; without noise the step
 * of one area lies within 0.8 % of its energy.
 * Test: TestDetectionLaw.cxx.
 */
#ifndef avianlidar_DetectionLaw_h
#define avianlidar_DetectionLaw_h

#include "Silhouette.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace avianlidar
{
/// What a target shows of itself: one of equally likely poses.
using TargetPoses = std::vector<Silhouette>;

/// What a target shows in all directions.
struct TargetViews
{
  /// Poses from an elevation of the line of sight, rad, positive where the target is above the
  /// sensor: from every one as many, in the same order, their areas relative to a mean of all.
  std::function<TargetPoses(double elevation)> from;
  double reach = 0.0;    ///< m, from the middle; nothing lies beyond
  double step = Pi;      ///< rad, between the elevations that are looked at
  std::size_t poses = 1; ///< how many there are
  /// Poses that follow each other differ by so many of a whole turn, clockwise; 1: all look alike
  /// from all azimuths.
  std::size_t headings = 1;
};

/// A target that is the same from all elevations.
TargetViews viewsOf(TargetPoses poses, double reach = 0.0);

class DetectionLaw
{
public:
  static constexpr int MostBeams = 64;

  /// @param sensor with its limits set @param lowest @param highest elevations at which it will be
  /// asked for, rad; beyond them the nearest counts @param mostBeams that are asked for, 1 to
  /// MostBeams
  DetectionLaw(const Sensor& sensor, const TargetViews& views, double lowest = 0.0,
    double highest = 0.0, int mostBeams = MostBeams);

  /// Where an elevation, rad, lies between those that were looked at.
  struct Between
  {
    std::size_t below; ///< number of the lower one
    double share;      ///< of the next one, 0 to 1
  };
  Between betweenAt(double elevation) const;

  /// Probability of detection in one scan. @param energy that one beam receives of the target at
  /// its mean area, J @param beams that receive it
  double probability(double energy, int beams, const Between& at = { 0, 0.0 }) const
  {
    return energy > 0.0 ? this->probabilityAt(this->stepOf(energy), beams, at) : 0.0;
  }

  /// Where an energy, J, above 0, lies in the tables, in steps.
  double stepOf(double energy) const;

  /// The probability of an energy that lies there.
  double probabilityAt(double step, int beams, const Between& at = { 0, 0.0 }) const;

  /// The same where beams light parts of the target. @param energy that a beam that holds all of
  /// the target's mean area receives, J @param most that a beam receives which the target fills, J
  /// @param ofPoses takes the probability of each pose; may be null
  double probability(double energy, double most, const BeamAtTarget* beams, std::size_t count,
    const Between& at = { 0, 0.0 }, double* ofPoses = nullptr) const;

  /// The same of each pose where so many beams hold all of it.
  void ofPoses(double energy, int beams, const Between& at, double* probabilities) const;

  /// m: a beam farther from the target has no part of it.
  double reach() const { return this->Reach; }

  std::size_t poses() const { return this->Views[0].size(); }

  /// The beams of tables: more count as so many.
  int mostBeams() const { return this->Most; }

  /// The least energy, J, at which it is `wanted`; infinity if it never is. @param wanted above 0
  /// @param view number of an elevation that was looked at
  double energyFor(double wanted, int beams, std::size_t view = 0) const;

  std::size_t views() const { return this->Views.size(); }

private:
  static constexpr std::size_t PointsPerDecade = 300;
  static constexpr double FirstDecade = -3.0; ///< of energies over Qlow
  static constexpr std::size_t Decades = 7;
  static constexpr std::size_t Points = Decades * PointsPerDecade + 1;

  /// A beam that may detect a pose.
  struct Received
  {
    double step;        ///< of its energy
    std::size_t spread; ///< class of depths
    double depth;       ///< units behind the target's middle
  };
  Received received(double energy, const LitPart& lit) const;
  double spreadAt(std::size_t quantile) const;
  double missed(const Received& beam, double place, double shift) const;
  double detected(
    const Received* parts, std::size_t count, const Received& all, std::size_t whole) const;
  std::size_t viewOf(std::size_t pose, const Between& at) const;
  void tabulate(const TargetPoses& poses);

  int Most;                       ///< beams
  double Limit;                   ///< Qlow, J
  double UnitLength;              ///< m
  double Reach;                   ///< m
  double Deepest;                 ///< m, standard deviation of the last class of depths
  double Lowest;                  ///< elevation of the first view, rad
  double Step;                    ///< to the next one
  std::vector<TargetPoses> Views; ///< by elevation
  /// Of each pose, by elevation: what a beam that holds all of it receives at an energy of 1 J.
  std::vector<std::vector<Received>> Whole;
  std::vector<double> Thresholds; ///< of each pose: from this share on it takes the next elevation
  /// Probability that a beam perceives nothing: by class of depths, place in the unit, energy.
  std::vector<std::vector<std::vector<double>>> Missed;
  std::vector<std::vector<double>> Tables; ///< by elevation; number of beams, then energy
};

constexpr int MostScans = 100;

/// Probability that at least `needed` of `scans` scans detect a target, each with probability `p`.
/// @param needed 1 to scans @param scans 1 to MostScans
double trackProbability(double p, int needed, int scans);
}

#endif
