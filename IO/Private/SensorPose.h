// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SensorPose.h
 * @brief Position and orientation of a sensor: transforms points to the sensor's frame, and gives
 * the rotation as a quaternion.
 */
#ifndef AvianLidarSensorPose_h
#define AvianLidarSensorPose_h

#include "CloudData.h"
#include "Vector.h"

namespace avianlidar::formats
{
class SensorPose
{
public:
  /// Makes a pose at the origin, without rotation.
  SensorPose();

  /// Makes a pose from a position, m, and yaw, pitch and roll, deg, as in ScanPattern.h.
  SensorPose(const Point& position, const Point& orientation);

  /// Transforms a point from the scene's frame to the sensor's frame: x right, y forward, z up.
  Point toSensor(const Point& point) const;

  /// Returns the position, m, and the unit quaternion (w x y z, w >= 0) of the rotation from the
  /// sensor's frame to the scene's frame.
  std::array<double, 7> viewpoint() const;

private:
  Point Position{};
  /// Axes of the sensor in the scene's frame, unit vectors.
  std::array<Vec3, 3> Axes;
};
}

#endif
