// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EchoPreset.h
 * @brief Named settings of fidelity, from the measured trade of time for accuracy
 * (Documentation/results/accuracy.md).
 */
#ifndef avianlidar_EchoPreset_h
#define avianlidar_EchoPreset_h

#include "EchoSettings.h"

#include <string>

namespace avianlidar
{
enum class EchoPreset
{
  Custom = 0,   ///< the settings as they are
  Draft = 1,    ///< a fast look
  Standard = 2, ///< what most want
  Reference = 3 ///< converged: what others are compared with
};

/// Replaces what makes a simulation fast or accurate, and nothing else: number of rays, sampling,
/// target error, refinement near Qlow, reflections, connections. Empty if the preset is one of the
/// four; otherwise a sentence that names the value and what was expected, and the settings stay.
std::string applyPreset(EchoPreset preset, EchoSettings& settings);
}

#endif
