// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LinkLight.h
 * @brief What diffuse connections bring back, without air (see SecondaryReflection.h and
 * PathStrengths.h), in a loop over lanes for the paper's own reflectance without an aperture (about
 * 5 ns each), one by one for the other models.
 */
#ifndef avianlidar_LinkLight_h
#define avianlidar_LinkLight_h

#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Strength of each link if nothing blocks it. The materials of the hits must be known.
void linkStrengths(
  const ScanSetup& setup, const SecondaryBeam& beam, std::vector<double>& strengths);

/// Share of a ray's energy that its direct echo leaves at P1.
double secondaryBudget(const SecondaryBeam& beam, std::uint32_t hit);

/// min(1, B/(g R2)): scale of a path from `hit` to a surface `second` that keeps the ray within its
/// budget.
double secondaryScale(
  const ScanSetup& setup, const SecondaryBeam& beam, std::uint32_t hit, const Material& second);

/// Solid angle of a cone of half-angle t, sr.
double coneSolidAngle(double halfBeamwidth);
}

#endif
