// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DetectionLaws.h
 * @brief Detection laws that are kept for later coverages, because a law takes up to a second, and
 * sites, weathers and reports use few laws.
 *
 * Source: none.
 * Valid: see DetectionLaw.h. Any number of threads may share an object.
 * Test: TestCoverageSurvey.cxx.
 */
#ifndef avianlidar_DetectionLaws_h
#define avianlidar_DetectionLaws_h

#include "DetectionLaw.h"

#include <memory>
#include <mutex>
#include <vector>

namespace avianlidar
{
class DetectionLaws
{
public:
  /// Most memory of kept laws, bytes, without the law that was used last.
  static constexpr std::size_t MostBytes = 64u << 20;

  /// Returns the law of these inputs (see DetectionLaw), kept or new.
  std::shared_ptr<const DetectionLaw> get(const Sensor& sensor,
    const std::shared_ptr<const TargetViews>& views, double lowest, double highest, int mostBeams);

private:
  struct Kept
  {
    std::vector<double> numbers;
    std::shared_ptr<const TargetViews> views;
    std::shared_ptr<const DetectionLaw> law;
  };
  std::mutex Mutex;
  std::vector<Kept> Laws; ///< the law that was used last is the last
};
}

#endif
