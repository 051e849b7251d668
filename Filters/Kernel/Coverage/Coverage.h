// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Coverage.h
 * @brief Computes in closed form, for each place, whether a small target, such as a bird, would be
 * detected, or why the target would not be detected. The target is not traced.
 *
 * A beam sees a place if its cone contains the direction to the place and if one descent of the
 * tree finds no surface that hides the place. A beam is in clutter at a place if a perceived echo
 * of a surface lies in a range unit that the echo of a point target at the place may overlap. All
 * other beams that see the place detect the target with the probability of DetectionLaw.h. The
 * probability depends on the part of the target that each beam lights. Lines of sight are found
 * once and remain valid for another target, air, receiver or clutter.
 *
 * Source: none.
 * Differs: a surface that hides the target's middle hides all of the target. Other surfaces hide
 * nothing.
 * Valid: beams of one origin. Media attenuate along the line to the target's middle. Moving media
 * are at their places at time 0. A beam does not light a target whose middle is more than
 * WidestTarget or 0.4 rad outside the beam's cone. If more than DetectionLaw::MostBeams beams are
 * near, a quarter of them are the beams with the nearest axes (the nearest borders if beams are not
 * round), and the others are drawn. If the threshold follows the air, energies are divided by the
 * growth of the threshold. Probabilities then err by up to 0.03.
 * Test: TestCoverage.cxx, TestCoverage.py, TestBeamShapes.py, TestWeather.py.
 */
#ifndef avianlidar_Coverage_h
#define avianlidar_Coverage_h

#include "BeamDirections.h"
#include "BeamShape.h"
#include "DetectionLaw.h"
#include "Scan.h"
#include "ScanAir.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace avianlidar
{
/// Reason why a target is not detected at a place: the first reason that applies.
enum class CoverageStatus : std::uint8_t
{
  OutsideGate = 0,
  AboveBand = 1,    ///< the place lies above all beams
  BelowBand = 2,    ///< the place lies below all beams
  BetweenBeams = 3, ///< no beam contains the place
  Shadowed = 4,     ///< a surface hides the place
  InClutter = 5,    ///< all beams that contain the place are in clutter there
  TooWeak = 6,      ///< the probability of detection is below WeakProbability
  Seen = 7
};

constexpr double WeakProbability = 0.1;

/// Largest distance from the middle of a target to any of its parts, m. Parts beyond this distance
/// are ignored. The widest bird that flies spans 3.5 m.
constexpr double WidestTarget = 2.0;

/// Visibility of a place, from geometry only.
struct CoverageSight
{
  CoverageStatus status = CoverageStatus::OutsideGate; ///< Seen if geometry allows detection
  bool isNear = false;    ///< true if a beam may light a target at the place
  bool isHidden = false;  ///< true if isNear and a surface hides the place
  std::uint8_t beams = 0; ///< number of beams that contain the place, at most 255
};

/// Detection of a target at a place.
struct CoverageValue
{
  CoverageStatus status = CoverageStatus::OutsideGate;
  int beams = 0;               ///< number of beams that contain the place
  double probability = 0.0;    ///< probability of detection in one scan
  double photoelectrons = 0.0; ///< photoelectrons of the whole target; 0 without a photon receiver
  /// Mean effective area at which half of the targets inside the beams are detected, m^2; infinity
  /// if no area suffices.
  double leastArea = std::numeric_limits<double>::infinity();
};

class Coverage;

/// A target as a sensor sees it through the air.
struct CoverageTarget
{
  double attenuation; ///< extinction coefficient, 1/m
  double area;        ///< mean effective area (silhouette weighted by cosine), m^2
  double reflectance; ///< 0 to 1
  /// Law of the sensor and the target's views, for the number and elevations of the beams.
  std::shared_ptr<const DetectionLaw> law;
};

/// Function that returns the position of a place, m, from the number of the place.
using PlaceAt = std::function<Vec3(std::size_t)>;

/// Computes the detection of targets at places. Setup and beams must outlive the object. Any number
/// of threads may share the object.
class Coverage
{
public:
  /// @param beams at least one beam, all from one origin: see checkOrigins()
  /// @param up unit vector of the vertical, for elevations
  /// @param still scan of the beams without noise, with the return mode RangeUnits
  /// @param directions directions of another coverage with equal beam directions and width; null:
  /// new directions are computed
  Coverage(const ScanSetup& setup, const ScanBeams& beams, const Vec3& up, const ScanResult& still,
    std::shared_ptr<const BeamDirections> directions = {});

  /// Finds the lines of sight to places. @param threads 0: OpenMP's choice
  /// @return false if keepGoing returned false; the sights are then invalid
  bool look(const PlaceAt& placeAt, std::size_t count, int threads, const KeepGoing& keepGoing,
    CoverageSight* sights) const;

  /// Detection of a target at a place.
  /// @param ofPoses receives the probability of each pose, with headings counted from north instead
  /// of from the line of sight (see TargetViews::headings); may be null
  CoverageValue valueAt(const Vec3& place, const CoverageSight& sight, const CoverageTarget& target,
    float* ofPoses = nullptr) const;

  const ScanSetup& setup() const { return this->Setup; }
  const std::shared_ptr<const BeamDirections>& directions() const { return this->Directions; }

  /// Largest number of beams near any place that is farther away than WidestTarget divided by the
  /// least margin; 1 to 255.
  int mostBeams() const { return this->Most; }

  double lowest() const { return this->Lowest; }   ///< lowest elevation in any beam, rad
  double highest() const { return this->Highest; } ///< highest elevation in any beam, rad

private:
  struct PlacedTarget;
  struct NearBeams;

  bool holds(std::uint32_t beam, const Vec3& direction, double cosine) const;
  BeamFrame frameOf(std::uint32_t beam) const;
  BeamAtTarget beamAt(const PlacedTarget& at, std::uint32_t beam) const;
  CoverageSight sightOf(const Vec3& to, BeamTracer& tracer) const;
  PlacedTarget placed(const CoverageTarget& target, const Vec3& place) const;
  bool isHopeless(const PlacedTarget& at, double step) const;
  NearBeams clearBeams(const PlacedTarget& at) const;
  bool isCertain(const PlacedTarget& at, double step, const NearBeams& near) const;
  void share(const PlacedTarget& at, NearBeams& near, double* ofPoses, CoverageValue& value) const;
  CoverageValue valueOf(const PlacedTarget& at, const CoverageSight& sight, double* ofPoses) const;
  bool isInClutter(std::uint32_t beam, double range) const;

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const Vec3 Up;
  const BeamShape Shape;
  const ReceivedPulse Pulse; ///< in range units
  std::shared_ptr<const BeamDirections> Directions;
  ScanAir Air;
  int Most;
  double ElectronsPerJoule;               ///< 0 without a photon receiver
  double CosineHeld;                      ///< cosine of the half-beamwidth
  double Lowest;                          ///< lowest elevation in any beam, rad
  double Highest;                         ///< highest elevation in any beam, rad
  std::vector<std::size_t> ClutterBegins; ///< first index of each beam in Clutter
  std::vector<bool> HasClutter;           ///< true for cells of Directions with clutter in a beam
  std::vector<std::int64_t> Clutter;      ///< range units with echoes of surfaces, by beam
};

/// Returns an empty string if all beams have one origin, otherwise a sentence that says what is
/// expected.
std::string checkOrigins(const ScanBeams& beams);
}

#endif
