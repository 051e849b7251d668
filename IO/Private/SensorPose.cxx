// SPDX-License-Identifier: BSD-3-Clause
#include "SensorPose.h"

#include "ScanPattern.h"

#include <algorithm>
#include <cmath>

namespace avianlidar::formats
{
SensorPose::SensorPose()
  : Axes{ { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } } }
{
}

SensorPose::SensorPose(const Point& position, const Point& orientation)
  : Position(position)
{
  // The axes are the beams forward (azimuth 0), right (azimuth 90) and up (elevation 90 deg).
  ScanPattern pattern;
  pattern.yaw = orientation[0];
  pattern.pitch = orientation[1];
  pattern.roll = orientation[2];
  pattern.elevations = { 0.0, 90.0 };
  pattern.azimuthStep = 90.0;
  const ScanGenerator beams(pattern);
  this->Axes = { beams.beam(2).direction, beams.beam(0).direction, beams.beam(1).direction };
}

Point SensorPose::toSensor(const Point& point) const
{
  const Point d{ point[0] - this->Position[0], point[1] - this->Position[1],
    point[2] - this->Position[2] };
  Point local;
  for (int axis = 0; axis < 3; ++axis)
  {
    local[axis] =
      this->Axes[axis][0] * d[0] + this->Axes[axis][1] * d[1] + this->Axes[axis][2] * d[2];
  }
  return local;
}

std::array<double, 7> SensorPose::viewpoint() const
{
  // The columns of the rotation matrix R are the axes. Shepperd (1978) takes the largest of the
  // four squares, so that the square root is far from zero.
  const auto r = [this](int row, int column) { return this->Axes[column][row]; };
  std::array<double, 4> squares{ 1.0 + r(0, 0) + r(1, 1) + r(2, 2),
    1.0 + r(0, 0) - r(1, 1) - r(2, 2), 1.0 - r(0, 0) + r(1, 1) - r(2, 2),
    1.0 - r(0, 0) - r(1, 1) + r(2, 2) };
  const auto largest =
    static_cast<int>(std::max_element(squares.begin(), squares.end()) - squares.begin());
  const double sums[4][4] = {
    { squares[0], r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1) },
    { r(2, 1) - r(1, 2), squares[1], r(0, 1) + r(1, 0), r(0, 2) + r(2, 0) },
    { r(0, 2) - r(2, 0), r(0, 1) + r(1, 0), squares[2], r(1, 2) + r(2, 1) },
    { r(1, 0) - r(0, 1), r(0, 2) + r(2, 0), r(1, 2) + r(2, 1), squares[3] },
  };
  const double scale = 0.5 / std::sqrt(squares[largest]);
  const double sign = sums[largest][0] < 0.0 ? -scale : scale;
  // Adding 0 turns -0 into 0.
  return { this->Position[0], this->Position[1], this->Position[2], sign * sums[largest][0] + 0.0,
    sign * sums[largest][1] + 0.0, sign * sums[largest][2] + 0.0, sign * sums[largest][3] + 0.0 };
}
}
