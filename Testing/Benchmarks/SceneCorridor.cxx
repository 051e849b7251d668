// SPDX-License-Identifier: BSD-3-Clause
#include "MeshTools.h"

namespace benchmarks
{
using avianlidar::Material;

namespace
{
// The paper's Table 1.
constexpr Material Wall;
constexpr Material Glass{ 0.020, 0.852, 8046.0 };
constexpr Material Metal{ 0.075, 0.634, 6803.0 };
constexpr Material Wood{ 0.107, 0.100, 82.0 };

/// All that has been added since the last call is of this material.
void paint(Scene& scene, const Material& material)
{
  scene.materials.resize(scene.mesh->size(), material);
}

/// A box without its turn: from a to b.
void addBlock(Scene& scene, const Vec3& a, const Vec3& b, const Material& material)
{
  const Vec3 middle = 0.5 * (a + b);
  addBox(*scene.mesh, middle.x, middle.y, 0.5 * (b - a), 0.0, a.z, b.z);
  paint(scene, material);
}

/// A round bar of metal from a to b of eight sides.
void addBar(Scene& scene, const Vec3& a, const Vec3& b, double radius)
{
  const Vec3 along = glm::normalize(b - a);
  const Vec3 aside =
    glm::normalize(glm::cross(along, std::fabs(along.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
  const Vec3 across = glm::cross(along, aside);
  constexpr int sides = 8;
  const auto around = [&](int k)
  {
    const double angle = 2.0 * avianlidar::Pi * (k % sides) / sides;
    return radius * (std::cos(angle) * aside + std::sin(angle) * across);
  };
  for (int k = 0; k < sides; ++k)
  {
    addQuad(*scene.mesh, a + around(k), a + around(k + 1), b + around(k + 1), b + around(k));
  }
  paint(scene, Metal);
}

void addStairs(Scene& scene)
{
  constexpr int steps = 9;
  constexpr double depth = 0.28;
  constexpr double rise = 0.165;
  for (int i = 0; i < steps; ++i)
  {
    const double y = -1.7 - i * depth;
    addBlock(scene, { 0.8, y - depth, 0.0 }, { 2.0, y, (i + 1) * rise }, Wall);
    const double back = -1.7 - (steps - i) * depth;
    const double z = (steps + i) * rise;
    addBlock(scene, { -0.6, back, z - 0.15 }, { 0.6, back + depth, z + rise }, Wall);
    addBar(scene, { 0.8, y, (i + 1) * rise }, { 0.8, y, (i + 1) * rise + 0.95 }, 0.015);
  }
  const double end = -1.7 - steps * depth;
  addBlock(scene, { -0.6, -5.2, steps * rise - 0.15 }, { 2.0, end, steps * rise }, Wall);
  addBar(scene, { 0.8, -1.7, 1.1 }, { 0.8, end, steps * rise + 0.95 }, 0.025);
  addBar(scene, { 0.6, end, steps * rise + 0.95 }, { 0.6, -1.7, 2 * steps * rise + 0.95 }, 0.025);
}

/// The south wall with the way to the stairs.
void addSouthWall(Scene& scene, double west, double east, double y, double ceiling)
{
  TriangleMesh& mesh = *scene.mesh;
  addQuad(mesh, { west, y, 0 }, { -0.6, y, 0 }, { -0.6, y, ceiling }, { west, y, ceiling });
  addQuad(mesh, { -0.6, y, 2.4 }, { 2.0, y, 2.4 }, { 2.0, y, ceiling }, { -0.6, y, ceiling });
  addQuad(mesh, { 2.0, y, 0 }, { east, y, 0 }, { east, y, ceiling }, { 2.0, y, ceiling });
  paint(scene, Wall);
  // Its doors stand in frames, 4 cm before the wall.
  for (const double x : { 6.0, 9.0, 12.0, 15.0, 18.0, 21.0 })
  {
    addBlock(scene, { x, y, 0.0 }, { x + 1.0, y + 0.04, 2.1 }, Wood);
    addBlock(scene, { x + 0.8, y + 0.04, 1.0 }, { x + 0.9, y + 0.1, 1.05 }, Metal);
  }
}
}

Scene makePaperCorridor()
{
  constexpr double west = -3.5;
  constexpr double east = 24.0;
  constexpr double side = 1.2;
  constexpr double ceiling = 2.8;
  Scene scene;
  scene.name = "corridor";
  scene.mesh = std::make_shared<TriangleMesh>();
  TriangleMesh& mesh = *scene.mesh;
  addQuad(mesh, { west, -side, 0 }, { east, -side, 0 }, { east, side, 0 }, { west, side, 0 });
  addQuad(mesh, { west, -side, ceiling }, { east, -side, ceiling }, { east, side, ceiling },
    { west, side, ceiling });
  addQuad(
    mesh, { west, side, 0 }, { east, side, 0 }, { east, side, ceiling }, { west, side, ceiling });
  addQuad(
    mesh, { west, -side, 0 }, { west, side, 0 }, { west, side, ceiling }, { west, -side, ceiling });
  addQuad(
    mesh, { east, -side, 0 }, { east, side, 0 }, { east, side, ceiling }, { east, -side, ceiling });
  paint(scene, Wall);
  addSouthWall(scene, west, east, -side, ceiling);
  addBlock(scene, { 1.0, side - 0.05, 0.9 }, { 3.2, side, 1.9 }, Glass); // bulletin board
  addBlock(scene, { west, -0.6, 0.0 }, { west + 0.04, 0.6, 2.1 }, Wood); // door
  addBlock(scene, { west, 0.7, 0.7 }, { west + 0.2, 1.05, 1.6 }, Glass); // cabinet
  addQuad(mesh, { -0.6, -side, 0 }, { -0.6, -5.2, 0 }, { -0.6, -5.2, 4.5 }, { -0.6, -side, 4.5 });
  addQuad(mesh, { 2.0, -side, 0 }, { 2.0, -5.2, 0 }, { 2.0, -5.2, 4.5 }, { 2.0, -side, 4.5 });
  addQuad(mesh, { -0.6, -5.2, 0 }, { 2.0, -5.2, 0 }, { 2.0, -5.2, 4.5 }, { -0.6, -5.2, 4.5 });
  addQuad(mesh, { -0.6, -5.2, 0 }, { 2.0, -5.2, 0 }, { 2.0, -side, 0 }, { -0.6, -side, 0 });
  paint(scene, Wall);
  addStairs(scene);
  scene.apex = Vec3(0.0, 0.0, 1.3);
  scene.pattern.channels = 16;
  scene.pattern.minimumElevation = -15.0;
  scene.pattern.elevationStep = 2.0;
  scene.pattern.azimuthStep = 2.0;
  scene.pattern.rotationRate = 10.0;
  scene.pattern.firingInterval = 5e-6;
  scene.sensor.pulseEnergy = 2.5e-4;
  scene.sensor.rangeGate = 200.0;
  scene.attenuationCoefficient = 8.8e-5;
  numberObjects(scene);
  return scene;
}

Scene makeCorridor()
{
  Scene scene = makePaperCorridor();
  scene.sensor = avianlidar::Sensor();
  scene.attenuationCoefficient = Scene().attenuationCoefficient;
  paintWall(scene);
  return scene;
}
}
