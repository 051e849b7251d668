// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Poses.h
 * @brief Poses of a frame that moves: of a moving object, or of the platform of a sensor.
 *
 * Between two poses the position is linear in time. The orientation is a spherical linear
 * interpolation (slerp).
 *
 * Source: slerp: K. Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985.
 * Valid: positions up to 1e30 m. Times, positions and orientations of the given poses keep their
 * bits.
 * Test: TestMover.cxx.
 */
#ifndef avianlidar_Poses_h
#define avianlidar_Poses_h

#include "Vector.h"

#include <glm/gtc/quaternion.hpp>

#include <string>
#include <vector>

namespace avianlidar
{
struct Pose
{
  double time = 0.0; ///< time on the clock of the beams, s
  Vec3 position{ 0.0 };
  glm::dquat orientation{ 1.0, 0.0, 0.0, 0.0 }; ///< unit quaternion, from the frame to the scene
};

/// Poses in order of time.
using Poses = std::vector<Pose>;

/// Check poses, and normalise their orientations. @param timed false: times do not matter
/// @return empty, or a sentence that gives what is wrong and what was expected
std::string preparePoses(Poses& poses, bool timed = true);

/// The first pose after a time, s.
Poses::const_iterator poseAfter(const Poses& poses, double time);

/// Find the pose at a time, s. @return false before the first and after the last pose
bool poseAt(const Poses& poses, double time, Pose& pose);
}

#endif
