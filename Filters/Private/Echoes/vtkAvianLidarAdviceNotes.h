// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarAdviceNotes.h
 * @brief In words: what a scene requires, why, and the settings that are advised as a command, in
 * Python and for ParaView's panel. Not installed.
 */
#ifndef vtkAvianLidarAdviceNotes_h
#define vtkAvianLidarAdviceNotes_h

#include "Advice.h"

#include <string>
#include <vector>

namespace vtkAvianLidarAdviceNotes
{
/// Settings as one would say them.
std::string InWords(const avianlidar::AdviceSettings& settings);

/// Lines: what was asked and advised, and what the scene requires. @param setup of the scan
std::vector<std::string> Lines(const avianlidar::ScanSetup& setup,
  const avianlidar::AdviceQuestion& question, const avianlidar::AdviceAnswer& answer);
}

#endif
