// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Mover.h
 * @brief An object that moves: triangles in a frame of its own, poses of that frame over time, and
 * parts that flap about hinges.
 *
 * Between two poses the position is linear in time and the orientation a spherical linear
 * interpolation (slerp). Before the first pose and after the last one the object is absent; an
 * object without times has one pose and stands there always. A part turns about its hinge by
 * amplitude sin(2 pi (frequency t + phase)), before the pose is applied.
 *
 * Source: slerp: K. Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985.
 * Valid: an object at rest in the scene's frame (position 0, orientation 1) keeps the bits of its
 * points. Positions up to 1e30 m.
 * Test: TestMover.cxx.
 */
#ifndef avianlidar_Mover_h
#define avianlidar_Mover_h

#include "Reflectance.h"
#include "TriangleMesh.h"

#include <glm/gtc/quaternion.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
struct Pose
{
  double time = 0.0; ///< s, on the clock of the beams
  Vec3 position{ 0.0 };
  glm::dquat orientation{ 1.0, 0.0, 0.0, 0.0 }; ///< unit, from the object's frame to the scene's
};

/// How a part flaps, in the object's frame.
struct Flap
{
  Vec3 hinge{ 0.0 };          ///< a point of the axis, m
  Vec3 axis{ 1.0, 0.0, 0.0 }; ///< unit
  double amplitude = 0.0;     ///< rad
  double frequency = 0.0;     ///< Hz
  double phase = 0.0;         ///< in whole turns
};

/// Bound of an object wherever it flaps.
struct MoverSphere
{
  Vec3 center{ 0.0 };  ///< m
  double radius = 0.0; ///< m
};

struct Mover
{
  TriangleMesh mesh;                ///< in the object's frame, m; all its points are corners
  std::vector<std::uint32_t> parts; ///< of each point: 0 is rigid, p moves with flaps[p - 1]
  std::vector<Material> materials;  ///< one per triangle, as the two below
  std::vector<int> objectIds;       ///< used by no other object of the scene
  std::vector<int> materialIds;
  std::vector<Pose> poses; ///< times rise
  bool always = false;     ///< one pose, which holds at any time
  std::vector<Flap> flaps;
  // Set by prepareMover().
  MoverSphere bound;      ///< in the object's frame
  std::uint64_t hash = 0; ///< of all but its ids
};

/// Check an object, make its orientations unit quaternions, and find its bound and hash.
/// @return empty, or what is wrong and what was expected
std::string prepareMover(Mover& mover);

/// Put objects that are prepared into an order that depends on what they are, not on the order in
/// which they come. @return hash of all
std::uint64_t orderMovers(std::vector<Mover>& movers);

/// The pose at a time. @return false if the object is absent
bool poseAt(const Mover& mover, double time, Pose& pose);

/// A sphere about the object at any time in [begin, end], s. @return false if it is absent
bool sphereBetween(const Mover& mover, double begin, double end, MoverSphere& sphere);

/// Its bound in the scene.
MoverSphere sphereAt(const Mover& mover, const Pose& pose);

/// Append the object's points and triangles, in scene coordinates. @param pose at that time
void place(const Mover& mover, const Pose& pose, TriangleMesh& mesh);
}

#endif
