// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file KittiFormat.h
 * @brief Reads point clouds of KITTI, and the labels of SemanticKITTI.
 *
 * `.bin`: four float32 a point: x forward, y left, z up in metres in the sensor's frame (ours has x
 * right, y forward), and a reflectance in [0, 1]. `.label`: a uint32 a point: the class in the
 * lower 16 bits, the instance in the upper ones. Sources: Geiger et al., "Vision meets Robotics:
 * The KITTI Dataset", IJRR 2013; Behley et al., "SemanticKITTI", ICCV 2019.
 *
 * float32 rounds a coordinate by at most 2^-25 of the next power of two above it: 4 micrometres at
 * 100 m, 0.12 mm at 4 km.
 */
#ifndef AvianLidarKittiFormat_h
#define AvianLidarKittiFormat_h

#include "ByteSource.h"
#include "CloudData.h"

namespace avianlidar::formats
{
constexpr double KittiGreatestIntensity = 255.0; ///< of a reflectance of 1

/// Reads a cloud, and `semantic_label` and `instance_id` if there are labels. Reflectances above 1
/// are taken for intensities of 0 to 255; points that are not finite are left out; a warning says
/// either. FormatError: no whole number of points, another layout (five numbers a point, as in
/// nuScenes), or not as many labels.
Cloud readKitti(ByteSource& points, ByteSource* labels, const KeepGoing& keepGoing);
}

#endif
