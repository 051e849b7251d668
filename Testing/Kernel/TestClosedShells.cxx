// SPDX-License-Identifier: BSD-3-Clause
#include "ClosedShells.h"
#include "CollisionTreeBuilder.h"
#include "MediumTestScene.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <random>

namespace
{
using namespace avianlidar;

/// Boxes along y, each with points of its own; those with a bit in `flipped` are wound inward.
struct Boxes
{
  std::vector<std::array<double, 3>> all; ///< from and to along y, half width, m
  unsigned flipped = 0;
};

TriangleMesh meshOf(const Boxes& boxes)
{
  TriangleMesh mesh;
  for (std::size_t i = 0; i < boxes.all.size(); ++i)
  {
    const auto [from, to, half] = boxes.all[i];
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    const TriangleMesh box = echotest::trianglesOf(
      echotest::boxOf(Vec3(0.0, 0.5 * (from + to), 0.0), Vec3(half, 0.5 * (to - from), half)));
    mesh.points.insert(mesh.points.end(), box.points.begin(), box.points.end());
    for (const auto& [a, b, c] : box.triangles)
    {
      const bool isFlipped = boxes.flipped >> i & 1;
      mesh.triangles.push_back(
        { first + a, first + (isFlipped ? c : b), first + (isFlipped ? b : c) });
    }
  }
  return mesh;
}

/// Every triangle with three points of its own, as STL has them.
TriangleMesh soupOf(const TriangleMesh& mesh)
{
  TriangleMesh soup;
  for (const auto& t : mesh.triangles)
  {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    for (const std::uint32_t corner : t)
    {
      soup.points.push_back(mesh.points[corner]);
    }
    soup.triangles.push_back({ first, first + 1, first + 2 });
  }
  return soup;
}

/// The path along y in the shells of a mesh, m; the ray passes their axis at a distance.
double pathIn(const TriangleMesh& mesh, double x = 0.37, double z = -0.21)
{
  std::string problem;
  MediumVolume volume;
  volume.shape = MediumShape::Surface;
  volume.surface = buildCollisionTree(
    std::make_shared<TriangleMesh>(closedShells(mesh, problem)), TreeOptions{}, {}, 1);
  EXPECT_EQ(problem, "");
  std::vector<MediumCrossing> parts;
  MediumCrosser().find(volume, Vec3(x, 0.0, z), Vec3(0.0, 1.0, 0.0), 1e3, 0.0, parts);
  double path = 0.0;
  for (const MediumCrossing& part : parts)
  {
    path += part.end - part.begin;
  }
  return path;
}

TEST(ClosedShells, PathsDoNotDependOnTheWindingOfShells)
{
  const std::vector<std::pair<std::vector<std::array<double, 3>>, double>> cases = {
    { { { 50, 90, 5 } }, 40 }, { { { 50, 70, 5 }, { 80, 100, 5 } }, 40 },
    { { { 50, 90, 5 }, { 70, 110, 5 } }, 60 }, { { { 50, 70, 5 }, { 70, 90, 5 } }, 40 },
    { { { 50, 90, 5 }, { 50, 90, 5 } }, 40 }, { { { 50, 90, 5 }, { 50, 110, 5 } }, 60 },
    { { { 50, 70, 5 }, { 70, 90, 3 }, { 90, 95, 5 } }, 45 },
    { { { 50, 70, 5 }, { 60, 80, 4 }, { 75, 100, 5 } }, 50 }
  };
  for (const auto& [boxes, path] : cases)
  {
    for (unsigned flipped = 0; flipped < 1u << boxes.size(); ++flipped)
    {
      EXPECT_NEAR(pathIn(meshOf({ boxes, flipped })), path, 1e-9) << path << " " << flipped;
    }
  }
  EXPECT_NEAR(pathIn(soupOf(meshOf({ { { 50, 70, 5 }, { 70, 90, 5 } }, 2u }))), 40.0, 1e-9);
  EXPECT_NEAR(pathIn(soupOf(meshOf({ { { 50, 90, 5 }, { 50, 90, 5 } }, 2u }))), 40.0, 1e-9);
}

/// Each triangle is turned over or not, by chance; a ray through an edge meets two triangles.
TEST(ClosedShells, PathsDoNotDependOnTheWindingOfTriangles)
{
  std::mt19937 random(7);
  const TriangleMesh mesh = meshOf({ { { 50, 70, 5 }, { 70, 90, 5 }, { 120, 130, 2 } }, 0u });
  for (int turn = 0; turn < 50; ++turn)
  {
    TriangleMesh wound = mesh;
    for (auto& t : wound.triangles)
    {
      if (random() % 2)
      {
        std::swap(t[0], t[1]);
      }
    }
    EXPECT_NEAR(pathIn(wound), 50.0, 1e-9);
    EXPECT_NEAR(pathIn(soupOf(wound)), 50.0, 1e-9);
    EXPECT_NEAR(pathIn(wound, 0.0, 0.0), 50.0, 1e-9);
  }
}

TEST(ClosedShells, AShellInsideThatIsWoundTheOtherWayIsAHole)
{
  const std::vector<std::array<double, 3>> nested = { { 50, 110, 5 }, { 60, 100, 4 },
    { 70, 90, 3 } };
  for (unsigned flipped = 0; flipped < 8; ++flipped)
  {
    // The second is a hole, in which the third is an island; else the first fills all.
    const bool isHole = (flipped & 1) != (flipped >> 1 & 1);
    const double path = isHole ? 40.0 : 60.0;
    EXPECT_NEAR(pathIn(meshOf({ nested, flipped })), path, 1e-9) << flipped;
  }
}

/// A slot through a body: both its ends lie in the body's faces.
TEST(ClosedShells, AHoleMayTouchTheShellAboutIt)
{
  TriangleMesh mesh = meshOf({ { { 50, 110, 5 }, { 70, 90, 5 } }, 2u });
  for (std::size_t i = 8; i < 16; ++i)
  {
    mesh.points[i].x *= 0.6;
  }
  EXPECT_NEAR(pathIn(mesh), 40.0, 1e-9);
}

TEST(ClosedShells, WhatIsNotClosedIsNamed)
{
  std::string problem;
  TriangleMesh mesh = meshOf({ { { 50, 90, 5 } }, 0u });
  mesh.triangles.pop_back();
  EXPECT_TRUE(closedShells(mesh, problem).triangles.empty());
  statistics::expectSays(problem, "has 3 edges with one triangle");
  mesh = meshOf({ { { 50, 90, 5 } }, 0u });
  mesh.triangles.push_back({ 0, 1, 7 }); // a wall inside: three triangles on one edge
  closedShells(mesh, problem);
  statistics::expectSays(problem, "odd number");
  // The projective plane of six points: each edge has two triangles, and there is one side only.
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, 0 }, { 0, 1, 1 } };
  mesh.triangles = { { 0, 1, 2 }, { 0, 2, 3 }, { 0, 3, 4 }, { 0, 4, 5 }, { 0, 5, 1 }, { 1, 2, 4 },
    { 2, 3, 5 }, { 3, 4, 1 }, { 4, 5, 2 }, { 5, 1, 3 } };
  closedShells(mesh, problem);
  statistics::expectSays(problem, "has one side only");
}
}
