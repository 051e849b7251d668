// SPDX-License-Identifier: BSD-3-Clause
// Many triangles: the memory that they take. Many beams and threads are TestScan's.
//
// The environment variable AVIANLIDAR_STABILITY_TRIANGLES asks for another number of triangles than
// the half million of an ordinary run.
#include "Memory.h"
#include "Sanitized.h"
#include "ScanTestTown.h"
#include "StabilityTable.h"

#include <string>

using namespace echotest;
using stability::record;

namespace
{
/// Hills of about so many triangles in a square of 4 km.
Scene hills(std::size_t triangles)
{
  const auto side = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0)) + 1;
  Scene scene;
  scene.mesh->points.reserve(static_cast<std::size_t>(side + 1) * (side + 1));
  const double step = 4000.0 / side;
  for (std::uint32_t i = 0; i <= side; ++i)
  {
    for (std::uint32_t j = 0; j <= side; ++j)
    {
      const double x = -2000.0 + step * i;
      const double y = -2000.0 + step * j;
      scene.mesh->points.push_back(
        { x, y, -30.0 + 28.0 * std::sin(0.01 * x) * std::cos(0.013 * y) });
    }
  }
  scene.mesh->triangles.reserve(2 * static_cast<std::size_t>(side) * side);
  for (std::uint32_t i = 0; i < side; ++i)
  {
    for (std::uint32_t j = 0; j < side; ++j)
    {
      const std::uint32_t a = i * (side + 1) + j;
      const std::uint32_t b = a + side + 1;
      scene.mesh->triangles.push_back({ a, b, b + 1 });
      scene.mesh->triangles.push_back({ a, b + 1, a + 1 });
    }
  }
  scene.materials.assign(scene.mesh->size(), Wall);
  scene.objects.assign(scene.mesh->size(), 0);
  return scene;
}
}

TEST(StabilitySize, ManyTriangles)
{
  const std::size_t wanted =
    casesAskedFor("AVIANLIDAR_STABILITY_TRIANGLES", IsSanitized ? 25000 : 500000);
  const std::size_t before = benchmarks::heapBytes();
  const Scene scene = hills(wanted);
  const double count = static_cast<double>(scene.mesh->size());
  const std::size_t withMesh = benchmarks::heapBytes();
  benchmarks::resetPeak();
  const std::size_t resident = benchmarks::residentBytes();
  const ScanSetup setup = makeSetup(scene, Sensor(), EchoSettings());
  const std::size_t peak = benchmarks::peakBytes();
  const std::size_t withTree = benchmarks::heapBytes();
  ScanBeams beams = horizon(480, 16);
  for (Vec3& d : beams.directions)
  {
    d.z -= 0.12;
  }
  const ScanResult result = runScan(setup, beams, 2);
  EXPECT_GT(result.echoes.size(), 100u);
  const std::string range = std::to_string(scene.mesh->size()) + " triangles";
  if (!IsSanitized)
  {
    record({ "Triangles", range, "-", "bytes a triangle: mesh, materials and ids, as given", 100.0,
      static_cast<double>(withMesh - before) / count });
    record(
      { "Triangles", range, "-", "bytes a triangle that are added: tree, materials and ids as kept",
        150.0, static_cast<double>(withTree - withMesh) / count });
    record({ "Triangles", range, "-", "bytes a triangle at the peak of building", 300.0,
      static_cast<double>(peak > resident ? peak - resident : 0) / count });
  }
  std::size_t broken = 0;
  for (const Echo& echo : result.echoes)
  {
    broken += !(echo.range > 0.0 && echo.range < 4000.0 && echo.returnEnergy <= 0.2 * 3.6e-4);
  }
  record({ "Triangles", range, "default", "echoes outside the gate or of more than (kd + ks) Qs",
    0.0, static_cast<double>(broken) });
}
