// SPDX-License-Identifier: BSD-3-Clause
#include "MeshTools.h"

namespace benchmarks
{
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
    height += 0.004 * length * std::sin(2.0 * avianlidar::Pi * u / length) *
      std::cos(2.0 * avianlidar::Pi * v / (1.3 * length));
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
  scene.mesh = std::make_shared<TriangleMesh>();
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
  paintWall(scene);
  numberObjects(scene);
  return scene;
}
}
