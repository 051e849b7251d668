// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Suites.h
 * @brief The measurements. Each returns false if a bar is not met.
 */
#ifndef avianlidar_accuracy_Suites_h
#define avianlidar_accuracy_Suites_h

#include <string>

namespace accuracy
{
struct Options
{
  std::string suite;
  std::string folder = "."; ///< results go here
  std::string scene;        ///< only this one; empty: all
  bool check = false;       ///< shipped scenes, few beams and seeds: seconds
};

/// How often +-1.96 standard errors hold the truth, by scene, sampling and number of rays:
/// standard_errors.csv.
bool suiteStandardErrors(const Options& options);

/// How often small boxes before a wall of many parts are found, and how far their energies and
/// standard errors are right: small_targets.csv. The bar: whatever has an id of its own is found,
/// with an honest standard error.
bool suiteSmallTargets(const Options& options);
}

#endif
