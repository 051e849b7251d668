// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file KittiFormat.h
 * @brief Reads point clouds of KITTI, and the labels of SemanticKITTI.
 *
 * A `.bin` file has four float32 per point: x forward, y left and z up in the sensor's frame, m,
 * and a reflectance in [0, 1]. In this project's clouds x is right and y is forward. A `.label`
 * file has a uint32 per point, with the class in the lower 16 bits and the instance in the upper 16
 * bits. A `.bin` file of nuScenes has five float32 per point: x right, y forward and z up, m, an
 * intensity in [0, 255] and the number of the laser (ring). Sources: Geiger et al., "Vision meets
 * Robotics: The KITTI Dataset", IJRR 2013; Behley et al., "SemanticKITTI", ICCV 2019; Caesar et
 * al., "nuScenes", CVPR 2020.
 *
 * A coordinate in float32 is rounded by at most 2^-25 of the next greater power of two: 4
 * micrometres at 100 m, 0.12 mm at 4 km.
 */
#ifndef AvianLidarKittiFormat_h
#define AvianLidarKittiFormat_h

#include "ByteSource.h"
#include "CloudData.h"

namespace avianlidar::formats
{
constexpr double KittiGreatestIntensity = 255.0; ///< intensity of the reflectance 1

/// Reads a cloud, with the columns `semantic_label` and `instance_id` if `labels` is not null. If a
/// reflectance is above 1, all reflectances are taken as intensities of 0 to 255, with a warning.
/// Points of nuScenes are known by their numbers, and have the column `laser_id`. Points that are
/// not finite are left out, with a warning. Throws FormatError if the file does not have a whole
/// number of points, has another layout, or if points and labels differ in number.
Cloud readKitti(ByteSource& points, ByteSource* labels, const KeepGoing& keepGoing);

/// Returns whether the length of a file is that of points of KITTI or nuScenes.
bool mayBeKitti(ByteSource& points);
}

#endif
