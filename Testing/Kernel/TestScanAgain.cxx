// SPDX-License-Identifier: BSD-3-Clause
// A scan that is lit again after a change of limits, air, materials or anything else is a fresh
// scan, bit for bit; and what is known of its geometry is not traced again.
#include "ScanSeries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

using namespace echotest;

namespace
{
/// Give half of the triangles another value: not all houses are seen.
template <class Values, class Value>
void fillHalf(Values& values, const Value& value)
{
  edit(values, [&](auto& copy) { std::fill_n(copy.begin(), copy.size() / 2, value); });
}
}

namespace
{
/// The town, and before it a wall of so many parts that its beams are divided into cells.
Scene townAndWall()
{
  Scene scene = town();
  for (int i = 0; i < 120; ++i)
  {
    for (int k = 0; k < 30; ++k)
    {
      scene.plate(Vec3(-12.0 + 0.2 * i, 100.0, 0.2 * k), Vec3(0.1, 0.0, 0.0), Vec3(0.0, 0.0, 0.1),
        i % 2 ? Wall : Metal, 100);
    }
  }
  return scene;
}

/// The beams whose direct echo is found so.
std::ptrdiff_t beamsBy(DirectEcho direct, const TraceCache& cache)
{
  return std::count_if(cache.beams.begin(), cache.beams.end(),
    [=](const BeamTrace& trace) { return trace.direct() == direct; });
}
}

TEST(ScanAgain, LimitsAirMaterialsAndNoiseTraceNothingThatIsKnown)
{
  for (const int reflections : { 1, 2 })
  {
    for (const BeamSampleSource source : { BeamSampleSource::Cells, BeamSampleSource::Rays })
    {
      SCOPED_TRACE(testing::Message() << reflections << ' ' << static_cast<int>(source));
      EchoSettings settings = usual();
      settings.beamSamples = source;
      settings.numberOfReflections = reflections;
      // With two it leaves paths untraced that others may need.
      settings.lightEnergyConstraint = reflections == 1;
      ScanSeries series({}, settings, townAndWall(), horizon(180, 4));
      ASSERT_GT(series.result.beamsTraced, 0u);
      const bool cells = source == BeamSampleSource::Cells;
      EXPECT_EQ(beamsBy(DirectEcho::Polygons, series.cache) > 20, cells);
      EXPECT_EQ(beamsBy(DirectEcho::Cells, series.cache) > 20, cells);
      EXPECT_EQ(beamsBy(DirectEcho::Nothing, series.cache) > 20, cells);
      EXPECT_EQ(beamsBy(DirectEcho::Rays, series.cache) > 60, !cells);
      EXPECT_EQ(beamsBy(DirectEcho::Unknown, series.cache), 0);
      Sensor& sensor = series.setup.sensor;
      const auto change = [&](const char* what, const std::function<void()>& by)
      {
        by();
        series.check(what);
        EXPECT_EQ(series.result.raysTraced, 0u) << what;
        EXPECT_EQ(series.result.beamsTraced, 0u) << what;
      };
      change("nothing", []() {});
      change("upper limit", [&]() { sensor.upperEnergyLimit = 1e-5; });
      change("lower limit", [&]() { sensor.lowerEnergyLimit *= 1.5; });
      change("a far lower limit", [&]() { sensor.lowerEnergyLimit = 1e-12; });
      change("air", [&]() { series.setup.settings.attenuationCoefficient = 1e-3; });
      change("limit again", [&]() { sensor.lowerEnergyLimit = 2e-6; });
      change("noise", [&]() { sensor.noisePhotonRate = 1e15; });
      change("quiet", [&]() { sensor.noisePhotonRate = 20e3; });
      sensor.receiverAperture = 50.0;
      series.check("an aperture"); // short paths are first needed
      EXPECT_EQ(series.result.raysTraced > 0, reflections == 2);
      change("a wider aperture", [&]() { sensor.receiverAperture = 100.0; });
      change("no aperture", [&]() { sensor.receiverAperture = 0.0; });
      change("materials",
        [&]()
        {
          edit(series.setup.materials,
            [&](std::vector<Material>& materials)
            {
              for (std::size_t t = 0; t < materials.size() / 2; ++t)
              {
                materials[t].kd *= 0.9;
                // Sharper lobes; over two reflections they may find paths that none had.
                materials[t].kp = reflections == 1 ? 1e6 : materials[t].kp;
              }
            });
        });
    }
  }
}

TEST(ScanAgain, LimitsAtTheVeryEnergiesOfUnits)
{
  ScanSeries series;
  std::vector<double> energies;
  for (const Echo& echo : series.result.echoes)
  {
    energies.push_back(echo.energyReceived);
  }
  std::sort(energies.begin(), energies.end());
  for (std::size_t e = 0; e < energies.size(); e += 9)
  {
    for (const double limit : { std::nextafter(energies[e], 0.0), energies[e] })
    {
      series.setup.sensor.lowerEnergyLimit = limit;
      series.check("limit " + std::to_string(e));
    }
  }
}

TEST(ScanAgain, LimitsFromNothingToEverything)
{
  for (const bool constraint : { true, false })
  {
    EchoSettings settings = usual();
    settings.lightEnergyConstraint = constraint;
    Sensor sensor;
    sensor.upperEnergyLimit = 1.0;
    ScanSeries series(sensor, settings);
    // In steps that drop and bring back paths, up and down.
    for (const double step : { 1.7, 1.0 / 1.9 })
    {
      for (int i = 0; i < 40; ++i)
      {
        series.setup.sensor.lowerEnergyLimit =
          std::clamp(series.setup.sensor.lowerEnergyLimit * step, 1e-14, 0.1);
        series.check(std::to_string(series.setup.sensor.lowerEnergyLimit));
      }
    }
    series.setup.sensor.lowerEnergyLimit = 0.0;
    series.check("0");
  }
}

TEST(ScanAgain, EverythingElse)
{
  ScanSeries series;
  const auto change = [&](const char* what, const std::function<void()>& by)
  {
    by();
    series.check(what);
    series.setup.sensor.lowerEnergyLimit *= 1.0 + 1e-6;
    series.check(what);
  };
  Sensor& sensor = series.setup.sensor;
  EchoSettings& settings = series.setup.settings;
  change("pulse energy", [&]() { sensor.pulseEnergy *= 2.0; });
  change("pulse width", [&]() { sensor.pulseWidth *= 2.0; });
  change("sampling interval", [&]() { sensor.samplingInterval *= 0.5; });
  change("gate", [&]() { sensor.rangeGate = 150.0; });
  change("limit in the gate", [&]() { sensor.lowerEnergyLimit = 1e-5; });
  change("a higher one", [&]() { sensor.lowerEnergyLimit = 4e-5; });
  change("the first", [&]() { sensor.lowerEnergyLimit = 2e-6; });
  change("air in the gate", [&]() { settings.attenuationCoefficient = 1e-3; });
  change("gate again", [&]() { sensor.rangeGate = 4000.0; });
  change("one reflection", [&]() { settings.numberOfReflections = 1; });
  change("two reflections", [&]() { settings.numberOfReflections = 2; });
  change("connections", [&]() { settings.numberOfConnections = 3; });
  change("return mode", [&]() { settings.returnMode = ReturnMode::Last; });
  change("range units", [&]() { settings.returnMode = ReturnMode::RangeUnits; });
  change("all returns", [&]() { settings.returnMode = ReturnMode::All; });
  change("no constraint", [&]() { settings.lightEnergyConstraint = false; });
  change("constraint", [&]() { settings.lightEnergyConstraint = true; });
  change("fraction", [&]() { settings.lightEnergyFraction = 0.3; });
  change("fraction of nothing", [&]() { settings.lightEnergyFraction = 0.0; });
  change("usual fraction", [&]() { settings.lightEnergyFraction = 1e-3; });
  change("no beam constraint", [&]() { settings.beamConstraint = false; });
  change("model", [&]() { settings.reflectanceModel = ReflectanceModel::Microfacet; });
  change("aperture", [&]() { sensor.receiverAperture = 100.0; });
  change("no aperture", [&]() { sensor.receiverAperture = 0.0; });
  change("objects", [&]() { fillHalf(series.setup.objectIds, 77); });
  change("material ids", [&]() { fillHalf(series.setup.materialIds, 77); });
  change("seed", [&]() { settings.seed = 9; });
  change("noise", [&]() { sensor.noisePhotonRate = 1e15; });
  change("quiet", [&]() { sensor.noisePhotonRate = 20e3; });
  change("rays alone", [&]() { settings.beamSamples = BeamSampleSource::Rays; });
  change("rays", [&]() { settings.raysPerBeam = 30; });
}

TEST(ScanAgain, ChangesInAnyOrder)
{
  for (const unsigned seed : { 1u, 2u, 3u })
  {
    std::mt19937_64 random(seed);
    const auto draw = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
    const auto factor = [&](double width)
    { return std::exp(width * std::normal_distribution<double>()(random)); };
    ScanSeries series;
    const Material materials[] = { Wall, Glass, Metal, Wood };
    for (int step = 0; step < 60; ++step)
    {
      const double width = draw(2) ? 1e-3 : 1.0;
      double& lower = series.setup.sensor.lowerEnergyLimit;
      double& upper = series.setup.sensor.upperEnergyLimit;
      switch (draw(5))
      {
        case 0:
        case 1:
          lower = std::clamp(lower * factor(width), 1e-9, 1e-4);
          upper = std::max(upper, lower);
          break;
        case 2:
          series.setup.settings.attenuationCoefficient *= factor(width);
          break;
        case 3:
          upper = std::max(lower, upper * factor(width));
          break;
        default:
        {
          const Material& material = materials[draw(4)];
          const int object = draw(61);
          edit(series.setup.materials,
            [&](std::vector<Material>& all)
            {
              for (std::size_t t = 0; t < all.size(); ++t)
              {
                all[t] = series.setup.objectIds[t] == object ? material : all[t];
              }
            });
        }
      }
      series.check("seed " + std::to_string(seed) + ", step " + std::to_string(step));
    }
  }
}

namespace
{
/// Sees the town with echoes near the limit, and false alarms.
Sensor noisy()
{
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.receiverAperture = 0.0079;
  sensor.lowerEnergyLimit = 2e-13;
  sensor.upperEnergyLimit = 1e-9;
  sensor.amplifierNoise =
    sensor.lowerEnergyLimit * sensor.receiverEfficiency / sensor.photonEnergy() / 4.0;
  return sensor;
}

/// Returns that lit beams remember.
std::size_t knownReturns(const TraceCache& cache)
{
  std::size_t sum = 0;
  for (const BeamTrace& trace : cache.beams)
  {
    sum += trace.lit ? trace.lit->returns.size() : 0;
  }
  return sum;
}
}

TEST(ScanAgain, RevolutionsDifferByTheirNoiseAlone)
{
  for (const BeamSampleSource source : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    EchoSettings settings = usual();
    settings.beamSamples = source;
    ScanSeries series(noisy(), settings);
    std::size_t differ = 0;
    std::size_t known = 0;
    for (int revolution = 0; revolution < 20; ++revolution)
    {
      const std::size_t before = series.result.echoes.size();
      series.setup.revolution = revolution;
      series.check("revolution " + std::to_string(revolution));
      EXPECT_EQ(series.result.raysTraced, 0u);
      differ += series.result.echoes.size() != before;
      EXPECT_GE(knownReturns(series.cache), known);
      known = knownReturns(series.cache);
    }
    EXPECT_GT(differ, 10u);
    EXPECT_GT(known, series.result.echoes.size());
    for (const BeamTrace& trace : series.cache.beams)
    {
      EXPECT_LE(trace.lit ? trace.lit->returns.size() : 0, LitBeam::MostReturns);
      EXPECT_EQ(trace.held, trace.heldBytes());
    }
  }
}

TEST(ScanAgain, StandardErrorsAreThoseOfAFreshScanWhateverReturnsAreKnown)
{
  // One beam over twelve strips one behind the other, of which noise makes more and fewer returns.
  constexpr int strips = 12;
  Scene scene;
  for (int k = 0; k < strips; ++k)
  {
    const double range = 100.0 + 25.0 * k;
    const double width = 2.0 * 5.6e-3 * range / strips; // of a strip, in the beam's cone
    scene.plate(Vec3(range, 0.0, width * (k + 0.5 - 0.5 * strips)), Vec3(0.0, 9.0, 0.0),
      Vec3(0.0, 0.0, 0.5 * width), Wall, k);
  }
  Sensor sensor = noisy();
  sensor.lowerEnergyLimit *= 0.5;
  for (const Sampling sampling : { Sampling::Stratified, Sampling::MonteCarlo })
  {
    EchoSettings settings = usual();
    settings.raysPerBeam = 200;
    settings.beamSamples = BeamSampleSource::Rays;
    settings.sampling = sampling;
    ScanSeries series(sensor, settings, scene, oneBeam());
    std::size_t most = 0;
    std::size_t least = strips;
    for (int revolution = 0; revolution < 60; ++revolution)
    {
      series.setup.revolution = revolution;
      series.check("revolution " + std::to_string(revolution));
      most = std::max(most, series.result.echoes.size());
      least = std::min(least, series.result.echoes.size());
    }
    EXPECT_GT(most, 9u);
    EXPECT_LT(least, most);
  }
}

TEST(ScanAgain, WhatLightDependsOnIsNotTakenFromOtherRevolutions)
{
  ScanSeries series(noisy());
  int revolution = 0;
  const auto change = [&](const char* what, const std::function<void()>& by)
  {
    by();
    for (int k = 0; k < 3; ++k)
    {
      series.setup.revolution = ++revolution;
      series.check(what);
    }
  };
  Sensor& sensor = series.setup.sensor;
  EchoSettings& settings = series.setup.settings;
  change("nothing", []() {});
  change("pulse energy", [&]() { sensor.pulseEnergy *= 1.5; });
  change("pulse width", [&]() { sensor.pulseWidth *= 2.0; });
  change("sampling interval", [&]() { sensor.samplingInterval *= 0.5; });
  change("gate", [&]() { sensor.rangeGate = 150.0; });
  change("gate again", [&]() { sensor.rangeGate = 4000.0; });
  change("limit", [&]() { sensor.lowerEnergyLimit *= 1.1; });
  change("amplifier", [&]() { sensor.amplifierNoise *= 0.9; });
  change("efficiency", [&]() { sensor.receiverEfficiency *= 0.9; });
  change("radiance", [&]() { sensor.backgroundRadiance *= 2.0; });
  change("aperture", [&]() { sensor.receiverAperture *= 1.2; });
  change("air", [&]() { settings.attenuationCoefficient = 1e-3; });
  change("one reflection", [&]() { settings.numberOfReflections = 1; });
  change("two reflections", [&]() { settings.numberOfReflections = 2; });
  change("range units", [&]() { settings.returnMode = ReturnMode::RangeUnits; });
  change("the last", [&]() { settings.returnMode = ReturnMode::Last; });
  change("all", [&]() { settings.returnMode = ReturnMode::All; });
  change("no constraint", [&]() { settings.lightEnergyConstraint = false; });
  change("whole model", [&]() { settings.fullModel = true; });
  change("model", [&]() { settings.reflectanceModel = ReflectanceModel::Microfacet; });
  change("objects", [&]() { fillHalf(series.setup.objectIds, 77); });
  change("material ids", [&]() { fillHalf(series.setup.materialIds, 77); });
  change("materials", [&]() { fillHalf(series.setup.materials, Material{ 0.1, 0.3, 50.0 }); });
  change("seed", [&]() { settings.seed = 9; });
  change("no noise", [&]() { settings.noise = false; });
  EXPECT_EQ(knownReturns(series.cache), 0u);
  for (const BeamTrace& trace : series.cache.beams)
  {
    EXPECT_EQ(trace.held, trace.heldBytes());
  }
  change("noise", [&]() { settings.noise = true; });
}

TEST(ScanAgain, AStoppedRunLeavesNothing)
{
  ScanSeries series;
  series.setup.settings.attenuationCoefficient = 1e-3;
  int calls = 0;
  const auto stop = [&calls](double) { return ++calls < 2; };
  EXPECT_FALSE(simulateScan(
    series.setup, series.beams, 1, series.cache, std::size_t(1) << 30, stop, series.result));
  EXPECT_TRUE(series.result.echoes.empty());
  EXPECT_TRUE(series.cache.beams.empty());
  series.check("after the stop");
}

TEST(ScanAgain, BeamsOfAKnownChecksumAreNotLookedAt)
{
  ScanSeries series;
  ScanBeams beams = series.beams;
  const std::uint64_t first = series.cache.scan;
  EXPECT_EQ(first, checksumOf(beams));
  beams.directions[3].x += 1e-3;
  beams.checksum = first;
  series.cache.follow(series.setup, beams, 0);
  EXPECT_EQ(series.cache.scan, first); // as if nothing had changed
  beams.checksum = 0;
  series.cache.follow(series.setup, beams, 0);
  EXPECT_NE(series.cache.scan, first);
}
