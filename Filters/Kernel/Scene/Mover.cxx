// SPDX-License-Identifier: BSD-3-Clause
#include "Mover.h"

#include "Hash.h"
#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Largest deviation of the length of an axis from 1.
constexpr double UnitWithin = 1e-6;

/// Factor by which rounding widens spheres.
constexpr double Wider = 1.0 + 1e-9;

std::string checkFlap(const Flap& flap, std::size_t number)
{
  const std::string which = "part " + std::to_string(number + 1) + ": ";
  if (!isFinite(flap.hinge) || !std::isfinite(flap.amplitude) || !std::isfinite(flap.frequency) ||
    !std::isfinite(flap.phase))
  {
    return which + "flap_hinge, flap_amplitude, flap_frequency or flap_phase is not finite";
  }
  const double length = glm::length(flap.axis);
  return std::fabs(length - 1.0) <= UnitWithin
    ? std::string()
    : which + valueError("length of flap_axis", length, "1");
}

/// Bound for every position of the parts: a point of a part remains on a sphere about its hinge.
MoverSphere boundOf(const Mover& mover)
{
  Vec3 lower(std::numeric_limits<double>::infinity());
  Vec3 upper(-lower);
  for (const Vec3& p : mover.mesh.points)
  {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  MoverSphere sphere;
  sphere.center = mover.mesh.points.empty() ? Vec3(0.0) : 0.5 * lower + 0.5 * upper;
  for (std::size_t i = 0; i < mover.mesh.points.size(); ++i)
  {
    const Vec3& p = mover.mesh.points[i];
    double distance = safeLength(p - sphere.center);
    if (mover.parts[i] > 0)
    {
      const Vec3& hinge = mover.flaps[mover.parts[i] - 1].hinge;
      distance = safeLength(p - hinge) + safeLength(hinge - sphere.center);
    }
    sphere.radius = std::max(sphere.radius, distance);
  }
  sphere.radius *= Wider;
  return sphere;
}

std::uint64_t hashOfMover(const Mover& mover)
{
  std::uint64_t hash = mover.mesh.checksum();
  const auto add = [&hash](const auto& values)
  { hash = hashOf(values.data(), values.size() * sizeof(*values.data()), hash); };
  add(mover.parts);
  add(mover.materials);
  std::vector<double> numbers{ mover.always ? 1.0 : 0.0 };
  for (const Pose& pose : mover.poses)
  {
    numbers.insert(numbers.end(),
      { pose.time, pose.position.x, pose.position.y, pose.position.z, pose.orientation.w,
        pose.orientation.x, pose.orientation.y, pose.orientation.z });
  }
  for (const Flap& flap : mover.flaps)
  {
    numbers.insert(numbers.end(),
      { flap.hinge.x, flap.hinge.y, flap.hinge.z, flap.axis.x, flap.axis.y, flap.axis.z,
        flap.amplitude, flap.frequency, flap.phase });
  }
  add(numbers);
  return hash;
}
}

std::string prepareMover(Mover& mover)
{
  if (mover.poses.empty())
  {
    return "it has no pose, expected field data 'pose_position' with at least one";
  }
  const std::string wrong = preparePoses(mover.poses, !mover.always);
  if (!wrong.empty())
  {
    return wrong;
  }
  for (std::size_t k = 0; k < mover.flaps.size(); ++k)
  {
    const std::string wrong = checkFlap(mover.flaps[k], k);
    if (!wrong.empty())
    {
      return wrong;
    }
    mover.flaps[k].axis = glm::normalize(mover.flaps[k].axis);
  }
  mover.bound = boundOf(mover);
  mover.hash = hashOfMover(mover);
  return {};
}

std::uint64_t orderMovers(std::vector<Mover>& movers)
{
  std::stable_sort(
    movers.begin(), movers.end(), [](const Mover& a, const Mover& b) { return a.hash < b.hash; });
  std::vector<std::uint64_t> hashes;
  for (const Mover& mover : movers)
  {
    hashes.push_back(mover.hash);
  }
  return hashOf(hashes.data(), hashes.size() * sizeof(hashes[0]), hashes.size());
}

bool poseAt(const Mover& mover, double time, Pose& pose)
{
  if (mover.always)
  {
    pose = mover.poses.front();
    pose.time = time;
    return true;
  }
  return poseAt(mover.poses, time, pose);
}

MoverSphere sphereAt(const Mover& mover, const Pose& pose)
{
  return { pose.position + pose.orientation * mover.bound.center, mover.bound.radius };
}

bool sphereBetween(const Mover& mover, double begin, double end, MoverSphere& sphere)
{
  const double reach = safeLength(mover.bound.center) * Wider + mover.bound.radius;
  if (mover.always)
  {
    sphere = { mover.poses.front().position, reach };
    return true;
  }
  const double first = std::max(begin, mover.poses.front().time);
  const double last = std::min(end, mover.poses.back().time);
  Pose pose;
  if (!(first <= last) || !poseAt(mover, first, pose))
  {
    return false;
  }
  Vec3 lower = pose.position;
  Vec3 upper = pose.position;
  const auto extend = [&](const Vec3& p)
  {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  };
  for (auto knot = poseAfter(mover.poses, first); knot != mover.poses.end() && knot->time < last;
       ++knot)
  {
    extend(knot->position);
  }
  poseAt(mover, last, pose);
  extend(pose.position);
  sphere.center = 0.5 * lower + 0.5 * upper;
  sphere.radius = safeLength(upper - sphere.center) * Wider + reach;
  return true;
}

void place(const Mover& mover, const Pose& pose, TriangleMesh& mesh)
{
  std::vector<glm::dquat> turns;
  for (const Flap& flap : mover.flaps)
  {
    const double angle =
      flap.amplitude * std::sin(2.0 * Pi * (flap.frequency * pose.time + flap.phase));
    turns.push_back(glm::angleAxis(angle, flap.axis));
  }
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (std::size_t i = 0; i < mover.mesh.points.size(); ++i)
  {
    Vec3 p = mover.mesh.points[i];
    if (mover.parts[i] > 0)
    {
      const Vec3& hinge = mover.flaps[mover.parts[i] - 1].hinge;
      p = hinge + turns[mover.parts[i] - 1] * (p - hinge);
    }
    mesh.points.push_back(pose.position + pose.orientation * p);
  }
  for (const auto& triangle : mover.mesh.triangles)
  {
    mesh.triangles.push_back({ first + triangle[0], first + triangle[1], first + triangle[2] });
  }
}
}
