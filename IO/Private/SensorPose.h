// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SensorPose.h
 * @brief Where a sensor stands and how it is turned: points to its own frame, and its rotation as a
 * quaternion.
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
  /// At the origin, unturned.
  SensorPose();

  /// Position in metres; yaw, pitch, roll in degrees as in ScanPattern.h.
  SensorPose(const Point& position, const Point& orientation);

  /// Scene's frame to the sensor's: x right, y forward, z up.
  Point toSensor(const Point& point) const;

  /// Position and unit quaternion (w x y z, w >= 0) of the rotation from the sensor's frame to the
  /// scene's.
  std::array<double, 7> viewpoint() const;

private:
  Point Position{};
  /// The sensor's axes in the scene's frame.
  std::array<Vec3, 3> Axes;
};
}

#endif
