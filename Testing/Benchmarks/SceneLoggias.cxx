// SPDX-License-Identifier: BSD-3-Clause
#include "MeshTools.h"

namespace benchmarks
{
namespace
{
constexpr double Cell = 3.0;  // m, width and height of a loggia
constexpr double Depth = 1.5; // m

/// An open box: back, floor, ceiling and two sides. `a` is its lower corner at the front.
void addLoggia(TriangleMesh& mesh, const Vec3& a, const Vec3& along, const Vec3& inward)
{
  const Vec3 right = Cell * along;
  const Vec3 up(0.0, 0.0, Cell);
  const Vec3 in = Depth * inward;
  addQuad(mesh, a + in, a + right + in, a + right + up + in, a + up + in);
  addQuad(mesh, a, a + right, a + right + in, a + in);
  addQuad(mesh, a + up, a + right + up, a + right + up + in, a + up + in);
  addQuad(mesh, a, a + up, a + up + in, a + in);
  addQuad(mesh, a + right, a + right + up, a + right + up + in, a + right + in);
}

/// A front of loggias from `start` on.
void addFront(TriangleMesh& mesh, const Vec3& start, const Vec3& along, const Vec3& inward,
  int columns, int rows)
{
  for (int i = 0; i < columns; ++i)
  {
    for (int j = 0; j < rows; ++j)
    {
      const Vec3 place = double(i) * along + Vec3(0.0, 0.0, j);
      addLoggia(mesh, start + Cell * place, along, inward);
    }
  }
}
}

Scene makeLoggias()
{
  Scene scene;
  scene.name = "loggias";
  scene.mesh = std::make_shared<TriangleMesh>();
  const Vec3 east(1.0, 0.0, 0.0);
  const Vec3 north(0.0, 1.0, 0.0);
  addFront(*scene.mesh, { -60.0, 80.0, 0.0 }, east, north, 40, 6);
  addFront(*scene.mesh, { -60.0, -10.0, 0.0 }, north, -east, 30, 6);
  addFront(*scene.mesh, { 60.0, -10.0, 0.0 }, north, east, 30, 6);
  scene.apex = Vec3(0.0, 0.0, 3.0);
  scene.pattern = airportPattern(16);
  paintWall(scene);
  numberObjects(scene);
  return scene;
}
}
