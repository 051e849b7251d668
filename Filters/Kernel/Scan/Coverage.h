// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Coverage.h
 * @brief Where a small target, such as a bird, would be detected, and why not elsewhere: in closed
 * form, place by place, without tracing the target.
 *
 * A place is seen by the beams whose cones hold its direction, if no surface stands between (one
 * descent of the tree). A beam is in clutter there if one of the range units that the target's echo
 * may share holds a perceived echo of a surface. The others detect the target with the probability
 * of DetectionLaw.h. What depends on geometry and clutter is found once (CoverageView); another
 * target or another air costs a table look-up a place.
 *
 * Source: none.
 * Differs: the target is a point: its whole effective area lies in each beam that holds the place.
 * With a Gaussian profile all beams count with the mean of their irradiance there.
 * Valid: beams of one origin.
 * Test: TestCoverage.cxx.
 */
#ifndef avianlidar_Coverage_h
#define avianlidar_Coverage_h

#include "BeamDirections.h"
#include "DetectionLaw.h"
#include "Scan.h"

#include <cstdint>
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

/// What a place is to the beams, whatever the target.
struct CoverageView
{
  CoverageStatus status = CoverageStatus::OutsideGate; ///< Seen where nothing forbids it
  std::uint8_t beams = 0;                              ///< whose cones hold it, at most 255
  std::uint8_t clear = 0;                              ///< of these without clutter there
  float irradiance = 1.0f; ///< mean of the clear beams, over that of a uniform beam
  double range = 0.0;      ///< m from the sensor
};

/// The target.
struct CoverageTarget
{
  double area = 0.03;       ///< mean effective area (silhouette weighted by cosine), m^2
  double reflectance = 0.3; ///< 0 to 1
};

/// What is detected at a place.
struct CoverageValue
{
  CoverageStatus status = CoverageStatus::OutsideGate;
  double probability = 0.0;    ///< of detection in one scan
  double photoelectrons = 0.0; ///< of the target in one beam; 0 without a photon receiver
  double leastArea = 0.0; ///< m^2: of that mean effective area the probability is 1/2; or infinity
};

/// Looks at places. The constructor's arguments must outlive it; any number of threads may share
/// it.
class Coverage
{
public:
  /// @param beams of one origin, at least one: see checkOrigins() @param up unit vector to which
  /// the beams' elevations refer @param still a scan of the beams without noise, return mode
  /// RangeUnits
  Coverage(const ScanSetup& setup, const ScanBeams& beams, const Vec3& up, const ScanResult& still);

  /// View places. @param threads 0: OpenMP's choice @return false if keepGoing returned false
  bool view(const Vec3* places, std::size_t count, int threads, const KeepGoing& keepGoing,
    CoverageView* views) const;

  /// What a target is at a place. @param law of the setup's sensor and the target's areas
  CoverageValue valueAt(
    const CoverageView& view, const CoverageTarget& target, const DetectionLaw& law) const;

private:
  CoverageView viewOf(const Vec3& place, BeamTracer& tracer) const;
  bool isInClutter(std::uint32_t beam, double range) const;

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const Vec3 Up;
  BeamDirections Directions;
  double Lowest;                          ///< elevations of the band, rad
  double Highest;                         ///< rad
  std::vector<std::size_t> ClutterBegins; ///< of each beam
  std::vector<std::int64_t> Clutter;      ///< units with echoes of surfaces, beam by beam
};

/// Empty if all beams begin at one point; otherwise a sentence that says what was expected.
std::string checkOrigins(const ScanBeams& beams);
}

#endif
