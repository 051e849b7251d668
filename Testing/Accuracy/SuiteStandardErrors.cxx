// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "Coverage.h"
#include "Results.h"
#include "Windows.h"

namespace accuracy
{
using namespace avianlidar;

namespace
{
/// What is promised: share of echoes of which +-1.96 s.e. hold the truth, of all and of those in
/// any decile of covered share, and mean width over rms error.
constexpr double HeldOfAll = 0.93;
constexpr double HeldOfDecile = 0.88;
constexpr double WidestRatio = 4.0;

/// With fewer rays than that beams often see nothing of a window: only the echoes that there are
/// are judged, by a bar of their own.
constexpr int FewRays = 16;
constexpr double HeldOfSeen = 0.90;
constexpr double WidestOfFew = 1.21 * WidestRatio; // by Student's t

/// A decile of fewer windows says more of these windows than of the method.
constexpr std::size_t FewestWindows = 10;

/// How much is measured of a scene.
struct Effort
{
  int rays;
  int seeds;
  std::int64_t stride;
  int referenceRays;
};

std::string nameOf(Sampling sampling)
{
  return sampling == Sampling::Stratified ? "Stratified" : "MonteCarlo";
}

bool meetsBars(const CoverageTable& table, int rays)
{
  if (rays < FewRays)
  {
    return table.all.shareOfSeen() >= HeldOfSeen && table.all.ratio() <= WidestOfFew;
  }
  return table.all.share() >= HeldOfAll && table.all.ratio() <= WidestRatio &&
    table.leastDecile(FewestWindows) >= HeldOfDecile;
}

bool measureScene(const AccuracySceneEntry& entry, const Effort& effort, benchmarks::Table& table)
{
  const AccuracyScene scene = entry.make(effort.stride);
  if (scene.beams.size() == 0)
  {
    benchmarks::say(entry.name + ": left out, its data are not here");
    return true;
  }
  EchoSettings settings = scene.setup.settings;
  settings.seed = SeedOfWindows;
  settings.raysPerBeam = effort.rays;
  settings.beamSamples = BeamSampleSource::Rays; // it is sampling whose errors are measured
  const std::vector<Window> windows = findWindows(scene, settings, effort.referenceRays);
  bool good = !windows.empty();
  for (const Sampling sampling : { Sampling::Stratified, Sampling::MonteCarlo })
  {
    settings.sampling = sampling;
    const CoverageTable found = measureCoverage(scene, windows, settings, 1, effort.seeds);
    const auto row = [&](const std::string& what, const Coverage& part)
    {
      if (part.estimates > 0)
      {
        table.row(entry.name, nameOf(sampling), effort.rays, what,
          part.estimates / static_cast<std::size_t>(effort.seeds), effort.seeds, part.share(),
          part.width(), part.rms(), part.ratio(), part.bias(), part.shareOfSeen());
      }
    };
    row("all", found.all);
    row("direct", found.direct);
    row("two reflections", found.secondary);
    for (std::size_t d = 0; d < found.deciles.size(); ++d)
    {
      row("decile " + std::to_string(d + 1), found.deciles[d]);
    }
    const bool met = meetsBars(found, effort.rays);
    benchmarks::say(entry.name + ", " + std::to_string(effort.rays) + " rays, " + nameOf(sampling) +
      ": held " + std::to_string(found.all.share()) + ", of what was seen " +
      std::to_string(found.all.shareOfSeen()) + ", least decile " +
      std::to_string(found.leastDecile(FewestWindows)) + ", width/rms " +
      std::to_string(found.all.ratio()) + (met ? "" : " BAR NOT MET"));
    good = good && met;
  }
  return good;
}
}

bool suiteStandardErrors(const Options& options)
{
  benchmarks::Table table(options.folder + "/standard_errors.csv",
    "scene,sampling,rays,echoes,windows,seeds,held,width,rms,ratio,bias,held_seen");
  bool good = true;
  for (const AccuracySceneEntry& entry : accuracyScenes())
  {
    if (!options.scene.empty() ? options.scene != entry.name : options.check && !entry.shipped)
    {
      continue;
    }
    std::vector<Effort> efforts{ { 100, 20, entry.stride, 20000 } };
    if (options.check)
    {
      efforts = { { 100, 20, entry.checkStride, 4000 }, { 8, 20, entry.checkStride, 4000 } };
    }
    else if (entry.everyNumberOfRays)
    {
      efforts.push_back({ 8, 20, entry.stride, 20000 });
      efforts.push_back({ 12, 20, entry.stride, 20000 });
      efforts.push_back({ 16, 20, entry.stride, 20000 });
      efforts.push_back({ 1000, 6, 2 * entry.stride, 20000 });
    }
    for (const Effort& effort : efforts)
    {
      good = measureScene(entry, effort, table) && good;
    }
  }
  return good;
}
}
