// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBuiltInTexts.h
 * @brief Data files that are built in, as text: sensors and species. Not installed.
 */
#ifndef vtkAvianLidarBuiltInTexts_h
#define vtkAvianLidarBuiltInTexts_h

#include <string>

/// The text of a file that is there, as "Airport16.lidarsensor.json" or "species.csv".
const char* vtkAvianLidarBuiltInText(const std::string& file);

#endif
