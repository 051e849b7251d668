// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoverageSurvey.h
 * @brief Coverage of many places: values of each, sums over them, and what is kept from one target
 * or scan to the next.
 *
 * Lines of sight, beams by direction and laws of detection are found again only where something
 * that they depend on is another. Blocks of places are summed in their order, so the sums are the
 * same for any number of threads.
 *
 * Source: none.
 * Valid: see Coverage.h.
 * Test: TestCoverageSurvey.cxx.
 */
#ifndef avianlidar_CoverageSurvey_h
#define avianlidar_CoverageSurvey_h

#include "CoverageShares.h"

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
  std::uint64_t hash = 0; ///< of all coordinates
  /// In the sums of which region a place counts, or NoRegion.
  std::function<std::size_t(std::size_t place)> regionOf;
};

/// What is looked for.
struct SurveyTarget
{
  double area; ///< mean effective area, m^2
  double reflectance;
  std::shared_ptr<const TargetViews> views; ///< areas relative to the mean
};

/// How places are judged and summed.
struct SurveyRules
{
  int requiredDetections = 1; ///< of so many scans for a track, 1 to scans
  int scans = 1;              ///< 1 to MostScans
  bool strikeHeightWeights = false;
  std::vector<double> heightLimits; ///< m, rising; each band holds its lower limit

  std::size_t bands() const { return this->heightLimits.size() + 1; }
};

/// Empty, or what is wrong with a rule.
std::string checkRules(const SurveyRules& rules);

class CoverageSurvey
{
public:
  /// Take a place's result; any thread calls it.
  using EachPlace =
    std::function<void(std::size_t place, const CoverageValue& value, double track)>;

  /// Where the probabilities of a place's poses go, see Coverage::valueAt().
  using PosesOf = std::function<float*(std::size_t place)>;

  /// Look at places. All that is given must outlive the next evaluate(). @param beams of one
  /// origin, or none @param still see Coverage @param geometry hash of the surfaces @return false
  /// if keepGoing returned false
  bool look(const ScanSetup& setup, const ScanBeams& beams, const ScanResult& still,
    const SurveyPlaces& places, std::uint64_t geometry, int threads, const KeepGoing& keepGoing);

  /// What is detected of a target at these places. @param sums by region, then height band: added
  /// to @return as above; the sums are as before then
  bool evaluate(const SurveyTarget& target, const SurveyRules& rules, int threads,
    const KeepGoing& keepGoing, const EachPlace& each, CoverageShares* sums,
    const PosesOf& posesOf = {});

  std::size_t size() const { return this->Sights.size(); } ///< places that are kept

  /// Places to which the last look() found the line of sight.
  std::size_t traced() const { return this->Traced; }

private:
  const CoverageTarget& targetOf(const SurveyTarget& wanted);

  SurveyPlaces Places;
  std::vector<CoverageSight> Sights;
  std::uint64_t SightsOf = 0;        ///< hash of what they depend on
  std::unique_ptr<Coverage> Covered; ///< null without beams
  std::uint64_t DirectionsOf = 0;    ///< hash of what its BeamDirections depend on
  std::size_t Traced = 0;
  /// A target after what it depends on.
  struct KeptTarget
  {
    std::vector<double> numbers;
    std::shared_ptr<const TargetViews> views;
    std::unique_ptr<const CoverageTarget> target;
  };
  std::vector<KeptTarget> Targets; ///< the last ones
};

/// In which share of scans with noise each echo of a scan without is perceived.
std::vector<double> shareOfScans(const Sensor& sensor, const std::vector<Echo>& echoes);
}

#endif
