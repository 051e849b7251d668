// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoverageSurvey.h
 * @brief Coverage of many places: the value of each place, and sums over regions and height bands.
 *
 * Lines of sight and beam directions are kept from one target or scan to the next, and are
 * recomputed only if their inputs change. Surveys may share detection laws. Blocks of places are
 * summed in a fixed order, so the sums are the same for any number of threads.
 *
 * Source: none.
 * Valid: see Coverage.h.
 * Test: TestCoverageSurvey.cxx.
 */
#ifndef avianlidar_CoverageSurvey_h
#define avianlidar_CoverageSurvey_h

#include "CoverageShares.h"
#include "DetectionLaws.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace avianlidar
{
/// The places of a survey, by number.
struct SurveyPlaces
{
  static constexpr std::size_t NoRegion = static_cast<std::size_t>(-1);

  PlaceAt at;
  std::size_t count = 0;
  std::uint64_t hash = 0; ///< hash of all coordinates
  /// Function that returns the region to whose sums a place is added, or NoRegion.
  std::function<std::size_t(std::size_t place)> regionOf;
};

/// Target of a survey.
struct SurveyTarget
{
  double area; ///< mean effective area, m^2
  double reflectance;
  std::shared_ptr<const TargetViews> views; ///< silhouettes, with areas relative to the mean
};

/// Rules of track detection (M of N scans) and of the sums over places.
struct SurveyRules
{
  int requiredDetections = 1; ///< M: number of detections that make a track, 1 to scans
  int scans = 1;              ///< N: number of scans, 1 to MostScans
  bool strikeHeightWeights = false;
  std::vector<double> heightLimits; ///< ascending borders, m; a border belongs to the upper band

  std::size_t bands() const { return this->heightLimits.size() + 1; }
};

/// Returns an empty string, or what is wrong with the first invalid rule.
std::string checkRules(const SurveyRules& rules);

class CoverageSurvey
{
public:
  /// @param laws laws that surveys share; each survey may have its own
  explicit CoverageSurvey(std::shared_ptr<DetectionLaws> laws = std::make_shared<DetectionLaws>())
    : Laws(std::move(laws))
  {
  }

  /// Function that receives the result of a place and the probability of a track. Any thread may
  /// call the function.
  using EachPlace =
    std::function<void(std::size_t place, const CoverageValue& value, double track)>;

  /// Function that returns where to store the probabilities of a place's poses
  /// (Coverage::valueAt()).
  using PosesOf = std::function<float*(std::size_t place)>;

  /// Finds the lines of sight to places. The arguments must outlive the next evaluate().
  /// @param beams beams of one origin, or empty @param still scan without noise, as for Coverage
  /// @param geometry hash of the surfaces
  /// @return false if keepGoing returned false
  bool look(const ScanSetup& setup, const ScanBeams& beams, const ScanResult& still,
    const SurveyPlaces& places, std::uint64_t geometry, int threads, const KeepGoing& keepGoing);

  /// Computes the detection of a target at the places of the last look().
  /// @param each function called for each place; may be empty @param sums sums by region, then
  /// height band, to which results are added
  /// @param posesOf function for the probabilities of poses; may be empty @return false if
  /// keepGoing returned false; sums are then unchanged
  bool evaluate(const SurveyTarget& target, const SurveyRules& rules, int threads,
    const KeepGoing& keepGoing, const EachPlace& each, CoverageShares* sums,
    const PosesOf& posesOf = {});

  std::size_t size() const { return this->Sights.size(); } ///< number of places

  /// Number of places whose line of sight the last look() found anew.
  std::size_t traced() const { return this->Traced; }

private:
  SurveyPlaces Places;
  std::vector<CoverageSight> Sights;
  std::uint64_t SightsOf = 0;        ///< hash of the inputs of Sights
  std::unique_ptr<Coverage> Covered; ///< null without beams
  std::uint64_t DirectionsOf = 0;    ///< hash of the inputs of the BeamDirections in Covered
  std::size_t Traced = 0;
  std::shared_ptr<DetectionLaws> Laws;
};

/// Returns, for each echo of a scan without noise, the share of scans with noise in which the echo
/// is perceived.
std::vector<double> shareOfScans(const Sensor& sensor, const std::vector<Echo>& echoes);
}

#endif
