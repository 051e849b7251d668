// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBuiltInTexts.h
 * @brief Gives the texts of data files that are built in: sensors and species. Not installed.
 */
#ifndef vtkAvianLidarBuiltInTexts_h
#define vtkAvianLidarBuiltInTexts_h

#include <string>

/// The text of a built-in file, such as "Airport16.lidarsensor.json" or "species.csv".
const char* vtkAvianLidarBuiltInText(const std::string& file);

#endif
