// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMedia.h
 * @brief Media of the air by visibility and rain rate, with the numbers of media.json. Not
 * installed.
 */
#ifndef vtkAvianLidarMedia_h
#define vtkAvianLidarMedia_h

#include "Medium.h"

#include <vector>

namespace vtkAvianLidarMedia
{
/// Haze, or fog where one sees no farther than it lets one. @param visibility m, above 0 @param
/// extinction at the lidar's wavelength, 1/m
avianlidar::Medium HazeOf(double visibility, double extinction);

/// @param rate mm/h, above 0
avianlidar::Medium RainOf(double rate);
}

#endif
