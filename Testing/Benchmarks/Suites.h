// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Suites.h
 * @brief The measurements, each a process of its own. Every one returns false if hits disagree.
 */
#ifndef avianlidar_Suites_h
#define avianlidar_Suites_h

#include "Results.h"

namespace benchmarks
{
/// Ours against Embree: every scene, N, half-beamwidth and number of threads.
bool suiteMatrix(const Options& options);

/// VTK's locators and brute force, per ray, on 500 beams.
bool suiteLocators(const Options& options);
}

#endif
