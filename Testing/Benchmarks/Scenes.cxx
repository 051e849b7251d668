// SPDX-License-Identifier: BSD-3-Clause
#include "Scenes.h"

#include "GeometryTestScene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>

namespace benchmarks
{
using avianlidar::Material;
using avianlidar::Pi;
using geometrytest::Numbers;

namespace
{
/// Two triangles that share the diagonal a-c.
void addQuad(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d)
{
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), { a, b, c, d });
  mesh.triangles.push_back({ n, n + 1, n + 2 });
  mesh.triangles.push_back({ n, n + 2, n + 3 });
}

/// A level or upright rectangle between the opposite corners a and c.
void addRectangle(TriangleMesh& mesh, const Vec3& a, const Vec3& c)
{
  const bool level = a.z == c.z;
  addQuad(mesh, a, { c.x, level ? a.y : c.y, a.z }, c, { a.x, level ? c.y : a.y, c.z });
}

/// Twelve triangles over eight points: `half` along x and y turned by `yaw`, z from `low` to
/// `high`.
void addBox(TriangleMesh& mesh, double x, double y, Vec3 half, double yaw, double low, double high)
{
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  for (int k = 0; k < 8; ++k)
  {
    const double u = k & 1 ? half.x : -half.x;
    const double v = k & 2 ? half.y : -half.y;
    mesh.points.emplace_back(x + c * u - s * v, y + s * u + c * v, k & 4 ? high : low);
  }
  static const std::uint32_t faces[6][4] = { { 0, 1, 5, 4 }, { 1, 3, 7, 5 }, { 3, 2, 6, 7 },
    { 2, 0, 4, 6 }, { 4, 5, 7, 6 }, { 0, 2, 3, 1 } };
  for (const auto& f : faces)
  {
    mesh.triangles.push_back({ n + f[0], n + f[1], n + f[2] });
    mesh.triangles.push_back({ n + f[0], n + f[2], n + f[3] });
  }
}

/// Each quad, box, part of a sphere or ground is an object: its points lie behind all those before.
void numberObjects(Scene& scene)
{
  std::int64_t last = -1; // point
  int object = -1;
  scene.objectIds.clear();
  for (const auto& corners : scene.mesh->triangles)
  {
    const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
    object += static_cast<std::int64_t>(*least) > last ? 1 : 0;
    last = std::max<std::int64_t>(last, *most);
    scene.objectIds.push_back(object);
  }
}

/// Every triangle is the paper's wall.
Scene allWall(Scene scene)
{
  scene.materials.assign(scene.mesh->size(), Material{});
  numberObjects(scene);
  return scene;
}
}

avianlidar::ScanPattern airportPattern(int channels)
{
  avianlidar::ScanPattern pattern;
  pattern.channels = channels;
  pattern.elevationStep = 6.0 / channels;
  pattern.azimuthStep = 6.0 / channels;
  return pattern;
}

Scene makeBoxes(int boxes)
{
  constexpr double reach = 3000.0;
  Scene scene;
  scene.name = "boxes " + std::to_string(boxes);
  scene.apex = Vec3(0.0, 0.0, 3.0);
  scene.pattern = airportPattern(16);
  addRectangle(*scene.mesh, { -reach, -reach, 0.0 }, { reach, reach, 0.0 });
  // A hundred times more boxes are ten times smaller in plan: the same share of the ground is built
  // on.
  const double size = 20.0 * std::sqrt(500.0 / boxes);
  Numbers random(1);
  for (int made = 0; made < boxes;)
  {
    const double x = random(-reach, reach);
    const double y = random(-reach, reach);
    const Vec3 half(random(0.25, 1.75) * size, random(0.25, 1.75) * size, 0.0);
    const double yaw = random(0.0, Pi);
    const double height = random(4.0, 40.0);
    if (std::hypot(x, y) < 100.0)
    {
      continue; // not around the lidar
    }
    addBox(*scene.mesh, x, y, half, yaw, 0.0, height);
    ++made;
  }
  return allWall(std::move(scene));
}

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
    const double angle = 2.0 * Pi * (k % sides) / sides;
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

/// Walls between opposite corners.
void addWalls(Scene& scene, std::initializer_list<std::pair<Vec3, Vec3>> corners)
{
  for (const auto& [a, c] : corners)
  {
    addRectangle(*scene.mesh, a, c);
  }
  paint(scene, Wall);
}
}

Scene makePaperCorridor()
{
  constexpr double west = -3.5;
  constexpr double east = 24.0;
  constexpr double side = 1.2;
  constexpr double top = 2.8;
  Scene scene;
  scene.name = "corridor";
  // In the south wall is the way to the stairs.
  addWalls(scene,
    { { { west, -side, 0 }, { east, side, 0 } }, { { west, -side, top }, { east, side, top } },
      { { west, side, 0 }, { east, side, top } }, { { west, -side, 0 }, { west, side, top } },
      { { east, -side, 0 }, { east, side, top } }, { { west, -side, 0 }, { -0.6, -side, top } },
      { { -0.6, -side, 2.4 }, { 2.0, -side, top } }, { { 2.0, -side, 0 }, { east, -side, top } } });
  // Its doors stand in frames, 4 cm before the wall.
  for (const double x : { 6.0, 9.0, 12.0, 15.0, 18.0, 21.0 })
  {
    addBlock(scene, { x, -side, 0.0 }, { x + 1.0, -side + 0.04, 2.1 }, Wood);
    addBlock(scene, { x + 0.8, -side + 0.04, 1.0 }, { x + 0.9, -side + 0.1, 1.05 }, Metal);
  }
  addBlock(scene, { 1.0, side - 0.05, 0.9 }, { 3.2, side, 1.9 }, Glass); // bulletin board
  addBlock(scene, { west, -0.6, 0.0 }, { west + 0.04, 0.6, 2.1 }, Wood); // door
  addBlock(scene, { west, 0.7, 0.7 }, { west + 0.2, 1.05, 1.6 }, Glass); // cabinet
  addWalls(scene,
    { { { -0.6, -side, 0 }, { -0.6, -5.2, 4.5 } }, { { 2.0, -side, 0 }, { 2.0, -5.2, 4.5 } },
      { { -0.6, -5.2, 0 }, { 2.0, -5.2, 4.5 } }, { { -0.6, -5.2, 0 }, { 2.0, -side, 0 } } });
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
  scene.sensor = {};
  scene.attenuationCoefficient = Scene().attenuationCoefficient;
  return allWall(std::move(scene));
}

namespace
{
/// One face of an octahedron with the corners p, q, r (unit vectors), divided in n^2 triangles, on
/// the unit sphere.
void addFace(TriangleMesh& mesh, const Vec3& p, const Vec3& q, const Vec3& r, std::uint32_t n)
{
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (std::uint32_t i = 0; i <= n; ++i)
  {
    for (std::uint32_t j = 0; j <= i; ++j)
    {
      // The same bits from both faces at an edge: corners that carry no weight add exact zeros, and
      // the sum of two does not depend on their order.
      const Vec3 sum = double(n - i) * p + (double(i - j) * q + double(j) * r);
      mesh.points.push_back(sum / glm::length(sum));
    }
  }
  const auto number = [&](std::uint32_t i, std::uint32_t j) { return first + i * (i + 1) / 2 + j; };
  for (std::uint32_t i = 0; i < n; ++i)
  {
    for (std::uint32_t j = 0; j <= i; ++j)
    {
      mesh.triangles.push_back({ number(i, j), number(i + 1, j), number(i + 1, j + 1) });
      if (j < i)
      {
        mesh.triangles.push_back({ number(i, j), number(i + 1, j + 1), number(i, j + 1) });
      }
    }
  }
}
}

Scene makeSphere(std::size_t triangles)
{
  const auto n = static_cast<std::uint32_t>(
    std::max(1.0, std::round(std::sqrt(static_cast<double>(triangles) / 8.0))));
  Scene scene;
  scene.name = "sphere " + std::to_string(triangles);
  scene.mesh->triangles.reserve(8 * std::size_t(n) * n);
  for (int octant = 0; octant < 8; ++octant)
  {
    const Vec3 x(octant & 1 ? -1.0 : 1.0, 0.0, 0.0);
    const Vec3 y(0.0, octant & 2 ? -1.0 : 1.0, 0.0);
    const Vec3 z(0.0, 0.0, octant & 4 ? -1.0 : 1.0);
    addFace(*scene.mesh, x, y, z, n);
  }
  // Turned, so that none of its edges lies along the scan.
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  for (Vec3& p : scene.mesh->points)
  {
    p = Vec3(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
    p = Vec3(p.x, c * p.y - s * p.z, s * p.y + c * p.z);
    p = 30.0 * p + Vec3(0.0, 100.0, 0.0);
  }
  avianlidar::ScanPattern& pattern = scene.pattern;
  pattern.channels = 120;
  pattern.elevationStep = 0.3125;
  pattern.minimumElevation = -0.3125 * 59.5;
  pattern.azimuthStep = 0.3125;
  pattern.azimuthStart = -20.0;
  pattern.azimuthEnd = 20.0;
  pattern.firingInterval = 1e-6;
  return allWall(std::move(scene));
}

namespace
{
/// A front of loggias from `start` on: open boxes of back, floor, ceiling and two sides.
void addFront(TriangleMesh& mesh, const Vec3& start, const Vec3& along, const Vec3& inward,
  int columns, int rows)
{
  const Vec3 right = 3.0 * along; // m
  const Vec3 up(0.0, 0.0, 3.0);
  const Vec3 in = 1.5 * inward;
  for (int i = 0; i < columns; ++i)
  {
    for (int j = 0; j < rows; ++j)
    {
      const Vec3 a = start + double(i) * right + double(j) * up;
      addQuad(mesh, a + in, a + right + in, a + right + up + in, a + up + in);
      addQuad(mesh, a, a + right, a + right + in, a + in);
      addQuad(mesh, a + up, a + right + up, a + right + up + in, a + up + in);
      addQuad(mesh, a, a + up, a + up + in, a + in);
      addQuad(mesh, a + right, a + right + up, a + right + up + in, a + right + in);
    }
  }
}
}

Scene makeLoggias()
{
  Scene scene;
  scene.name = "loggias";
  const Vec3 east(1.0, 0.0, 0.0);
  const Vec3 north(0.0, 1.0, 0.0);
  addFront(*scene.mesh, { -60.0, 80.0, 0.0 }, east, north, 40, 6);
  addFront(*scene.mesh, { -60.0, -10.0, 0.0 }, north, -east, 30, 6);
  addFront(*scene.mesh, { 60.0, -10.0, 0.0 }, north, east, 30, 6);
  scene.apex = Vec3(0.0, 0.0, 3.0);
  scene.pattern = airportPattern(16);
  return allWall(std::move(scene));
}

namespace
{
/// Height of the ground, m: waves of 600 m to 15 m, lower the shorter they are.
double heightAt(double x, double y)
{
  double height = 0.0;
  double length = 600.0;
  double turn = 0.4;
  for (int octave = 0; octave < 6; ++octave)
  {
    const double u = std::cos(turn) * x + std::sin(turn) * y;
    const double v = std::cos(turn) * y - std::sin(turn) * x;
    height +=
      0.004 * length * std::sin(2.0 * Pi * u / length) * std::cos(2.0 * Pi * v / (1.3 * length));
    length /= 2.1;
    turn += 1.1;
  }
  return height;
}
}

Scene makeTerrain()
{
  constexpr std::uint32_t cells = 708; // 2 x 708^2 triangles
  constexpr double reach = 2000.0;
  Scene scene;
  scene.name = "terrain";
  TriangleMesh& mesh = *scene.mesh;
  for (std::uint32_t i = 0; i <= cells; ++i)
  {
    for (std::uint32_t j = 0; j <= cells; ++j)
    {
      const double x = -reach + 2.0 * reach * i / cells;
      const double y = -reach + 2.0 * reach * j / cells;
      mesh.points.emplace_back(x, y, heightAt(x, y));
    }
  }
  const auto number = [](std::uint32_t i, std::uint32_t j) { return i * (cells + 1) + j; };
  for (std::uint32_t i = 0; i < cells; ++i)
  {
    for (std::uint32_t j = 0; j < cells; ++j)
    {
      mesh.triangles.push_back({ number(i, j), number(i + 1, j), number(i + 1, j + 1) });
      mesh.triangles.push_back({ number(i, j), number(i + 1, j + 1), number(i, j + 1) });
    }
  }
  scene.apex = Vec3(0.0, 0.0, heightAt(0.0, 0.0) + 3.0);
  scene.pattern = airportPattern(16);
  scene.pattern.minimumElevation = -1.5;
  scene.pattern.elevationStep = 0.1;
  return allWall(std::move(scene));
}
}
