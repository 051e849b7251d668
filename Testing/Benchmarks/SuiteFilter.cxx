// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "Memory.h"
#include "OurTracer.h"
#include "ScanRunner.h"
#include "Subprocess.h"

#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarEchoFilter.h"
#include "vtkAvianLidarMaterial.h"
#include "vtkAvianLidarSceneReader.h"

#include "vtkNew.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// The pipeline of a user: scene file, material, tree, beams, echoes.
struct Pipeline
{
  vtkNew<vtkAvianLidarSceneReader> reader;
  vtkNew<vtkAvianLidarMaterial> material;
  vtkNew<vtkAvianLidarCollisionTree> tree;
  vtkNew<vtkAvianLidarBeamSource> beams;
  vtkNew<vtkAvianLidarEchoFilter> echoes;

  Pipeline(const SceneEntry& entry, const Vec3& apex, int channels, int threads)
  {
    this->reader->SetFileName(entry.file.c_str());
    this->material->SetInputConnection(this->reader->GetOutputPort());
    this->material->SetBlockNamePattern(entry.repaint);
    this->material->SetMaterialToCustom();
    this->tree->SetInputConnection(this->material->GetOutputPort());
    if (channels == 32)
    {
      this->beams->SetPresetToAirport32();
    }
    this->beams->SetPosition(apex.x, apex.y, apex.z);
    this->echoes->SetInputConnection(0, this->beams->GetOutputPort());
    this->echoes->SetSurfacesConnection(this->tree->GetOutputPort());
    this->echoes->SetNumberOfThreads(threads);
    this->echoes->SetBeamSamplesToRays(); // rays are what is measured here
  }

  /// Nothing is known of these rays: another seed.
  void scan()
  {
    this->echoes->SetSeed(this->echoes->GetSeed() + 1);
    this->echoes->Update();
  }
};

/// Everything that lighting depends on, changed up and down by up to a factor of two: nothing may
/// be traced.
class Relight
{
public:
  explicit Relight(Pipeline& pipeline)
    : Line(pipeline)
  {
  }
  /// The most that any change brings to light: what lies on those paths is known from then on.
  void everything()
  {
    this->Line.echoes->SetAttenuationCoefficient(3.5e-5 / 2.0);
    this->Line.beams->SetLowerEnergyLimit(2e-6 / 2.0);
    this->Line.material->SetKd(0.1 * 2.0);
    this->update();
  }
  /// Executes, and has nothing to light: the checks of the input and the assembling of the output.
  void nothing()
  {
    this->Line.echoes->Modified();
    this->update();
  }
  void attenuation()
  {
    this->Line.echoes->SetAttenuationCoefficient(3.5e-5 * this->change());
    this->update();
  }
  void threshold()
  {
    this->Line.beams->SetLowerEnergyLimit(2e-6 * this->change());
    this->update();
  }
  void material()
  {
    this->Line.material->SetKd(0.1 * this->change());
    this->update();
  }

private:
  /// From 1/2 to 2, never the same twice, and far from the one before.
  double change()
  {
    constexpr double GoldenRatio = 1.618033988749895;
    const double turns = GoldenRatio * ++this->Turn;
    return std::exp2(2.0 * (turns - std::floor(turns)) - 1.0);
  }
  void update() { this->Line.echoes->Update(); }
  Pipeline& Line;
  int Turn = 0;
};

/// One change right after a scan: unlike later ones it may have to trace paths that were too weak
/// to matter before.
Timing firstChange(Pipeline& line, const char* name, const std::function<void(double)>& set)
{
  std::vector<double> seconds;
  constexpr int Rounds = 5;
  for (int round = 0; round < Rounds; ++round)
  {
    set(1.0);
    line.scan();
    set(0.5);
    seconds.push_back(secondsOf([&line]() { line.echoes->Update(); }));
  }
  set(1.0);
  return { name, medianOf(seconds), *std::min_element(seconds.begin(), seconds.end()), Rounds };
}

/// The kernel's part of the same scan, stage by stage.
struct Stages
{
  Workload work;
  ScanBeams beams;
  ScanSetup setup;
  TraceCache known;

  Stages(const Scene& scene, int channels)
  {
    Scene turned = scene;
    turned.pattern = airportPattern(channels);
    this->work = makeWorkload(turned, {});
    this->beams = makeBeams(turned);
    this->setup = makeSetup(scene, buildCollisionTree(scene.mesh, TreeOptions{}));
    ScanResult result;
    simulateScan(this->setup, this->beams, 2, this->known, std::size_t(4) << 30, {}, result);
  }

  void sampleRays() const
  {
    const StrataPartition strata(100);
    BeamRays rays;
    for (const std::uint64_t id : this->beams.ids)
    {
      sampleBeam(0, id, 100, { 5.6e-3, BeamProfile::Uniform }, Sampling::Stratified, &strata, rays);
    }
  }
  void light(int threads)
  {
    ScanResult result;
    simulateScan(this->setup, this->beams, threads, this->known, std::size_t(4) << 30, {}, result);
  }
};

void measureFilter(const Scene& scene, const SceneEntry& entry, int channels, int threads,
  const Options& options, Table& times)
{
  Stages stages(scene, channels);
  Pipeline line(entry, scene.apex, channels, threads);
  Relight relight(line);
  const Tracer tracer = ourTracer(*stages.setup.tree, TraceMode::Automatic);
  line.scan();
  const std::vector<Contender> contenders = {
    { "beam generation",
      [&]()
      {
        line.beams->Modified();
        line.beams->Update();
      } },
    { "ray sampling, one thread", [&]() { stages.sampleRays(); } },
    { "tracing primary rays", [&]() { tracer(stages.work, threads, nullptr); } },
    { "scan without VTK", [&]() { freshScan(stages.setup, stages.beams, threads); } },
    { "energies, hits known", [&]() { stages.light(threads); } },
    { "Update(), tree ready", [&]() { line.scan(); } },
  };
  const auto write = [&](const std::vector<Timing>& timings)
  {
    for (const Timing& t : timings)
    {
      times.row(
        scene.name, scene.mesh->size(), channels, threads, t.name, t.median, t.best, t.rounds);
      say(scene.name + ", " + std::to_string(channels) + " channels, threads " +
        std::to_string(threads) + ", " + t.name + ": " + std::to_string(t.median) + " s");
    }
  };
  write(compete(contenders, options.limits()));
  write({ firstChange(line, "first change: attenuation halved",
            [&line](double f) { line.echoes->SetAttenuationCoefficient(3.5e-5 * f); }),
    firstChange(line, "first change: threshold halved",
      [&line](double f) { line.beams->SetLowerEnergyLimit(2e-6 * f); }) });
  relight.everything();
  write(
    compete({ { "nothing changed: checks, assembling the output", [&]() { relight.nothing(); } } },
      options.limits()));
  write(compete(
    {
      { "re-lit: attenuation", [&]() { relight.attenuation(); } },
      { "re-lit: threshold", [&]() { relight.threshold(); } },
      { "re-lit: materials", [&]() { relight.material(); } },
    },
    options.limits()));
  const auto withTree = [&]()
  {
    line.tree->Modified();
    line.tree->SetMaximumLeafSize(line.tree->GetMaximumLeafSize() == 4 ? 5 : 4);
    line.scan();
  };
  write(compete({ { "Update(), tree built too", withTree } }, options.limits()));
}
}

bool suiteFilter(const Options& options)
{
  Table times(options.folder + "/filter.csv",
    "scene,triangles,channels,threads,stage,median_s,best_s,rounds");
  for (const SceneEntry& entry : airports())
  {
    if (!wanted(options, entry.name))
    {
      continue;
    }
    const Scene scene = entry.make();
    if (scene.mesh->size() == 0)
    {
      continue;
    }
    for (const int channels : { 16, 32 })
    {
      for (const int threads : { 1, 2 })
      {
        if (options.smoke ? channels * threads > 16
                          : options.brief && (channels == 32) != (threads == 2))
        {
          continue;
        }
        measureFilter(scene, entry, channels, threads, options, times);
      }
    }
  }
  return true;
}

namespace
{
/// MiB above what there was before: surfaces, the most while the tree was built, tree and merged
/// surfaces, the most while scanned; and the number of echoes.
std::vector<double> memoryOf(const SceneEntry& entry)
{
  const auto above = [](std::size_t a, std::size_t b)
  { return a > b ? static_cast<double>(a - b) / (1 << 20) : 0.0; };
  Vec3 apex;
  std::size_t triangles = 0;
  {
    const Scene scene = entry.make();
    apex = scene.apex;
    triangles = scene.mesh->size();
  }
  if (triangles == 0)
  {
    return { 0.0 };
  }
  Pipeline line(entry, apex, 32, 2);
  const std::size_t start = residentBytes();
  line.material->Update();
  const std::size_t surfaces = residentBytes();
  resetPeak();
  line.tree->Update();
  const std::size_t peak = peakBytes();
  const std::size_t tree = residentBytes();
  resetPeak();
  line.echoes->Update();
  return { above(surfaces, start), above(peak, surfaces), above(tree, surfaces),
    above(peakBytes(), tree), double(line.echoes->GetOutput()->GetNumberOfPoints()),
    double(triangles) };
}
}

bool suiteMemory(const Options& options)
{
  Table table(options.folder + "/memory.csv",
    "scene,triangles,channels,surfaces_mib,peak_of_tree_build_mib,tree_mib,peak_of_scan_mib,"
    "echoes");
  for (const SceneEntry& entry : airports())
  {
    if (!wanted(options, entry.name))
    {
      continue;
    }
    const auto n = inSubprocess([&]() { return memoryOf(entry); }, 300);
    if (n && n->size() == 1)
    {
      continue; // the data are not here
    }
    if (!n || n->size() != 6)
    {
      say(entry.name + ": the process that measures memory failed");
      return false;
    }
    table.row(entry.name, static_cast<std::size_t>((*n)[5]), 32, (*n)[0], (*n)[1], (*n)[2], (*n)[3],
      (*n)[4]);
    say(entry.name + ": MiB of surfaces " + std::to_string((*n)[0]) + ", tree " +
      std::to_string((*n)[2]) + " (while built " + std::to_string((*n)[1]) + "), scan " +
      std::to_string((*n)[3]));
  }
  return true;
}
}
