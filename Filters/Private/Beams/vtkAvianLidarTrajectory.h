// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTrajectory.h
 * @brief Reads the poses of a moving platform from vtkPolyData, and carries beams with them. Not
 * installed.
 *
 * Each point is a pose: its position, m, with the point arrays `time` (s) and, optionally,
 * `pose_orientation` (unit quaternion w, x, y, z, from the platform's frame to the scene's).
 */
#ifndef vtkAvianLidarTrajectory_h
#define vtkAvianLidarTrajectory_h

#include "Poses.h"

class vtkPolyData;

namespace vtkAvianLidarTrajectory
{
/// Read poses. Throws std::runtime_error, which names the input and the array.
avianlidar::Poses Read(vtkPolyData* trajectory);

/// Carry beams from the platform's frame to the scene's, each with the pose at its timestamp, and
/// add the arrays of the sensor's poses. @param poses poses at all these times
/// @param position position of the sensor in the platform's frame, m @param orientation yaw, pitch
/// and roll of the sensor in this frame, deg
void Carry(const avianlidar::Poses& poses, const double position[3], const double orientation[3],
  vtkPolyData* beams);

/// Position, m, and yaw, pitch and roll, deg, of the sensor in a pose of the platform.
void Place(const avianlidar::Pose& pose, const double position[3], const double orientation[3],
  double placed[3], double turned[3]);
}

#endif
