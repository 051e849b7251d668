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
}

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

AccuracyScene makeGlints(
  const std::string& name, const std::vector<double>& exponents, std::int64_t stride)
{
  std::vector<Material> materials;
  const auto addGlass =
    [&](TriangleMesh& mesh, std::size_t beam, const Vec3& direction, Numbers& random)
  {
    const double range = random(50.0, 200.0);
    const double tilt = random(0.0, 1.2 * 5.6e-3);
    const Vec3 aside = glm::normalize(glm::cross(direction, anyDirection(random)));
    const Vec3 normal = -std::cos(tilt) * direction + std::sin(tilt) * aside;
    addPlate(mesh, range * direction, normal, 4.0, 4.0, random);
    const Material glass{ 0.02, 0.852, exponents[beam / 40 % exponents.size()] };
    materials.insert(materials.end(), { glass, glass });
  };
  benchmarks::Scene scene = makeAboutBeams(name, 4, addGlass);
  scene.materials = materials;
  return prepareGrid(scene, stride);
}

AccuracyScene makeTwoGlints(std::int64_t stride)
{
  const auto addPair = [](TriangleMesh& mesh, std::size_t, const Vec3& direction, Numbers& random)
  {
    const Vec3 center = random(50.0, 200.0) * direction;
    const Vec3 edge = glm::normalize(glm::cross(direction, anyDirection(random)));
    for (const double side : { -1.0, 1.0 })
    {
      const double tilt = random(-1.2, 1.2) * 5.6e-3;
      const Vec3 normal =
        -std::cos(tilt) * direction + std::sin(tilt) * glm::cross(direction, edge);
      const Vec3 across = side * 4.0 * glm::cross(edge, normal);
      benchmarks::addQuad(mesh, center - 2.0 * edge, center + 2.0 * edge,
        center + 2.0 * edge + across, center - 2.0 * edge + across);
    }
  };
  benchmarks::Scene scene = makeAboutBeams("two glints", 5, addPair);
  scene.materials.assign(scene.mesh->size(), Material{ 0.02, 0.852, 1e6 });
  return prepareGrid(scene, stride);
}

namespace
{
/// Of so many metres to the sides, and the edge from which it goes on along `aside` (across the
/// direction) through `at`.
void addWallBeyond(
  TriangleMesh& mesh, const Vec3& direction, const Vec3& at, const Vec3& aside, double size)
{
  const Vec3 up = size * glm::cross(direction, aside);
  const Vec3 far = at + 2.0 * size * aside;
  benchmarks::addQuad(mesh, at - up, far - up, far + up, at + up);
}
}

AccuracyScene makeSmallTargets(std::int64_t stride)
{
  benchmarks::Scene scene;
  scene.name = "small targets";
  scene.mesh = std::make_shared<TriangleMesh>();
  Numbers random(6);
  const std::vector<Vec3> directions = gridDirections();
  for (std::size_t i = 0; i < directions.size(); ++i)
  {
    const Vec3& direction = directions[i];
    const double range = random(200.0, 600.0);
    const double width = 5.6e-3 * range; // of the beam, half
    const Vec3 aside = glm::normalize(glm::cross(direction, anyDirection(random)));
    const double radius = width * std::sqrt(0.002 * std::pow(40.0, random(0.0, 1.0)));
    const std::size_t kind = i % 5;
    const Vec3 offset = width * (kind == 3 ? 1.0 : random(0.0, 0.8)) * aside;
    const Vec3 center = range * direction + offset;
    if (i / 5 % 2 == 0)
    {
      const Vec3 normal = glm::normalize(-direction + 0.9 * anyDirection(random));
      const double turn = random(0.6, 1.0);
      addPlate(*scene.mesh, center, normal, 2.0 * radius * std::sin(turn),
        2.0 * radius * std::cos(turn), random);
    }
    else
    {
      const double half = radius / std::sqrt(3.0);
      benchmarks::addBox(*scene.mesh, center.x, center.y, Vec3(half, half, 0.0), random(0.0, Pi),
        center.z - half, center.z + half);
    }
    if (kind == 1 || kind == 2)
    {
      const double behind = range + (kind == 1 ? 30.0 : radius);
      addWallBeyond(
        *scene.mesh, direction, behind * direction - 4.0 * width * aside, aside, 4.0 * width);
    }
    if (kind == 4)
    {
      addWallBeyond(*scene.mesh, direction, (1.0 - 30.0 / range) * center, aside, 4.0 * width);
    }
  }
  benchmarks::paintWall(scene);
  AccuracyScene made = prepareGrid(scene, stride);
  made.setup.sensor.lowerEnergyLimit = 1e-8;
  finishSetup(made.setup);
  return made;
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
    entry.everyTarget = name != "Ingolstadt" && name != "Hongqiao, everything";
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
  scenes.push_back({ "corridor", corridor, true, 3, 1, true, true });
  scenes.push_back({ "edges", makeEdges, true, 1, 1, true, false });
  const auto addGlints = [&](const std::string& name, const std::vector<double>& exponents)
  {
    scenes.push_back(
      { name, [=](std::int64_t stride) { return makeGlints(name, exponents, stride); }, true, 3, 1,
        true, false });
  };
  addGlints("glints", { 112.0, 8046.0, 1e5, 1e6 });
  addGlints("narrow glints", { 1e6 });
  scenes.push_back({ "two glints", makeTwoGlints, true, 3, 1, true, false });
  scenes.push_back({ "small targets", makeSmallTargets, true, 4, 1, true, false, 5 });
  return scenes;
}
}
