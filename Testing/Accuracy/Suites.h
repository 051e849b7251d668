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

/// Error reached, rays and CPU time with a target error and with fixed numbers of rays:
/// target_error.csv, fixed_rays.csv.
bool suiteTargetError(const Options& options);

/// How often boxes are seen by size, and what rays of their own for small objects cost on the
/// airports: small_targets.csv, small_targets_cost.csv. The bar: a larger box is seen no less
/// often.
bool suiteSmallTargets(const Options& options);
}

#endif
