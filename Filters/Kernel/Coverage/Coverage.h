// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Coverage.h
 * @brief Where a small target, such as a bird, would be detected, and why not elsewhere: in closed
 * form, place by place, without tracing the target.
 *
 * A place is seen by the beams whose cones hold its direction, if no surface stands between (one
 * descent of the tree). A beam is in clutter there if one of the range units that the target's echo
 * may share, were it a point, holds a perceived echo of a surface. The others detect the target
 * with the probability of DetectionLaw.h, each by the part of the target that it lights. Lines of
 * sight are found once; another target, air, receiver or clutter traces nothing.
 *
 * Source: none.
 * Differs: a surface hides the whole target or nothing of it, as it does its middle.
 * Valid: beams of one origin. Media count by the line to the middle of the target, those that move
 * as they are at the time 0. Beams farther from a target's middle than WidestTarget or 0.4 rad do
 * not light it. Of more beams than DetectionLaw::MostBeams those count whose axes, or where they
 * are not round whose borders, are nearest. A threshold that follows the air divides energies by
 * its growth: probabilities are right within 0.03.
 * Test: TestCoverage.cxx, TestBeamShapes.py, TestWeather.py.
 */
#ifndef avianlidar_Coverage_h
#define avianlidar_Coverage_h

#include "BeamAir.h"
#include "BeamDirections.h"
#include "BeamShape.h"
#include "DetectionLaw.h"
#include "Scan.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace avianlidar
{
/// Why a target is not detected at a place: the first that holds.
enum class CoverageStatus : std::uint8_t
{
  OutsideGate = 0,
  AboveBand = 1,    ///< above all beams
  BelowBand = 2,    ///< below all beams
  BetweenBeams = 3, ///< no beam's cone holds it
  Shadowed = 4,     ///< a surface stands before it
  InClutter = 5,    ///< all beams that hold it have an echo of a surface there
  TooWeak = 6,      ///< the probability is below WeakProbability
  Seen = 7
};

constexpr double WeakProbability = 0.1;

/// m, from its middle: nothing of a target beyond is looked for. The widest bird that flies spans
/// 3.5 m.
constexpr double WidestTarget = 2.0;

/// What geometry alone says of a place.
struct CoverageSight
{
  CoverageStatus status = CoverageStatus::OutsideGate; ///< Seen where nothing forbids it
  bool isNear = false;                                 ///< whether a beam may light a target there
  bool isHidden = false;  ///< whether a surface stands before it; looked for where it is near
  std::uint8_t beams = 0; ///< that hold it, at most 255
};

/// What is detected at a place.
struct CoverageValue
{
  CoverageStatus status = CoverageStatus::OutsideGate;
  int beams = 0;            ///< that hold the place
  double probability = 0.0; ///< of detection in one scan
  double photoelectrons =
    0.0; ///< in a beam that holds all of the target; 0 without a photon receiver
  /// m^2: of that mean effective area half of the targets that lie in the beams as a whole are
  /// detected; or infinity.
  double leastArea = std::numeric_limits<double>::infinity();
};

class Coverage;

/// A target that a sensor looks for through the air.
struct CoverageTarget
{
  /// @param attenuation 1/m @param area mean effective area (silhouette weighted by cosine), m^2
  /// @param reflectance 0 to 1 @param views areas relative to the mean @param coverage says which
  /// beams there are
  CoverageTarget(const Sensor& sensor, double attenuation, double area, double reflectance,
    const TargetViews& views, const Coverage& coverage);

  double attenuation;
  double area;
  double reflectance;
  double electronsPerJoule; ///< 0 without a photon receiver
  DetectionLaw law;
  /// J, at which half are detected, by elevation of the law, then number of beams.
  std::vector<std::vector<double>> halfEnergies;
  std::size_t headings; ///< of the views
};

/// The place of a number, m.
using PlaceAt = std::function<Vec3(std::size_t)>;

/// Looks at places. Setup and beams must outlive it; any number of threads may share
/// it.
class Coverage
{
public:
  /// @param beams of one origin, at least one: see checkOrigins() @param up unit vector to which
  /// the beams' elevations refer @param still a scan of the beams without noise, return mode
  /// RangeUnits @param directions that of another coverage by beams of the same directions and
  /// width; null: found here
  Coverage(const ScanSetup& setup, const ScanBeams& beams, const Vec3& up, const ScanResult& still,
    std::shared_ptr<const BeamDirections> directions = {});

  /// Find lines of sight to places. @param threads 0: OpenMP's choice @return false if keepGoing
  /// returned false; the sights are of no use then
  bool look(const PlaceAt& placeAt, std::size_t count, int threads, const KeepGoing& keepGoing,
    CoverageSight* sights) const;

  /// What a target is at a place.
  /// @param ofPoses takes the probability of each pose, of targets that head the same way wherever
  /// the sensor stands (see TargetViews::headings); may be null
  CoverageValue valueAt(const Vec3& place, const CoverageSight& sight, const CoverageTarget& target,
    float* ofPoses = nullptr) const;

  const ScanSetup& setup() const { return this->Setup; }
  const std::shared_ptr<const BeamDirections>& directions() const { return this->Directions; }

  /// No place farther away than WidestTarget over the least margin is near more beams; at least 1.
  int mostBeams() const { return this->Most; }

  double lowest() const { return this->Lowest; }   ///< elevation of the band, rad
  double highest() const { return this->Highest; } ///< rad

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
  void share(
    const PlacedTarget& at, const NearBeams& near, double* ofPoses, CoverageValue& value) const;
  CoverageValue valueOf(const PlacedTarget& at, const CoverageSight& sight, double* ofPoses) const;
  bool isInClutter(std::uint32_t beam, double range) const;

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const Vec3 Up;
  const BeamShape Shape;
  std::shared_ptr<const BeamDirections> Directions;
  BeamAir Air; ///< copied for each target
  int Most;
  double CosineHeld;                      ///< of the half-beamwidth
  double Lowest;                          ///< elevations of the band, rad
  double Highest;                         ///< rad
  std::vector<std::size_t> ClutterBegins; ///< of each beam
  std::vector<bool> HasClutter;           ///< by cell of directions
  std::vector<std::int64_t> Clutter;      ///< units with echoes of surfaces, beam by beam
};

/// Empty if all beams begin at one point; otherwise a sentence that says what was expected.
std::string checkOrigins(const ScanBeams& beams);
}

#endif
