// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DetectionLaw.h
 * @brief Probability that one scan detects a target, as a function of the energy that a beam
 * receives from the target and of the number of beams on the target.
 *
 * A beam receives energy from the part of the target that the beam lights (Silhouette.h), whether
 * the beam or the target is larger. The echo is a pulse that is lengthened by the depth of this
 * part. Depths are taken as normally distributed. The range units that the echo overlaps share its
 * energy. The position of the target within a range unit is uniformly distributed and the same for
 * all beams, because all beams have one origin. A beam detects the target if the beam perceives a
 * unit that the echo overlaps. A photon receiver perceives a unit with the probability of
 * PhotonReceiver.h. Any other receiver perceives a unit if the unit's energy exceeds Qlow. Noise is
 * independent from pulse to pulse, while the pose is the same for all beams of a scan. The
 * probability is therefore the mean, over poses and positions in the unit, of 1 - product of (1 -
 * p) over beams, with p the probability that one beam detects the target. Where K beams contain the
 * whole target, the probability is tabulated over the logarithm of the energy.
 *
 * The silhouette of a target depends on the elevation of the line of sight. Silhouettes are drawn
 * at regular steps of elevation. Between two steps, some poses are taken from the lower step and
 * the other poses from the upper step. The share of the upper step grows linearly with the
 * elevation.
 *
 * Each pose represents similar poses, so the energies of a pose are spread with a standard
 * deviation of 15 %.
 *
 * Source: none.
 * Differs: in the paper only the unit at the target's own range counts. This unit is perceived if
 * its energy exceeds Qlow.
 * Valid: 1 to MostBeams beams (more beams count as MostBeams, or as the largest number in the
 * tables). The error of the probability is below 3e-4 with a photon receiver where beams contain
 * the whole target. Without noise, the energy at which the probability for one area steps from 0 to
 * 1 is right to 0.8 %.
 * Test: TestDetectionLaw.cxx.
 */
#ifndef avianlidar_DetectionLaw_h
#define avianlidar_DetectionLaw_h

#include "Silhouette.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Silhouettes of a target in equally likely poses.
using TargetPoses = std::vector<Silhouette>;

/// Silhouettes that several laws share.
using SharedPoses = std::shared_ptr<const TargetPoses>;

/// Silhouettes of a target from all directions.
struct TargetViews
{
  /// Function that returns the poses at an elevation of the line of sight, rad, positive if the
  /// target is above the sensor. Each elevation has the same poses in the same order. Areas are
  /// relative to one mean over all poses.
  std::function<SharedPoses(double elevation)> from;
  double reach = 0.0;    ///< largest distance of any part from the middle, m
  double step = Pi;      ///< step between the elevations that are drawn, rad
  std::size_t poses = 1; ///< number of poses
  /// Number of headings; 1 if all azimuths give the same silhouettes. Successive poses differ by
  /// 1/headings of a turn, clockwise.
  std::size_t headings = 1;
};

/// Views of a target that has the same silhouettes from all elevations.
TargetViews viewsOf(TargetPoses poses, double reach = 0.0);

class DetectionLaw
{
public:
  static constexpr int MostBeams = 128;

  /// @param sensor sensor whose limits are set
  /// @param lowest, highest elevations of the line of sight, rad; an elevation outside [lowest,
  /// highest] counts as the nearer end
  /// @param mostBeams largest number of beams in the tables, 1 to MostBeams
  DetectionLaw(const Sensor& sensor, const TargetViews& views, double lowest = 0.0,
    double highest = 0.0, int mostBeams = MostBeams);

  /// Position of an elevation between two views.
  struct Between
  {
    std::size_t below; ///< index of the lower view
    double share;      ///< weight of the next view, 0 to 1
  };
  Between betweenAt(double elevation) const;

  /// Probability of detection in one scan.
  /// @param energy energy that one beam receives from the target at its mean area, J
  /// @param beams number of beams that receive this energy
  double probability(double energy, int beams, const Between& at = { 0, 0.0 }) const
  {
    return energy > 0.0 ? this->probabilityAt(this->stepOf(energy), beams, at) : 0.0;
  }

  /// Position of an energy in the tables, in steps. @param energy energy, J, above 0
  double stepOf(double energy) const;

  /// Probability of detection at a position in the tables. @param step position, from stepOf()
  double probabilityAt(double step, int beams, const Between& at = { 0, 0.0 }) const;

  /// Probability of detection where beams light parts of the target.
  /// @param energy energy that a beam receives if it contains the whole target at its mean area, J
  /// @param most energy that a beam receives if the target fills the beam, J
  /// @param ofPoses receives the probability of each pose; may be null
  double probability(double energy, double most, const BeamAtTarget* beams, std::size_t count,
    const Between& at = { 0, 0.0 }, double* ofPoses = nullptr) const;

  /// Probability of detection of each pose where `beams` beams contain the whole target.
  void ofPoses(double energy, int beams, const Between& at, double* probabilities) const;

  /// Distance, m, from a beam's border to the target's middle beyond which the beam lights no part
  /// of the target.
  double reach() const { return this->Reach; }

  std::size_t poses() const { return this->Views[0]->size(); }

  std::size_t headings() const { return this->Headings; } ///< value of TargetViews::headings

  /// Memory of tables and silhouettes, bytes.
  std::size_t bytes() const;

  /// Largest number of beams in the tables; more beams count as this number.
  int mostBeams() const { return this->Most; }

  /// Least energy at which the probability is `wanted`, J; infinity if no energy reaches this
  /// probability.
  /// @param wanted probability, above 0 @param view index of an elevation
  double energyFor(double wanted, int beams, std::size_t view = 0) const;

  std::size_t views() const { return this->Views.size(); }

private:
  static constexpr std::size_t PointsPerDecade = 300;
  static constexpr double FirstDecade = -3.0; ///< log10 of the first energy divided by Qlow
  static constexpr std::size_t Decades = 7;
  static constexpr std::size_t Points = Decades * PointsPerDecade + 1;
  /// Positions in a whole range unit where beams light parts: every fifth of the positions in a
  /// unit.
  static constexpr int PlacesOfParts = 8;

  /// Light that a beam receives from a pose.
  struct Received
  {
    double step;        ///< position of the light's energy in the tables
    std::size_t spread; ///< depth class
    double depth;       ///< mean depth behind the target's middle, range units
  };
  Received received(double energy, const LitPart& lit) const;
  double spreadAt(std::size_t quantile) const;
  /// A probability at each position of the target in a range unit.
  using ByPlace = std::array<double, PlacesOfParts>;
  ByPlace missed(const Received& beam) const;
  std::size_t viewOf(std::size_t pose, const Between& at) const;
  /// Probability that beams detect a target of a depth class, mean over positions; by beams and
  /// energy.
  std::vector<double> wholeTarget(std::size_t spread) const;
  void tabulate(const TargetPoses& poses, const std::vector<std::vector<double>>& wholeTargets);

  int Most;                       ///< largest number of beams in the tables
  double Limit;                   ///< Qlow, J
  double UnitLength;              ///< length of a range unit, m
  double Reach;                   ///< value of reach(), m
  double Deepest;                 ///< standard deviation of the last depth class, m
  double Lowest;                  ///< elevation of the first view, rad
  double Step;                    ///< step from one view to the next, rad
  std::size_t Headings;           ///< value of headings()
  std::vector<SharedPoses> Views; ///< poses by elevation
  /// Light that a beam receives from each whole pose at an energy of 1 J; by elevation, pose.
  std::vector<std::vector<Received>> Whole;
  std::vector<double> Thresholds; ///< share above which a pose is taken from the next view, by pose
  /// Probability that a beam perceives nothing, by depth class, position in the unit, energy.
  std::vector<float> Missed;
  int Places;                              ///< number of positions in half a unit
  std::vector<std::vector<double>> Tables; ///< probability by elevation; then beams and energy
};

constexpr int MostScans = 100;

/// Probability that at least `needed` of `scans` scans detect a target, each with probability `p`.
/// @param needed least number of scans, 1 to scans @param scans number of scans, 1 to MostScans
double trackProbability(double p, int needed, int scans);
}

#endif
