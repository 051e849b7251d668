// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ConnectionLight.h
 * @brief What diffuse connections bring back, without air (see SecondaryReflection.h and
 * Throughput.h), in loops over lanes (about 5 ns each).
 */
#ifndef avianlidar_ConnectionLight_h
#define avianlidar_ConnectionLight_h

#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Throughput of each connection if nothing blocks it. @param materials of the samples
void connectionThroughputs(const ScanSetup& setup, const SecondaryBeam& beam,
  const MaterialLanes& materials, std::vector<double>& throughputs);

/// min(1, B/(g R2)): scale of a path from `sample` to a surface `second` that keeps the ray within
/// its budget.
double secondaryScale(const ScanSetup& setup, const SecondaryBeam& beam, std::uint32_t sample,
  const Material& first, const Material& second);

/// Solid angle of a cone of half-angle t, sr.
double coneSolidAngle(double halfBeamwidth);
}

#endif
