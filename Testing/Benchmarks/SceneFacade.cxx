// SPDX-License-Identifier: BSD-3-Clause
#include "MeshTools.h"

namespace benchmarks
{
namespace
{
constexpr double Distance = 150.0;
constexpr double Width = 200.0;
constexpr double Height = 40.0;

/// A bay of 4 m with a window set back by 0.2 m: ten triangles.
void addBay(TriangleMesh& mesh, double x, double z)
{
  constexpr double y = Distance;
  const Vec3 a(x, y, z);
  const Vec3 b(x + 4.0, y, z);
  const Vec3 c(x + 4.0, y, z + 4.0);
  const Vec3 d(x, y, z + 4.0);
  const Vec3 p(x + 1.0, y + 0.2, z + 1.0);
  const Vec3 q(x + 3.0, y + 0.2, z + 1.0);
  const Vec3 r(x + 3.0, y + 0.2, z + 3.0);
  const Vec3 s(x + 1.0, y + 0.2, z + 3.0);
  addQuad(mesh, a, b, q, p);
  addQuad(mesh, b, c, r, q);
  addQuad(mesh, c, d, s, r);
  addQuad(mesh, d, a, p, s);
  addQuad(mesh, p, q, r, s);
}
}

Scene makeFacade(std::size_t triangles)
{
  Scene scene;
  scene.name = "facade " + std::to_string(triangles);
  scene.mesh = std::make_shared<TriangleMesh>();
  TriangleMesh& mesh = *scene.mesh;
  for (double x = -0.5 * Width; x < 0.5 * Width; x += 4.0)
  {
    for (double z = -0.5 * Height; z < 0.5 * Height; z += 4.0)
    {
      addBay(mesh, x, z);
    }
  }
  // Inside the shadow of the facade, in the same room whatever their number.
  Numbers random(2);
  while (mesh.triangles.size() + 12 <= triangles)
  {
    const double y = random(Distance + 5.0, 4.0 * Distance);
    const double x = random(-0.45, 0.45) * Width * y / Distance;
    const double z = random(-0.45, 0.45) * Height * y / Distance;
    const double half = random(0.2, 1.0);
    addBox(mesh, x, y, Vec3(half, half, 0.0), random(0.0, avianlidar::Pi), z - half, z + half);
  }
  // Every beam of the scan falls on the facade, with its whole width.
  avianlidar::ScanPattern& pattern = scene.pattern;
  pattern.channels = 32;
  pattern.minimumElevation = -5.5;
  pattern.elevationStep = 11.0 / 31.0;
  pattern.azimuthStart = -30.0;
  pattern.azimuthEnd = 30.0;
  pattern.azimuthStep = 0.125;
  paintWall(scene);
  numberObjects(scene);
  return scene;
}
}
