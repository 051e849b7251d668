// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneSummary.h
 * @brief Largest reflectance and largest gain of all materials of a scene.
 *
 * Source: none.
 * Valid: any scene.
 * Test: Testing/Prober/same_bits.py.
 */
#ifndef avianlidar_SceneSummary_h
#define avianlidar_SceneSummary_h

#include "ScanSetup.h"

namespace avianlidar
{
struct SceneSummary
{
  double largestReflectance = 0.0; ///< largest albedo() of all triangles; 0 without triangles
  double largestGain = 0.0;        ///< largest apertureGain() of all triangles, 1/sr
};

/// Summarise the materials of a setup.
SceneSummary summarise(const ScanSetup& setup);
}

#endif
