// SPDX-License-Identifier: BSD-3-Clause
// Small scenes and scans of one or many beams for the tests of the echo method.
#ifndef EchoTestScene_h
#define EchoTestScene_h

#include "FinishSetup.h"
#include "Scan.h"
#include "VolumeTree.h"

#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

namespace echotest
{
using namespace avianlidar;

constexpr double Degree = Pi / 180.0;
const Material Wall{ 0.146, 0.054, 112.0 };
const Material Glass{ 0.020, 0.852, 8046.0 };
const Material Metal{ 0.075, 0.634, 6803.0 };
const Material Wood{ 0.107, 0.100, 82.0 };

/// A mesh with a material and an object on every triangle.
struct Scene
{
  std::shared_ptr<TriangleMesh> mesh = std::make_shared<TriangleMesh>();
  std::vector<Material> materials;
  std::vector<int> objects;

  void triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Material& m, int object)
  {
    const auto first = static_cast<std::uint32_t>(this->mesh->points.size());
    for (const Vec3& p : { a, b, c })
    {
      this->mesh->points.push_back(p);
    }
    this->mesh->triangles.push_back({ first, first + 1, first + 2 });
    this->materials.push_back(m);
    this->objects.push_back(object);
  }

  /// Parallelogram about a centre.
  void plate(const Vec3& center, const Vec3& u, const Vec3& v, const Material& m, int object = 0)
  {
    this->triangle(center - u - v, center + u - v, center + u + v, m, object);
    this->triangle(center - u - v, center + u + v, center - u + v, m, object);
  }

  /// Square across the direction x.
  void square(const Vec3& center, double half, const Material& m, int object = 0)
  {
    this->plate(center, Vec3(0.0, half, 0.0), Vec3(0.0, 0.0, half), m, object);
  }

  void box(const Vec3& center, const Vec3& half, const Material& m, int object)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int side : { -1, 1 })
      {
        Vec3 normal(0.0), u(0.0), v(0.0);
        normal[axis] = side * half[axis];
        u[(axis + 1) % 3] = half[(axis + 1) % 3];
        v[(axis + 2) % 3] = half[(axis + 2) % 3];
        this->plate(center + normal, u, v, m, object);
      }
    }
  }
};

/// A square across the axis x, `range` metres from the lidar.
inline Scene squareAt(double range, double half, const Material& m, int object = 0)
{
  Scene scene;
  scene.square(Vec3(range, 0.0, 0.0), half, m, object);
  return scene;
}

/// A scene with a mesh of its own: other copies of a scene share it.
inline Scene copyOf(Scene scene)
{
  scene.mesh = std::make_shared<TriangleMesh>(*scene.mesh);
  return scene;
}

/// A scene with other points.
template <class Change>
Scene changed(const Scene& scene, Change change)
{
  Scene result = copyOf(scene);
  for (Vec3& p : result.mesh->points)
  {
    p = change(p);
  }
  return result;
}

/// The sensor of the closed forms: everything falls into one range unit, and nothing is cut off.
inline Sensor openSensor(double halfBeamwidth = 5.6e-3)
{
  Sensor sensor;
  sensor.halfBeamwidth = halfBeamwidth;
  sensor.samplingInterval = 1e-3;
  sensor.pulseWidth = 0.0;
  sensor.rangeGate = 1e6;
  sensor.lowerEnergyLimit = 0.0;
  sensor.upperEnergyLimit = 1.0;
  return sensor;
}

/// Where the samples of a beam come from.
constexpr BeamSampleSource BothSources[] = { BeamSampleSource::Cells, BeamSampleSource::Rays };

/// Rays without anything else.
inline EchoSettings directSettings(int rays)
{
  EchoSettings settings;
  settings.raysPerBeam = rays;
  settings.beamSamples = BeamSampleSource::Rays;
  settings.attenuationCoefficient = 0.0;
  settings.numberOfReflections = 1;
  settings.noise = false;
  return settings;
}

/// The same without rays, where beams need none.
inline EchoSettings inCells(int rays = 100, int seed = EchoSettings().seed)
{
  EchoSettings settings = directSettings(rays);
  settings.beamSamples = BeamSampleSource::Cells;
  settings.seed = seed;
  return settings;
}

/// Replace shared elements by a changed copy.
template <class T, class Change>
void edit(SharedVector<T>& values, Change change)
{
  std::vector<T> copy;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    copy.push_back(values[i]);
  }
  change(copy);
  values = copy;
}

inline ScanSetup makeSetup(const Scene& scene, const Sensor& sensor, const EchoSettings& settings,
  const TreeOptions& options = {})
{
  ScanSetup setup;
  setup.tree = buildVolumeTree(scene.mesh, options);
  setup.materials = scene.materials;
  setup.objectIds = scene.objects;
  setup.materialIds = std::vector<int>(scene.materials.size(), 0);
  setup.sensor = sensor;
  setup.settings = settings;
  finishSetup(setup);
  return setup;
}

/// Add a beam with the next id.
inline void addBeam(ScanBeams& beams, const Vec3& direction, const Vec3& origin = Vec3(0.0))
{
  beams.ids.push_back(beams.ids.size());
  beams.origins.push_back(origin);
  beams.directions.push_back(direction);
}

inline ScanBeams oneBeam(const Vec3& direction = { 1.0, 0.0, 0.0 }, const Vec3& origin = Vec3(0.0))
{
  ScanBeams beams;
  addBeam(beams, direction, origin);
  return beams;
}

/// Beams of these places in the list, as they are.
inline ScanBeams chosen(const ScanBeams& all, const std::vector<std::size_t>& places)
{
  ScanBeams some;
  for (const std::size_t b : places)
  {
    some.ids.push_back(all.ids[b]);
    some.origins.push_back(all.origins[b]);
    some.directions.push_back(all.directions[b]);
    if (!all.times.empty())
    {
      some.times.push_back(all.times[b]);
    }
  }
  return some;
}

/// Places [begin, end).
inline ScanBeams chosen(const ScanBeams& all, std::size_t begin, std::size_t end)
{
  std::vector<std::size_t> places(end - begin);
  std::iota(places.begin(), places.end(), begin);
  return chosen(all, places);
}

/// Beams along x that differ in their ids, so in their rays.
inline ScanBeams alike(int count)
{
  ScanBeams beams;
  for (int i = 0; i < count; ++i)
  {
    addBeam(beams, Vec3(1.0, 0.0, 0.0));
  }
  return beams;
}

inline ScanResult runScan(const ScanSetup& setup, const ScanBeams& beams, int threads = 1)
{
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, threads, cache, std::size_t(1) << 30, {}, result);
  return result;
}

/// Sums over the echoes of each beam.
template <class Value>
std::vector<double> sumsOfBeams(const ScanResult& result, std::size_t beams, Value&& valueOf)
{
  std::vector<double> sums(beams, 0.0);
  for (std::size_t e = 0; e < result.echoes.size(); ++e)
  {
    sums[result.beamOfEcho[e]] += valueOf(result.echoes[e]);
  }
  return sums;
}

/// J received from all echoes.
inline double receivedFrom(const ScanResult& result)
{
  double sum = 0.0;
  for (const Echo& echo : result.echoes)
  {
    sum += echo.returnEnergy;
  }
  return sum;
}

/// The same, of a scene that is scanned by the given beams.
inline double received(const Scene& scene, const Sensor& sensor, const EchoSettings& settings,
  const ScanBeams& beams = oneBeam())
{
  return receivedFrom(runScan(makeSetup(scene, sensor, settings), beams));
}

/// The one echo of one beam.
inline Echo onlyEcho(const Scene& scene, const Sensor& sensor, const EchoSettings& settings,
  const Vec3& direction = { 1.0, 0.0, 0.0 })
{
  const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam(direction));
  return result.echoes.size() == 1 ? result.echoes[0] : Echo{};
}
}

#endif
