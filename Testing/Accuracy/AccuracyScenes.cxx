// SPDX-License-Identifier: BSD-3-Clause
#include "AccuracyScenes.h"

#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "MeshTools.h"
#include "ScanRunner.h"

namespace accuracy
{
using namespace avianlidar;

namespace
{
using benchmarks::Numbers;

AccuracyScene prepare(const benchmarks::Scene& scene, std::int64_t stride)
{
  AccuracyScene made;
  made.name = scene.name;
  if (scene.mesh->size() == 0)
  {
    return made;
  }
  made.setup = benchmarks::makeSetup(scene, buildCollisionTree(scene.mesh, {}));
  made.setup.settings.noise = false;
  made.beams = benchmarks::makeBeams(scene, stride);
  return made;
}

AccuracyScene corridor(std::int64_t stride)
{
  AccuracyScene made = prepare(benchmarks::makeCorridor(), stride);
  made.setup.sensor.pulseEnergy = 2.5e-4;
  made.setup.sensor.rangeGate = 200.0;
  made.setup.settings.attenuationCoefficient = 8.8e-5;
  return made;
}

/// Airports and the street: the paper's airport scan with so many channels.
AccuracyScene sceneFile(
  const std::string& name, const std::string& file, int channels, std::int64_t stride)
{
  benchmarks::Scene scene = benchmarks::readScene(name, file);
  scene.pattern = benchmarks::airportPattern(channels);
  return prepare(scene, stride);
}

/// Beams in 40 columns and 24 rows, 9 and 3 degrees apart.
std::vector<Vec3> gridDirections()
{
  std::vector<Vec3> directions;
  for (int i = 0; i < 960; ++i)
  {
    const double azimuth = 9.0 * (i % 40) * Pi / 180.0;
    const double elevation = (3.0 * (i / 40) - 34.5) * Pi / 180.0;
    directions.emplace_back(std::sin(azimuth) * std::cos(elevation),
      std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
  }
  return directions;
}

Vec3 anyDirection(Numbers& random)
{
  const double z = random(-1.0, 1.0);
  const double turn = random(0.0, 2.0 * Pi);
  const double r = std::sqrt(1.0 - z * z);
  return { r * std::cos(turn), r * std::sin(turn), z };
}

void addPlate(TriangleMesh& mesh, const Vec3& center, const Vec3& normal, double width,
  double height, Numbers& random)
{
  const Vec3 u = glm::normalize(glm::cross(normal, anyDirection(random)));
  const Vec3 v = glm::cross(normal, u);
  benchmarks::addQuad(mesh, center - 0.5 * width * u - 0.5 * height * v,
    center + 0.5 * width * u - 0.5 * height * v, center + 0.5 * width * u + 0.5 * height * v,
    center - 0.5 * width * u + 0.5 * height * v);
}

/// A scene of surfaces about the axis of each beam of the grid, without materials. @param addAbout
/// is called with the mesh, the number and the direction of a beam, and random numbers
template <class AddAbout>
benchmarks::Scene makeAboutBeams(const std::string& name, int seed, AddAbout addAbout)
{
  benchmarks::Scene scene;
  scene.name = name;
  scene.apex = Vec3(0.0);
  scene.mesh = std::make_shared<TriangleMesh>();
  Numbers random(seed);
  const std::vector<Vec3> directions = gridDirections();
  for (std::size_t i = 0; i < directions.size(); ++i)
  {
    addAbout(*scene.mesh, i, directions[i], random);
  }
  return scene;
}

/// Every `stride`-th beam of the grid.
AccuracyScene prepareGrid(benchmarks::Scene& scene, std::int64_t stride)
{
  benchmarks::numberObjects(scene);
  AccuracyScene made = prepare(scene, stride);
  made.beams = {};
  const std::vector<Vec3> directions = gridDirections();
  for (std::size_t i = 0; i < directions.size(); i += static_cast<std::size_t>(stride))
  {
    made.beams.ids.push_back(i);
    made.beams.origins.push_back(scene.apex);
    made.beams.directions.push_back(directions[i]);
  }
  return made;
}

/// 960 beams with three plates of 0.2 to 8 m near the axis of each, every way turned, 40 to 300 m
/// away: hardly a beam meets no edge.
AccuracyScene makeEdges(std::int64_t stride)
{
  // Beside the axis, covering more or less of the beam.
  const auto addPlates = [](TriangleMesh& mesh, std::size_t, const Vec3& direction, Numbers& random)
  {
    for (int k = 0; k < 3; ++k)
    {
      const double range = random(40.0, 300.0);
      const double width = 0.2 * std::pow(40.0, random(0.0, 1.0));
      const double height = 0.2 * std::pow(40.0, random(0.0, 1.0));
      const Vec3 normal = glm::normalize(-direction + 0.9 * anyDirection(random));
      const double aside = 0.5 * std::min(width, height) + 5.6e-3 * range * random(-1.0, 0.7);
      const Vec3 offset = aside * glm::normalize(glm::cross(direction, anyDirection(random)));
      addPlate(mesh, range * direction + offset, normal, width, height, random);
    }
  };
  benchmarks::Scene scene = makeAboutBeams("edges", 3, addPlates);
  benchmarks::paintWall(scene);
  return prepareGrid(scene, stride);
}

/// 960 beams, each filled by a plate of its own that mirrors it back to within 1.2 half-beamwidths;
/// glass of three exponents in turn. At 112 the lobe is eight times as wide as the beam, at 1e5 a
/// quarter of it.
AccuracyScene makeGlints(std::int64_t stride)
{
  constexpr double exponents[] = { 112.0, 8046.0, 1e5 };
  std::vector<Material> materials;
  const auto addGlass =
    [&](TriangleMesh& mesh, std::size_t beam, const Vec3& direction, Numbers& random)
  {
    const double range = random(50.0, 200.0);
    const double tilt = random(0.0, 1.2 * 5.6e-3);
    const Vec3 aside = glm::normalize(glm::cross(direction, anyDirection(random)));
    const Vec3 normal = -std::cos(tilt) * direction + std::sin(tilt) * aside;
    addPlate(mesh, range * direction, normal, 4.0, 4.0, random);
    const Material glass{ 0.02, 0.852, exponents[beam / 40 % 3] };
    materials.insert(materials.end(), { glass, glass });
  };
  benchmarks::Scene scene = makeAboutBeams("glints", 4, addGlass);
  scene.materials = materials;
  return prepareGrid(scene, stride);
}

}

std::vector<AccuracySceneEntry> accuracyScenes()
{
  const std::string shipped =
    std::string(AVIANLIDAR_SOURCE_DIR) + "/Examples/airport/scene/hongqiao.lidarscene.json";
  const auto data = [](const std::string& file)
  { return std::string(AVIANLIDAR_SCENES_DIR) + "/" + file + ".lidarscene.json"; };
  std::vector<AccuracySceneEntry> scenes;
  const auto add = [&](const std::string& name, const std::string& file, int channels)
  {
    AccuracySceneEntry& entry = scenes.emplace_back();
    entry.name = name;
    entry.make = [=](std::int64_t stride) { return sceneFile(name, file, channels, stride); };
  };
  add("Hongqiao, 16 channels", shipped, 16);
  scenes.back().shipped = true;
  scenes.back().checkStride = 4;
  scenes.back().everyNumberOfRays = true;
  add("Hongqiao, 32 channels", shipped, 32);
  scenes.back().stride = 2;
  add("Hongqiao, everything", data("zsss_all"), 16);
  add("Honolulu", data("phnl"), 16);
  add("Ingolstadt", data("ingolstadt"), 16);
  scenes.back().stride = 4;
  scenes.push_back({ "corridor", corridor, true, 3, 1, true });
  scenes.push_back({ "edges", makeEdges, true, 1, 1, true });
  scenes.push_back({ "glints", makeGlints, true, 3, 1, true });
  return scenes;
}
}
