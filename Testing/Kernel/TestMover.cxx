// SPDX-License-Identifier: BSD-3-Clause
// Poses of objects that move, their parts and their bounds.
#include "BirdTestScene.h"
#include "Mover.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <random>

using namespace avianlidar;

namespace
{
Mover pointMover(const Vec3& point = Vec3(1.0, 0.0, 0.0))
{
  Mover mover;
  mover.mesh.points = { point, point + Vec3(0.0, 0.1, 0.0), point + Vec3(0.0, 0.0, 0.1) };
  mover.mesh.triangles = { { 0, 1, 2 } };
  mover.parts = { 0, 0, 0 };
  mover.materials.resize(1);
  mover.objectIds = { 7 };
  mover.materialIds = { 0 };
  mover.poses.resize(1);
  mover.always = true;
  return mover;
}

glm::dquat aboutZ(double angle)
{
  return { std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle) };
}
}

TEST(Mover, PositionIsLinearAndOrientationTurnsEvenly)
{
  Mover mover = pointMover();
  mover.always = false;
  mover.poses = { { 10.0, Vec3(0.0), aboutZ(0.0) }, { 12.0, Vec3(4.0, 0.0, 8.0), aboutZ(1.0) },
    { 13.0, Vec3(4.0, 0.0, 8.0), aboutZ(1.0) } };
  ASSERT_EQ(prepareMover(mover), "");
  Pose pose;
  for (const double share : { 0.0, 0.25, 0.5, 0.9, 1.0 })
  {
    ASSERT_TRUE(poseAt(mover, 10.0 + 2.0 * share, pose));
    EXPECT_NEAR(glm::length(pose.position - share * Vec3(4.0, 0.0, 8.0)), 0.0, 1e-12);
    const Vec3 turned = pose.orientation * Vec3(1.0, 0.0, 0.0);
    EXPECT_NEAR(glm::length(turned - Vec3(std::cos(share), std::sin(share), 0.0)), 0.0, 1e-12);
  }
  EXPECT_TRUE(poseAt(mover, 13.0, pose));
  EXPECT_FALSE(poseAt(mover, std::nextafter(13.0, 14.0), pose));
  EXPECT_FALSE(poseAt(mover, std::nextafter(10.0, 0.0), pose));
}

TEST(Mover, AFlappingBirdIsTheBirdOfThatWingAngle)
{
  for (const int side : { -1, 1 })
  {
    const BirdPart part = side > 0 ? BirdPart::RightWing : BirdPart::LeftWing;
    Mover mover = pointMover();
    mover.mesh = birdPart(birdtest::HerringGull, part, 0.0);
    mover.parts.assign(mover.mesh.points.size(), 1);
    mover.flaps = { { Vec3(0.5 * side * birdtest::HerringGull.bodyDiameter, 0.0, 0.0),
      Vec3(0.0, side > 0 ? -1.0 : 1.0, 0.0), 35.0 * Pi / 180.0, 3.0, 0.2 } };
    ASSERT_EQ(prepareMover(mover), "");
    for (const double time : { 0.0, 0.07, 0.11, 5.3 })
    {
      Pose pose;
      ASSERT_TRUE(poseAt(mover, time, pose));
      TriangleMesh mesh;
      place(mover, pose, mesh);
      const TriangleMesh wanted =
        birdPart(birdtest::HerringGull, part, wingAngle(3.0 * time + 0.2, false));
      for (std::size_t i = 0; i < mesh.points.size(); ++i)
      {
        EXPECT_NEAR(glm::length(mesh.points[i] - wanted.points[i]), 0.0, 1e-12);
      }
    }
  }
}

TEST(Mover, SpheresHoldItWhereverItFliesAndFlaps)
{
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  for (int n = 0; n < 300; ++n)
  {
    Mover mover = pointMover(3.0 * vector());
    mover.always = false;
    mover.parts.assign(3, n % 2);
    mover.flaps = { { 2.0 * vector(), glm::normalize(vector()), 3.0 * uniform(random), 2.0, 0.3 } };
    mover.poses.clear();
    for (int k = 0; k < 5; ++k)
    {
      mover.poses.push_back({ k + 0.3 * uniform(random), 20.0 * vector(),
        glm::normalize(
          glm::dquat(uniform(random), uniform(random), uniform(random), uniform(random))) });
    }
    ASSERT_EQ(prepareMover(mover), "");
    const double begin = 2.0 + 3.0 * uniform(random);
    const double end = begin + 2.0 + uniform(random);
    MoverSphere path;
    const bool there = sphereBetween(mover, begin, end, path);
    for (int k = 0; k <= 50; ++k)
    {
      Pose pose;
      if (!poseAt(mover, begin + (end - begin) * k / 50.0, pose))
      {
        continue;
      }
      ASSERT_TRUE(there);
      const MoverSphere now = sphereAt(mover, pose);
      TriangleMesh mesh;
      place(mover, pose, mesh);
      for (const Vec3& p : mesh.points)
      {
        ASSERT_LE(glm::length(p - now.center), now.radius);
        ASSERT_LE(glm::length(p - path.center), path.radius);
      }
    }
  }
}

TEST(Mover, EveryMemberChangesTheHash)
{
  Mover mover = pointMover();
  mover.parts = { 0, 1, 1 };
  mover.flaps.resize(1);
  ASSERT_EQ(prepareMover(mover), "");
  const std::uint64_t whole = mover.hash;
  using Change = void (*)(Mover&);
  const Change changes[] = { [](Mover& m) { m.mesh.points[0].x += 0.5; },
    [](Mover& m) { m.parts[1] = 0; }, [](Mover& m) { m.materials[0].kd *= 0.5; },
    [](Mover& m) { m.poses[0].position.z = 1.0; },
    [](Mover& m) { m.poses[0].orientation = aboutZ(1.0); },
    [](Mover& m) { m.flaps[0].hinge.y = 1.0; },
    [](Mover& m) { m.flaps[0].axis = Vec3(0.0, 1.0, 0.0); },
    [](Mover& m) { m.flaps[0].amplitude = 0.5; }, [](Mover& m) { m.flaps[0].frequency = 2.0; },
    [](Mover& m) { m.flaps[0].phase = 0.25; } };
  for (std::size_t i = 0; i < std::size(changes); ++i)
  {
    Mover changed = mover;
    changes[i](changed);
    ASSERT_EQ(prepareMover(changed), "") << i;
    EXPECT_NE(changed.hash, whole) << i;
  }
}

// Others are named in TestMovers.py.
TEST(Mover, BadPosesAndPartsAreNamed)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto wrong = [](auto change)
  {
    Mover mover = pointMover();
    mover.always = false;
    mover.poses = { { 0.0 }, { 1.0 } };
    mover.flaps.resize(1);
    change(mover);
    return prepareMover(mover);
  };
  EXPECT_EQ(wrong([](Mover&) {}), "");
  EXPECT_NE(
    wrong([&](Mover& m) { m.poses[1].time = nan; }).find("pose 1: its time is"), std::string::npos);
  EXPECT_NE(wrong([&](Mover& m) { m.flaps[0].phase = nan; }).find("flap_phase"), std::string::npos);
}
