// SPDX-License-Identifier: BSD-3-Clause
#include "Poses.h"

#include "ValueError.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Farthest position, m: the limit of all coordinates of a scene.
constexpr double FarthestPosition = 1e30;

/// Largest deviation of the length of a quaternion from 1.
constexpr double QuaternionWithin = 1e-6;

std::string checkPose(const Pose& pose, bool timed)
{
  if (timed && !std::isfinite(pose.time))
  {
    return valueError("its time", pose.time, "a finite number of seconds");
  }
  if (!isFinite(pose.position) || !(safeLength(pose.position) <= FarthestPosition))
  {
    return "its position is not finite or beyond 1e30 m";
  }
  const double length = glm::length(pose.orientation);
  return std::fabs(length - 1.0) <= QuaternionWithin
    ? std::string()
    : valueError("length of pose_orientation", length, "1 (a unit quaternion w, x, y, z)");
}

Vec3 between(const Vec3& a, const Vec3& b, double share)
{
  return a + share * (b - a); // a, bit for bit, if a and b are equal
}
}

std::string preparePoses(Poses& poses, bool timed)
{
  for (std::size_t k = 0; k < poses.size(); ++k)
  {
    Pose& pose = poses[k];
    std::string wrong = checkPose(pose, timed);
    if (wrong.empty() && k > 0 && !(poses[k - 1].time < pose.time))
    {
      wrong = "its time is not later than that of the pose before, expected rising times";
    }
    if (!wrong.empty())
    {
      return "pose " + std::to_string(k) + ": " + wrong;
    }
    if (glm::dot(pose.orientation, pose.orientation) != 1.0)
    {
      pose.orientation = glm::normalize(pose.orientation);
    }
  }
  return {};
}

Poses::const_iterator poseAfter(const Poses& poses, double time)
{
  return std::upper_bound(
    poses.begin(), poses.end(), time, [](double t, const Pose& pose) { return t < pose.time; });
}

bool poseAt(const Poses& poses, double time, Pose& pose)
{
  const auto next = poseAfter(poses, time);
  if (next == poses.begin() || (next == poses.end() && time > poses.back().time))
  {
    return false;
  }
  const Pose& one = *(next - 1);
  const Pose& two = next == poses.end() ? one : *next;
  const double share = &one == &two ? 0.0 : (time - one.time) / (two.time - one.time);
  pose.time = time;
  pose.position = between(one.position, two.position, share);
  pose.orientation = one.orientation == two.orientation
    ? one.orientation
    : glm::normalize(glm::slerp(one.orientation, two.orientation, share));
  return true;
}
}
