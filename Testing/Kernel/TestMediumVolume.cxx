// SPDX-License-Identifier: BSD-3-Clause
// Volumes of media: crossings against midpoints, volumes that move, bad ones.
#include "MediumTestScene.h"
#include "Statistics.h"

#include <algorithm>
#include <cmath>
#include <random>

using namespace echotest;

namespace
{
double densityAt(const MediumVolume& volume, const Vec3& point)
{
  const Vec3 p = point - volume.centre;
  Vec3 scaled(0.0);
  for (int i = 0; i < 3; ++i)
  {
    const Vec3& axis = volume.halfAxes[static_cast<std::size_t>(i)];
    scaled[i] = glm::dot(p, axis) / glm::dot(axis, axis);
  }
  switch (volume.shape)
  {
    case MediumShape::Layer:
    {
      const double height = glm::dot(p, volume.up);
      return height < volume.bottom ? 0.0
        : height <= volume.top      ? 1.0
        : volume.softness > 0.0     ? std::exp(-(height - volume.top) / volume.softness)
                                    : 0.0;
    }
    case MediumShape::Ellipsoid:
      return glm::dot(scaled, scaled) < 1.0 ? 1.0 : 0.0;
    default:
      return std::max({ std::fabs(scaled.x), std::fabs(scaled.y), std::fabs(scaled.z) }) < 1.0
        ? 1.0
        : 0.0;
  }
}
}

TEST(MediumVolume, CrossingsAreIntegralsOfTheDensity)
{
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<MediumVolume> volumes;
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.up = unitVector(Vec3(0.1, -0.05, 1.0));
  layer.top = 4.0;
  for (const double softness : { 0.0, 5.0, 5.0 })
  {
    layer.bottom = volumes.size() < 2 ? -8.0 : -Infinity;
    layer.softness = softness;
    volumes.push_back(layer);
  }
  MediumVolume turned = boxOf(Vec3(3.0, 1.0, -2.0), Vec3(1.0));
  turned.halfAxes = { 9.0 * unitVector(Vec3(1.0, 1.0, 0.0)), 4.0 * unitVector(Vec3(-1.0, 1.0, 0.0)),
    Vec3(0.0, 0.0, 6.0) };
  volumes.push_back(turned);
  turned.shape = MediumShape::Ellipsoid;
  volumes.push_back(turned);
  volumes.push_back(meshOf(boxOf(Vec3(3.0, 1.0, -2.0), Vec3(9.0, 4.0, 6.0))));
  MediumCrosser crosser;
  for (const MediumVolume& volume : volumes)
  {
    EXPECT_EQ(checkVolume(volume), "");
    int met = 0;
    for (int ray = 0; ray < 60; ++ray)
    {
      // Braces: in this order with every compiler.
      const Vec3 origin = 15.0 * Vec3{ uniform(random), uniform(random), uniform(random) };
      const Vec3 direction = unitVector(Vec3{ uniform(random), uniform(random), uniform(random) });
      constexpr double far = 40.0;
      constexpr int steps = 40000;
      std::vector<MediumCrossing> parts;
      crosser.find(volume, origin, direction, far, 0.0, parts);
      for (const double to : { 7.0, far })
      {
        const double sum = statistics::byMidpoints(
          0.0, to, steps, [&](double r) { return densityAt(volume, origin + r * direction); });
        double ours = 0.0;
        for (const MediumCrossing& part : parts)
        {
          ours += part.upTo(to);
        }
        EXPECT_NEAR(ours, sum, 4.0 * to / steps);
        met += sum > 0.0;
      }
    }
    EXPECT_GT(met, 6);
  }
}

TEST(MediumVolume, WhatMovesIsWhereItIsThen)
{
  MediumVolume box = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(5.0));
  box.velocity = Vec3(0.0, 2.0, 0.0);
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), 1e-3);
  MediumCrosser crosser;
  for (const auto& [seconds, isThere] : { std::pair(0.0, true), std::pair(10.0, false) })
  {
    EXPECT_EQ(mayMeet(box, frame, 1e3, seconds), isThere);
    std::vector<MediumCrossing> parts;
    crosser.find(box, Vec3(0.0), Vec3(1.0, 0.0, 0.0), 1e3, seconds, parts);
    EXPECT_EQ(parts.size(), isThere ? 1u : 0u);
  }
}

TEST(MediumVolume, BadOnesAreNamed)
{
  MediumVolume box = boxOf(Vec3(0.0), Vec3(0.0, 1.0, 1.0));
  EXPECT_EQ(checkVolume(box), "half an axis is 0, expected 1e-6 to 1e7 m");
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.bottom = 5.0;
  EXPECT_EQ(checkVolume(layer), "top is 0, expected above the bottom, at most 1e7 m");
  layer.bottom = -1.0;
  layer.softness = -1.0;
  EXPECT_EQ(checkVolume(layer), "softness is -1, expected 0 to 1e6 m");
  box = boxOf(Vec3(std::nan("")), Vec3(1.0));
  EXPECT_NE(checkVolume(box), "");
}
