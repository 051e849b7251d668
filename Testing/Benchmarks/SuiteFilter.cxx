// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"
#include "Memory.h"
#include "Suites.h"
#include "Tracers.h"

#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarEchoFilter.h"
#include "vtkAvianLidarMaterial.h"
#include "vtkAvianLidarSceneReader.h"

#include "vtkNew.h"

#include <cmath>

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

  /// From 1/2 to 2, never the same twice, and far from the one before.
  double change()
  {
    constexpr double GoldenRatio = 1.618033988749895;
    const double turns = GoldenRatio * ++this->Turn;
    return std::exp2(2.0 * (turns - std::floor(turns)) - 1.0);
  }

  int Turn = 0;
};

void measureFilter(const Scene& scene, const SceneEntry& entry, int channels, int threads,
  const Options& options, Table& times)
{
  const auto measure = [&](const std::vector<Contender>& contenders)
  {
    for (const Timing& t : compete(contenders, options.limits()))
    {
      times.row(scene.name, channels, threads, t.name, t.median);
      say(scene.name + ", " + t.name + ": " + std::to_string(t.median) + " s");
    }
  };
  // The kernel's part of the same scan.
  Scene turned = scene;
  turned.pattern = airportPattern(channels);
  const Workload work = makeWorkload(turned, {});
  const ScanBeams beams = makeBeams(turned);
  const ScanSetup setup = makeSetup(scene, buildCollisionTree(scene.mesh, TreeOptions{}));
  TraceCache known;
  const auto light = [&](int n)
  {
    ScanResult result;
    simulateScan(setup, beams, n, known, std::size_t(4) << 30, {}, result);
  };
  light(2);
  const Tracer tracer = ourTracer(*setup.tree, TraceMode::Automatic);
  Pipeline line(entry, scene.apex, channels, threads);
  line.scan();
  measure({
    { "tracing primary rays", [&]() { tracer(work, threads, nullptr); } },
    { "scan without VTK", [&]() { runScan(setup, beams, threads); } },
    { "energies, hits known", [&]() { light(threads); } },
    { "Update(), tree ready", [&]() { line.scan(); } },
  });
  // The most that any change brings to light: what lies on those paths is known from then on.
  line.echoes->SetAttenuationCoefficient(3.5e-5 / 2.0);
  line.beams->SetLowerEnergyLimit(2e-6 / 2.0);
  line.material->SetKd(0.1 * 2.0);
  line.echoes->Update();
  const auto update = [&](const std::function<void()>& change)
  {
    return [&line, change]()
    {
      change();
      line.echoes->Update();
    };
  };
  measure({ { "nothing changed: checks, assembling the output",
    update([&]() { line.echoes->Modified(); }) } });
  measure({
    { "re-lit: attenuation",
      update([&]() { line.echoes->SetAttenuationCoefficient(3.5e-5 * line.change()); }) },
    { "re-lit: threshold",
      update([&]() { line.beams->SetLowerEnergyLimit(2e-6 * line.change()); }) },
    { "re-lit: materials", update([&]() { line.material->SetKd(0.1 * line.change()); }) },
  });
  measure({ { "Update(), tree built too",
    [&]()
    {
      line.tree->Modified();
      line.tree->SetMaximumLeafSize(line.tree->GetMaximumLeafSize() == 4 ? 5 : 4);
      line.scan();
    } } });
}
}

bool suiteFilter(const Options& options)
{
  Table times(options, "filter", "scene,channels,threads,stage,median_s");
  forEachScene(options, airports(),
    [&](const Scene& scene, const SceneEntry& entry)
    {
      measureFilter(scene, entry, 16, 1, options, times);
      if (!options.smoke)
      {
        measureFilter(scene, entry, 32, 2, options, times);
      }
    });
  return true;
}

bool suiteMemory(const Options& options)
{
  Table table(options, "memory",
    "scene,triangles,surfaces_mib,peak_of_tree_build_mib,tree_mib,peak_of_scan_mib,echoes");
  bool good = true;
  forEachScene(options, airports(),
    [&](const Scene& scene, const SceneEntry& entry)
    {
      const auto above = [](std::size_t a, std::size_t b)
      { return a > b ? static_cast<double>(a - b) / (1 << 20) : 0.0; };
      const auto measure = [&]()
      {
        entry.make(); // loads what reading takes
        Pipeline line(entry, scene.apex, 32, 2);
        const std::size_t start = residentBytes();
        line.material->Update();
        const std::size_t surfaces = residentBytes();
        resetPeak();
        line.tree->Update();
        const std::size_t peak = peakBytes();
        const std::size_t tree = residentBytes();
        resetPeak();
        line.echoes->Update();
        table.row(entry.name, scene.mesh->size(), above(surfaces, start), above(peak, surfaces),
          above(tree, surfaces), above(peakBytes(), tree),
          line.echoes->GetOutput()->GetNumberOfPoints());
      };
      const bool done = inSubprocess(measure, 300);
      good = good && done;
      say(entry.name + (done ? "" : ": the process that measures memory failed"));
    });
  return good;
}
}
