// SPDX-License-Identifier: BSD-3-Clause
// A scan that is lit again after changes is a fresh scan, bit for bit, and what is known of its
// geometry is not traced again: random changes of everything that beams are kept for, and scenes of
// a few plates in which one conclusion from the run before would be wrong.
#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>

using namespace echotest;

namespace
{
/// The town; of dark houses, which drop out one by one; of mirrors; and behind a wall of so many
/// parts that its beams are divided into cells.
Scene townOf(int kind, std::mt19937_64& random)
{
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Scene scene = town();
  for (std::size_t t = 0; t < scene.materials.size(); ++t)
  {
    const double dark = std::pow(10.0, -4.0 - 5.0 * uniform(random));
    const bool isMirror = kind == 2 && scene.objects[t] % 2 == 0;
    scene.materials[t] = isMirror              ? Material{ 1e-6, 0.9, 1e5 }
      : kind == 1 && scene.objects[t] % 3 != 0 ? Material{ dark, 0.1 * dark, 20.0 }
                                               : scene.materials[t];
  }
  if (kind == 3)
  {
    addFineWall(scene);
  }
  return scene;
}

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

/// Change something. @param factor draws a number about 1, near or far
void changeAnything(ScanSeries& series, std::mt19937_64& random)
{
  const auto draw = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const double width = draw(2) ? 1e-3 : 1.0;
  const double factor = std::exp(width * std::normal_distribution<double>()(random));
  const Material paints[] = { Wall, Glass, Metal, Wood, { 1e-6, 0.9, 1e5 }, { 1e-7, 0.0, 1.0 } };
  const int object = draw(2) ? draw(61) : 100 + draw(3);
  Sensor& sensor = series.setup.sensor;
  EchoSettings& s = series.setup.settings;
  const auto ofObject = [&](auto& values, const auto& value)
  {
    edit(values,
      [&](auto& all)
      {
        for (std::size_t t = 0; t < all.size(); ++t)
        {
          all[t] = series.setup.objectIds[t] == object ? value : all[t];
        }
      });
  };
  const std::vector<std::function<void()>> changes = {
    [&]() { sensor.lowerEnergyLimit = std::min(sensor.lowerEnergyLimit * factor, 0.1); },
    [&]() { sensor.lowerEnergyLimit = std::pow(10.0, -5.0 - draw(6)); },
    [&]()
    {
      const std::vector<Echo>& echoes = series.result.echoes;
      const std::size_t n = echoes.size();
      const double energy = n > 0 ? echoes[random() % n].energyReceived : 1e-7;
      sensor.lowerEnergyLimit = draw(2) ? energy : std::nextafter(energy, 0.0);
    },
    [&]() { s.attenuationCoefficient = std::pow(10.0, 1.0 - draw(6)); },
    [&]() { ofObject(series.setup.materials, paints[draw(6)]); },
    [&]() { ofObject(series.setup.materialIds, draw(3)); },
    [&]() { ofObject(series.setup.objectIds, draw(61)); },
    [&]() { sensor.rangeGate = draw(2) ? 4000.0 : 150.0; },
    [&]() { series.beams.origins.assign(series.beams.size(), Vec3(0.0, 0.0, 0.1 * draw(9))); },
    [&]()
    { std::reverse(series.beams.directions.begin(), series.beams.directions.end() - draw(9)); },
    [&]() { std::reverse(series.beams.ids.begin(), series.beams.ids.end() - draw(9)); },
    [&]() { series.beams = horizon(draw(2) ? 60 : 30, 2); },
  };
  const auto count = static_cast<int>(changes.size());
  const int which = draw(3 * count);
  const Sensor sensorBefore = sensor;
  const EchoSettings settingsBefore = s;
  if (which < count)
  {
    changes[which]();
  }
  else if (which < 2 * count)
  {
    double& value = sensor.*sensorFields()[random() % sensorFields().size()].member;
    value = draw(4) ? value * factor : 1e-3 * draw(2);
  }
  else
  {
    const EchoSetting& setting = echoSettings()[random() % echoSettings().size()];
    const double value = setting.get(s);
    const bool isChoice = value < 9.0 && value == std::floor(value);
    setting.set(s, isChoice ? draw(4) : value * std::exp(draw(5) - 2.0));
  }
  sensor.upperEnergyLimit = std::max(sensor.upperEnergyLimit, sensor.lowerEnergyLimit);
  if (!checkSensor(sensor).empty() || !checkSettings(s).empty() || s.raysPerBeam > 100 ||
    !checkUnits(sensor, s).empty() || sensor.halfBeamwidth > 0.1)
  {
    sensor = sensorBefore;
    s = settingsBefore;
  }
}
}

TEST(ScanAgain, AfterAnyChangesItIsAFreshScan)
{
  for (int seed = 0; seed < 12; ++seed)
  {
    std::mt19937_64 random(seed);
    Sensor sensor = seed % 2 ? noisy() : Sensor{};
    sensor.halfBeamwidth = seed % 3 ? 0.03 : sensor.halfBeamwidth;
    sensor.halfBeamwidthAcross = seed % 5 ? 0.0 : 2e-3;
    ScanSeries series(sensor, usual(), townOf(seed / 3, random));
    for (int step = 0; step < 26 && !testing::Test::HasFailure(); ++step)
    {
      series.setup.revolution += seed % 2; // lit beams are kept for another noise
      if (step % 3 != 1)
      {
        changeAnything(series, random);
      }
      series.check("seed " + std::to_string(seed) + ", step " + std::to_string(step));
    }
  }
}

TEST(ScanAgain, WhatIsKnownIsNotTraced)
{
  for (const BeamSampleSource source : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    std::mt19937_64 random(1);
    EchoSettings settings = usual();
    settings.beamSamples = source;
    settings.lightEnergyConstraint = false; // it leaves paths untraced that others may need
    ScanSeries series(noisy(), settings, townOf(3, random));
    const std::function<void()> changes[] = { []() {}, [&]() { series.setup.revolution = 3; },
      [&]() { series.setup.sensor.lowerEnergyLimit *= 0.1; },
      [&]() { series.setup.settings.attenuationCoefficient = 1e-3; },
      [&]() { edit(series.setup.materials, [](auto& all) { all[0].kd *= 0.9; }); } };
    for (const auto& change : changes)
    {
      change();
      series.check("known");
      EXPECT_EQ(series.result.raysTraced + series.result.beamsTraced, 0u);
    }
  }
}

TEST(ScanAgain, OnlyCrowdedBeamsAreTracedForAnotherLimit)
{
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Scene scene = townOf(3, random);
  for (int k = 0; k < 300; ++k)
  {
    const double edge = 0.02 + 0.01 * uniform(random);
    scene.box(Vec3(0.5 * uniform(random), 25.0 + uniform(random), 0.5 + 0.4 * uniform(random)),
      Vec3(edge), k % 2 ? Wall : Material{ 0.8, 0.0, 1.0 }, 1000 + k);
  }
  Sensor wide;
  wide.halfBeamwidth = 0.03;
  ScanSeries series(wide, usual(), scene);
  std::size_t crowded = 0;
  for (const BeamReport& report : series.result.reports)
  {
    crowded += report.isCrowded ? 1 : 0;
  }
  EXPECT_GT(crowded, 0u);
  EXPECT_LT(crowded, series.beams.size() / 4);
  const std::function<void()> changes[] = { [&]() { series.setup.sensor.lowerEnergyLimit *= 0.1; },
    [&]() { series.setup.sensor.lowerEnergyLimit *= 100.0; },
    [&]() { edit(series.setup.materials, [](auto& all) { all.back().kd *= 0.1; }); },
    [&]() { series.setup.sensor.receiverAperture = 0.01; } };
  for (const auto& change : changes)
  {
    change();
    series.check("crowded");
    EXPECT_EQ(series.result.beamsTraced, crowded);
  }
  series.setup.settings.attenuationCoefficient = 1e-3;
  series.check("air");
  EXPECT_EQ(series.result.beamsTraced, 0u);
}

TEST(ScanAgain, KeptCellsServeASecondReflection)
{
  std::mt19937_64 random(1);
  EchoSettings settings = usual();
  settings.numberOfReflections = 1;
  Sensor wide;
  wide.halfBeamwidth = 0.03;
  ScanSeries series(wide, settings, townOf(3, random));
  std::vector<const CellSamples*> before;
  for (const KeptBeam& trace : series.cache.beams)
  {
    before.push_back(trace.view.cells());
  }
  EXPECT_GT(before.size() - std::count(before.begin(), before.end(), nullptr), 10u);
  series.setup.settings.numberOfReflections = 2;
  series.check("two reflections");
  for (std::size_t b = 0; b < before.size(); ++b)
  {
    EXPECT_EQ(series.cache.beams[b].view.cells(), before[b]) << b;
  }
}

TEST(ScanAgain, StandardErrorsAreThoseOfAFreshScanWhateverReturnsAreKnown)
{
  // One beam over twelve strips one behind the other, of which noise makes more and fewer returns.
  Scene scene;
  for (int k = 0; k < 12; ++k)
  {
    const double range = 100.0 + 25.0 * k;
    const double width = 2.0 * 5.6e-3 * range / 12.0; // of a strip, in the beam's cone
    scene.plate(Vec3(range, 0.0, width * (k - 5.5)), Vec3(0.0, 9.0, 0.0),
      Vec3(0.0, 0.0, 0.5 * width), Wall, k);
  }
  Sensor sensor = noisy();
  sensor.lowerEnergyLimit *= 0.5;
  EchoSettings settings = usual();
  settings.beamSamples = BeamSampleSource::Rays;
  ScanSeries series(sensor, settings, scene, oneBeam());
  for (series.setup.revolution = 0; series.setup.revolution < 40; ++series.setup.revolution)
  {
    series.check("revolution " + std::to_string(series.setup.revolution));
  }
}

TEST(ScanAgain, WhatWasTooFaintIsHeardInOtherAir)
{
  // A surface 20 m away that reflects towards a wall 11 m beside it, at which the lidar looks
  // askance, in beams half a radian wide: from air in which nothing is perceived to other air, with
  // Qlow just below what is received there. In the thickest energies underflow.
  const double airs[][2] = { { 0.1, 0.01 }, { 8e-4, 9.6e-4 }, { 13.0, 16.0 } };
  const Material mirrors[] = { { 1e-6, 0.9, 1e5 }, { 0.1, 1e-6, 1e5 }, { 1e-12, 0.9, 1e5 } };
  Sensor sensor = openSensor(0.5);
  sensor.samplingInterval = 5e-9;
  sensor.upperEnergyLimit = 1e3;
  EchoSettings settings = usual();
  settings.raysPerBeam = 16;
  settings.numberOfConnections = 0;
  settings.noise = false;
  for (int i = 0; i < 6; ++i)
  {
    sensor.rangeGate = i < 3 ? 4000.0 : 24.0;
    Scene scene;
    scene.plate(
      Vec3(20.0, -5.0, 0.0), Vec3(3.36, 2.17, 0.0), Vec3(0.0, 0.0, 6.0), mirrors[i % 3], 1);
    scene.plate(Vec3(22.0, 6.0, 0.0), Vec3(4.0, 0.0, 0.0), Vec3(0.0, 0.0, 8.0), Wall, 2);
    ScanSeries series(sensor, settings, scene, alike(12));
    const auto look = [&](double air, double limit)
    {
      series.setup.settings.attenuationCoefficient = air;
      series.setup.sensor.lowerEnergyLimit = limit;
      series.check(std::to_string(air) + " per m, " + std::to_string(limit) + " J");
    };
    for (const auto& air : airs)
    {
      look(air[1], 0.0);
      const std::vector<Echo> echoes = series.result.echoes;
      for (std::size_t e = 0; e < echoes.size(); e += 5)
      {
        look(air[0], 1e3);
        look(air[1], echoes[e].energyReceived * (1.0 - 1e-6));
      }
    }
    for (int k = 0; k < 24; ++k) // faint gloss is traced path by path, and left out again
    {
      look(0.0, 2e-5 * std::pow(3.0, k < 16 ? -k : 2 * k - 48));
    }
  }
}
