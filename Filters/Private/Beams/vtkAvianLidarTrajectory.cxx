// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTrajectory.h"

#include "AvailableMemory.h"
#include "ScanPattern.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarRequire.h"

#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Pose;
using avianlidar::Vec3;

/// Memory of the pose of a beam, bytes.
constexpr double BytesPerPose = 56.0;

const glm::dquat NotTurned{ 1.0, 0.0, 0.0, 0.0 };

/// The orientation of a sensor on its platform, as a unit quaternion.
glm::dquat MountOf(const double orientation[3])
{
  return glm::quat_cast(avianlidar::rotationOf(orientation[0], orientation[1], orientation[2]));
}

/// Turn the vector of one beam. The bits of a vector that is not turned are kept.
void Turn(const glm::dquat& orientation, vtkIdType beam, vtkDoubleArray* vectors)
{
  Vec3 v;
  vectors->GetTypedTuple(beam, &v.x);
  v = orientation * v;
  vectors->SetTypedTuple(beam, &v.x);
}
}

//------------------------------------------------------------------------------
avianlidar::Poses vtkAvianLidarTrajectory::Read(vtkPolyData* trajectory)
{
  return vtkAvianLidarWithin("Input port 0 (trajectory), ",
    [trajectory]()
    {
      vtkPointData* const arrays = trajectory->GetPointData();
      const vtkIdType count = trajectory->GetNumberOfPoints();
      vtkDataArray* const times = arrays->GetArray(Arrays::Time.name);
      vtkDataArray* const turns = arrays->GetArray(Arrays::PoseOrientation.name);
      Arrays::RequireNumeric(arrays, Arrays::Time, "point array");
      Arrays::RequireNumeric(arrays, Arrays::PoseOrientation, "point array");
      vtkAvianLidarRequire(times && count > 0 ? ""
                                              : "point array 'time' is missing or empty, expected "
                                                "the time in seconds of each position");
      Arrays::RequireShape(times, "point array", 1, count);
      Arrays::RequireShape(turns, "point array", 4, count);
      avianlidar::Poses poses(static_cast<std::size_t>(count));
      for (vtkIdType i = 0; i < count; ++i)
      {
        Pose& pose = poses[static_cast<std::size_t>(i)];
        pose.time = times->GetComponent(i, 0);
        trajectory->GetPoint(i, &pose.position.x);
        if (turns)
        {
          double q[4];
          turns->GetTuple(i, q);
          pose.orientation = { q[0], q[1], q[2], q[3] };
        }
      }
      vtkAvianLidarRequire(avianlidar::preparePoses(poses));
      return poses;
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarTrajectory::Carry(const avianlidar::Poses& poses, const double position[3],
  const double orientation[3], vtkPolyData* beams)
{
  const vtkIdType count = beams->GetNumberOfPoints();
  avianlidar::requireMemory(
    static_cast<double>(count), "poses of beams", BytesPerPose * static_cast<double>(count));
  vtkPointData* const arrays = beams->GetPointData();
  const auto find = [arrays](const Arrays::Name& name)
  { return vtkDoubleArray::SafeDownCast(arrays->GetArray(name.name)); };
  vtkDoubleArray* const directions = find(Arrays::Direction);
  vtkDoubleArray* const reported = find(Arrays::ReportedDirection);
  vtkDoubleArray* const azimuths = find(Arrays::Azimuth);
  vtkDoubleArray* const elevations = find(Arrays::VerticalAngle);
  vtkDoubleArray* const timestamps = find(Arrays::Timestamp);
  auto positions = Arrays::Make<vtkDoubleArray>(Arrays::SensorPosition, count, 3);
  auto turns = Arrays::Make<vtkDoubleArray>(Arrays::SensorOrientation, count, 4);
  const Vec3 arm(position[0], position[1], position[2]);
  const glm::dquat mount = MountOf(orientation);
  for (vtkIdType i = 0; i < count; ++i)
  {
    Pose pose;
    const double time = 1e-6 * timestamps->GetValue(i); // rounding may pass the last pose
    avianlidar::poseAt(poses, std::clamp(time, poses.front().time, poses.back().time), pose);
    const glm::dquat& turn = pose.orientation;
    Vec3 p;
    beams->GetPoint(i, &p.x);
    p = pose.position + turn * p;
    beams->GetPoints()->SetPoint(i, &p.x);
    p = pose.position + turn * arm;
    positions->SetTypedTuple(i, &p.x);
    const glm::dquat whole = turn * mount;
    const double q[4] = { whole.w, whole.x, whole.y, whole.z };
    turns->SetTypedTuple(i, q);
    if (turn != NotTurned)
    {
      Turn(turn, i, directions);
      if (reported)
      {
        Turn(turn, i, reported);
      }
      Vec3 d;
      (reported ? reported : directions)->GetTypedTuple(i, &d.x);
      azimuths->SetValue(i, vtkAvianLidarBeams::AzimuthOf(d));
      elevations->SetValue(i, vtkAvianLidarBeams::ElevationOf(d));
    }
  }
  arrays->AddArray(positions);
  arrays->AddArray(turns);
}

//------------------------------------------------------------------------------
void vtkAvianLidarTrajectory::Place(const Pose& pose, const double position[3],
  const double orientation[3], double placed[3], double turned[3])
{
  const Vec3 p = pose.position + pose.orientation * Vec3(position[0], position[1], position[2]);
  Vec3 angles(orientation[0], orientation[1], orientation[2]);
  if (pose.orientation != NotTurned)
  {
    angles = avianlidar::anglesOf(glm::mat3_cast(pose.orientation * MountOf(orientation)));
  }
  for (int i = 0; i < 3; ++i)
  {
    placed[i] = p[i];
    turned[i] = angles[i];
  }
}
