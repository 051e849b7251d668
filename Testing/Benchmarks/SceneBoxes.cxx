// SPDX-License-Identifier: BSD-3-Clause
#include "MeshTools.h"

namespace benchmarks
{
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
  scene.mesh = std::make_shared<TriangleMesh>();
  scene.apex = Vec3(0.0, 0.0, 3.0);
  scene.pattern = airportPattern(16);
  addQuad(*scene.mesh, { -reach, -reach, 0.0 }, { reach, -reach, 0.0 }, { reach, reach, 0.0 },
    { -reach, reach, 0.0 });
  // A hundred times more boxes are ten times smaller in plan: the same share of the ground is built
  // on.
  const double size = 20.0 * std::sqrt(500.0 / boxes);
  Numbers random(1);
  for (int made = 0; made < boxes;)
  {
    const double x = random(-reach, reach);
    const double y = random(-reach, reach);
    const Vec3 half(random(0.25, 1.75) * size, random(0.25, 1.75) * size, 0.0);
    const double yaw = random(0.0, avianlidar::Pi);
    const double height = random(4.0, 40.0);
    if (std::hypot(x, y) < 100.0)
    {
      continue; // not around the lidar
    }
    addBox(*scene.mesh, x, y, half, yaw, 0.0, height);
    ++made;
  }
  paintWall(scene);
  numberObjects(scene);
  return scene;
}
}
