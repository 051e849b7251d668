// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Mover.h
 * @brief A moving object: triangles in its own frame, poses of this frame over time, and parts that
 * flap about hinges.
 *
 * The object is absent before the first pose and after the last pose. An object without times has
 * one pose and is present at all times. Before the pose is applied, a part turns about its hinge by
 * the angle a sin(2 pi (f t + phase)), with a the amplitude and f the frequency.
 *
 * Source: none.
 * Valid: positions up to 1e30 m. An object at rest in the scene's frame (position 0, orientation 1)
 * keeps the bits of its points.
 * Test: TestMover.cxx.
 */
#ifndef avianlidar_Mover_h
#define avianlidar_Mover_h

#include "Poses.h"
#include "Reflectance.h"
#include "TriangleMesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Flapping of a part, in the object's frame.
struct Flap
{
  Vec3 hinge{ 0.0 };          ///< point on the axis, m
  Vec3 axis{ 1.0, 0.0, 0.0 }; ///< unit vector along the axis
  double amplitude = 0.0;     ///< largest angle about the axis, rad
  double frequency = 0.0;     ///< flaps per second, Hz
  double phase = 0.0;         ///< phase at time 0, turns
};

/// Sphere that holds an object, however its parts flap.
struct MoverSphere
{
  Vec3 center{ 0.0 };  ///< centre, m
  double radius = 0.0; ///< radius, m
};

struct Mover
{
  TriangleMesh mesh;                ///< triangles in the object's frame, m; all points are corners
  std::vector<std::uint32_t> parts; ///< part of each point: 0 is rigid, p moves with flaps[p - 1]
  std::vector<Material> materials;  ///< material of each triangle
  std::vector<int> objectIds;       ///< object id of each triangle; no other object has these ids
  std::vector<int> materialIds;     ///< material id of each triangle
  Poses poses;                      ///< poses in order of time
  bool always = false;              ///< true if the only pose holds at any time
  std::vector<Flap> flaps;
  // Set by prepareMover().
  MoverSphere bound;      ///< sphere about the object, in the object's frame
  std::uint64_t hash = 0; ///< hash of all members except the ids
};

/// Check an object, normalise its orientations and axes, and find its bound and hash.
/// @return empty, or a sentence that gives what is wrong and what was expected
std::string prepareMover(Mover& mover);

/// Sort prepared objects by content, so that the order in which they come does not matter.
/// @return hash of all objects
std::uint64_t orderMovers(std::vector<Mover>& movers);

/// Find the pose at a time, s. @return false if the object is absent
bool poseAt(const Mover& mover, double time, Pose& pose);

/// Find a sphere about the object at all times in [begin, end], s. @return false if the object is
/// absent at all these times
bool sphereBetween(const Mover& mover, double begin, double end, MoverSphere& sphere);

/// Sphere about an object in a pose, in scene coordinates.
MoverSphere sphereAt(const Mover& mover, const Pose& pose);

/// Append the object's points and triangles, at the pose and its time, in scene coordinates.
void place(const Mover& mover, const Pose& pose, TriangleMesh& mesh);
}

#endif
