// SPDX-License-Identifier: BSD-3-Clause
// A result that is brought up to date after a change of limits, air, materials or anything else is
// that of a fresh scan, bit for bit; and what cannot have changed is not lit again.
#include "ScanTestTown.h"

#include "BeamOutcome.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>

using namespace echotest;

namespace
{
/// A scan that goes on from one change to the next, beside fresh ones.
struct Series
{
  ScanSetup setup;
  ScanBeams beams;
  TraceCache cache;
  ScanResult result;
  std::vector<BeamReport> before; ///< reports of the run before
  std::size_t kept = 0;           ///< beams that met something and were not lit again

  explicit Series(const Sensor& sensor = {}, const EchoSettings& settings = usual(),
    const Scene& scene = town(), ScanBeams scanned = horizon(90, 4))
    : setup(makeSetup(scene, sensor, settings))
    , beams(std::move(scanned))
  {
    this->check("first");
  }

  void check(const std::string& what)
  {
    finishSetup(this->setup);
    ASSERT_TRUE(simulateScan(
      this->setup, this->beams, 2, this->cache, std::size_t(1) << 30, {}, this->result));
    const ScanResult fresh = runScan(this->setup, this->beams);
    expectSame(this->result, fresh);
    expectSameReports(this->result, fresh);
    if (this->result.before != 0)
    {
      this->checkChanged();
      this->kept += this->cache.memory.lit.size() - this->result.beamsLit;
    }
    this->before = this->result.reports;
    ASSERT_FALSE(testing::Test::HasFatalFailure()) << what;
  }

  /// Reports that differ from those of the run before are among those that are said to.
  void checkChanged() const
  {
    ASSERT_TRUE(std::is_sorted(this->result.changed.begin(), this->result.changed.end()));
    for (std::size_t b = 0; b < this->before.size(); ++b)
    {
      const BeamReport& x = this->before[b];
      const BeamReport& y = this->result.reports[b];
      const bool same = x.status == y.status && sameBits(x.range, y.range) &&
        x.counters.raysTraced == y.counters.raysTraced &&
        x.counters.nodesVisited == y.counters.nodesVisited && x.skipped == y.skipped &&
        sameBits(x.lost, y.lost);
      ASSERT_TRUE(
        same || std::binary_search(this->result.changed.begin(), this->result.changed.end(), b))
        << b;
    }
  }

  void expectSameReports(const ScanResult& a, const ScanResult& b) const
  {
    ASSERT_EQ(a.reports.size(), b.reports.size());
    for (std::size_t i = 0; i < a.reports.size(); ++i)
    {
      ASSERT_EQ(a.reports[i].status, b.reports[i].status) << "beam " << i;
      ASSERT_TRUE(sameBits(a.reports[i].range, b.reports[i].range)) << "beam " << i;
      // What was left out is bounded in any state, if not by the same number.
      const double lower = this->setup.sensor.lowerEnergyLimit;
      for (const BeamReport& report : { a.reports[i], b.reports[i] })
      {
        const bool whole = (report.skipped & SkippedBeam) != 0;
        const bool silent =
          report.status != BeamStatus::Echo && report.status != BeamStatus::Saturated;
        ASSERT_LE(report.lost, (silent ? 1.0 : 1.001 * LightEnergyTolerance) * lower)
          << "beam " << i;
        ASSERT_TRUE(silent || !whole) << "beam " << i;
        ASSERT_TRUE(report.skipped != 0 || report.lost == 0.0) << "beam " << i;
      }
    }
  }
};
}

TEST(ScanAgain, WhereLimitsStayWithinWhatDecisionsHoldForNothingIsLit)
{
  Series series;
  const std::size_t lit = series.cache.memory.lit.size();
  ASSERT_GT(lit, 150u);
  series.check("nothing");
  EXPECT_EQ(series.kept, lit);
  series.setup.sensor.upperEnergyLimit = 1e-5;
  series.check("upper limit");
  series.kept = 0;
  series.setup.sensor.lowerEnergyLimit *= 1.0 + 1e-7;
  series.check("lower limit");
  EXPECT_GT(series.kept, lit * 9 / 10);
  series.kept = 0;
  for (std::size_t t = 0; t < series.setup.materials.size() / 2; ++t)
  {
    series.setup.materials[t].kd *= 0.9;
  }
  series.check("materials");
  EXPECT_GT(series.kept, lit / 10);
}

TEST(ScanAgain, LimitsAtTheVeryEnergiesOfUnits)
{
  Series series;
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
    Series series(sensor, settings);
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
    EXPECT_GT(series.kept, 1000u);
  }
}

namespace
{
/// Of beams so wide that they meet several houses.
Sensor wideSensor()
{
  Sensor sensor;
  sensor.halfBeamwidth = 0.06;
  sensor.upperEnergyLimit = 1.0;
  return sensor;
}

/// A town of houses so dark that the light-energy constraint drops them one after the other, beside
/// others that are perceived.
Scene darkTown()
{
  Scene scene = town();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t t = 0; t < scene.materials.size(); ++t)
  {
    if (scene.objects[t] % 3 == 1)
    {
      scene.materials[t] = { std::pow(10.0, -6.0 - 5.0 * uniform(random)), 0.0, 1.0 };
    }
    if (scene.objects[t] % 3 == 2)
    {
      const double gloss = std::pow(10.0, -4.0 - 5.0 * uniform(random));
      scene.materials[t] = { 0.1 * gloss, gloss, 20.0 };
    }
  }
  return scene;
}
}

namespace
{
/// Matt houses, most of them dark: paths over two reflections are few and weak, some skipped
/// together.
Scene mattTown()
{
  Scene scene = town();
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t t = 0; t < scene.materials.size(); ++t)
  {
    const bool bright = scene.objects[t] % 3 == 1;
    scene.materials[t] = { bright ? 0.2 : std::pow(10.0, -4.0 - 5.0 * uniform(random)), 0.0, 1.0 };
  }
  return scene;
}
}

TEST(ScanAgain, PathsThatTheLightEnergyConstraintDropsOneByOne)
{
  for (const Scene& scene : { darkTown(), mattTown() })
  {
    for (const int rays : { 8, 40 })
    {
      EchoSettings settings = usual();
      settings.raysPerBeam = rays;
      Sensor sensor = wideSensor();
      sensor.lowerEnergyLimit = 1e-10;
      Series series(sensor, settings, scene);
      for (const double step : { 1.15, 1.0 / 1.16 })
      {
        for (int i = 0; i < 70; ++i)
        {
          series.setup.sensor.lowerEnergyLimit *= step;
          series.check(std::to_string(rays) + " rays, step " + std::to_string(i));
        }
      }
      EXPECT_GT(series.kept, 1000u);
    }
  }
}

TEST(ScanAgain, BeforeTheGateAndBeyond)
{
  // Dark houses before the gate are dropped while bright ones arrive beyond it: reports change
  // without an echo.
  Sensor sensor = wideSensor();
  sensor.rangeGate = 100.0;
  sensor.lowerEnergyLimit = 1e-9;
  Series series(sensor, usual(), mattTown());
  for (const double step : { 1.3, 1.0 / 1.4 })
  {
    for (int i = 0; i < 40; ++i)
    {
      series.setup.sensor.lowerEnergyLimit *= step;
      series.check("step " + std::to_string(i));
    }
  }
  const auto beyond = [&series]()
  {
    return std::count_if(series.result.reports.begin(), series.result.reports.end(),
      [](const BeamReport& report) { return report.status == BeamStatus::OutsideGate; });
  };
  EXPECT_GT(beyond(), 10);
  series.setup.sensor.upperEnergyLimit = 10.0;
  series.setup.sensor.lowerEnergyLimit = 5.0;
  series.check("nothing perceived");
  EXPECT_GT(series.kept, 1000u);
}

TEST(ScanAgain, AirFromNoneToFog)
{
  for (const Scene& scene : { town(), darkTown() })
  {
    Series series({}, usual(), scene);
    for (const double attenuation :
      { 0.0, 3.5e-5, 1e-3, 8.8e-4, 0.02, 0.021, 0.5, 1e-3, 1e-5, 0.0, 1e3, 3.5e-5 })
    {
      series.setup.settings.attenuationCoefficient = attenuation;
      series.check(std::to_string(attenuation));
    }
    for (double attenuation = 1e-4; attenuation < 0.2; attenuation *= 1.2)
    {
      series.setup.settings.attenuationCoefficient = attenuation;
      series.check(std::to_string(attenuation));
    }
    EXPECT_GT(series.kept, 100u);
  }
}

TEST(ScanAgain, WhereNothingIsDroppedSilentBeamsAreFollowedInFull)
{
  EchoSettings settings = usual();
  settings.lightEnergyConstraint = false;
  Series series({}, settings, darkTown());
  for (const double attenuation : { 1e-3, 0.02, 0.0 })
  {
    series.setup.settings.attenuationCoefficient = attenuation;
    series.check(std::to_string(attenuation));
    for (const BeamReport& report : series.result.reports)
    {
      ASSERT_EQ(report.skipped & SkippedBeam, 0u);
      ASSERT_EQ(report.lost, 0.0);
    }
  }
  EXPECT_GT(series.kept, 10u);
}

TEST(ScanAgain, AirAndLimitsAtRandom)
{
  Scene bright = town();
  std::fill(bright.materials.begin(), bright.materials.end(), Material{ 0.95, 0.0, 1.0 });
  Scene mirrors = town();
  for (std::size_t t = 0; t < mirrors.materials.size(); t += 2)
  {
    mirrors.materials[t] = { 1e-6, 0.9, 1e5 };
  }
  for (const Scene& scene : { darkTown(), bright, mirrors })
  {
    for (const int rays : { 6, 40 })
    {
      std::mt19937_64 random(rays);
      std::uniform_real_distribution<double> uniform(0.0, 1.0);
      EchoSettings settings = usual();
      settings.raysPerBeam = rays;
      settings.numberOfConnections = rays == 6 ? 1 : 8;
      Series series(wideSensor(), settings, scene);
      for (int step = 0; step < 60; ++step)
      {
        Sensor& sensor = series.setup.sensor;
        double& attenuation = series.setup.settings.attenuationCoefficient;
        const bool small = uniform(random) < 0.5;
        attenuation = small ? attenuation * (0.9 + 0.2 * uniform(random))
                            : std::pow(10.0, -5.0 * uniform(random));
        if (uniform(random) < 0.3)
        {
          sensor.lowerEnergyLimit = std::pow(10.0, -5.0 - 6.0 * uniform(random));
        }
        series.check(std::to_string(rays) + " rays, step " + std::to_string(step));
      }
    }
  }
}

TEST(ScanAgain, EverythingElse)
{
  Series series;
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
  change("no beam constraint", [&]() { settings.beamConstraint = false; });
  change("model", [&]() { settings.reflectanceModel = ReflectanceModel::Microfacet; });
  change("aperture", [&]() { sensor.receiverAperture = 100.0; });
  change("no aperture", [&]() { sensor.receiverAperture = 0.0; });
  // Of half the houses, as some are not seen.
  const std::size_t half = series.setup.objectIds.size() / 2;
  const auto renumber = [half](SharedVector<int>& ids) { std::fill_n(ids.begin(), half, 77); };
  change("objects", [&]() { renumber(series.setup.objectIds); });
  change("material ids", [&]() { renumber(series.setup.materialIds); });
  change("seed", [&]() { settings.seed = 9; });
  change("noise", [&]() { sensor.noisePhotonRate = 1e15; });
  change("quiet", [&]() { sensor.noisePhotonRate = 20e3; });
  change("target", [&]() { settings.targetRelativeError = 0.05; });
  change("dark with a target",
    [&]() {
      std::fill_n(series.setup.materials.begin(), half, Material{ 0.02, 0.3, 50.0 });
    });
  change("materials with a target",
    [&]() {
      std::fill_n(series.setup.materials.begin(), half, Material{ 0.3, 0.0, 1.0 });
    });
  change("no target", [&]() { settings.targetRelativeError = 0.0; });
  change("rays", [&]() { settings.raysPerBeam = 30; });
  EXPECT_GT(series.kept, 1000u);
}

TEST(ScanAgain, ChangesInAnyOrder)
{
  std::size_t kept = 0;
  for (const unsigned seed : { 1u, 2u, 3u })
  {
    std::mt19937_64 random(seed);
    const auto draw = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
    const auto factor = [&](double width)
    { return std::exp(width * std::normal_distribution<double>()(random)); };
    Series series;
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
          for (std::size_t t = 0; t < series.setup.materials.size(); ++t)
          {
            if (std::as_const(series.setup.objectIds)[t] == object)
            {
              series.setup.materials[t] = material;
            }
          }
        }
      }
      series.check("seed " + std::to_string(seed) + ", step " + std::to_string(step));
    }
    kept += series.kept;
  }
  EXPECT_GT(kept, 10000u);
}

namespace
{
/// Beams along x that differ by their random numbers alone.
ScanBeams alike(int count)
{
  ScanBeams beams;
  for (int i = 0; i < count; ++i)
  {
    beams.ids.push_back(i);
    beams.origins.push_back(Vec3(0.0));
    beams.directions.push_back(Vec3(1.0, 0.0, 0.0));
  }
  return beams;
}

/// Of beams half a radian wide about the mirror and its image.
Sensor mirrorSensor()
{
  Sensor sensor;
  sensor.halfBeamwidth = 0.5;
  sensor.pulseWidth = 0.0;
  sensor.lowerEnergyLimit = 0.0;
  sensor.upperEnergyLimit = 1e3;
  return sensor;
}

/// No noise at any Qlow, no air.
EchoSettings quiet(int rays, int connections = 0)
{
  EchoSettings settings = usual();
  settings.raysPerBeam = rays;
  settings.numberOfConnections = connections;
  settings.attenuationCoefficient = 0.0;
  settings.noise = false;
  return settings;
}

/// A surface 20 m away that reflects towards a wall 11 m beside it, at which the lidar looks
/// askance: the way by the mirror is some 54 m long, there and back to the wall directly 46 m.
Scene mirrorAndWall(const Material& mirror)
{
  Scene scene;
  scene.plate(Vec3(20.0, -5.0, 0.0), Vec3(3.36, 2.17, 0.0), Vec3(0.0, 0.0, 6.0), mirror, 1);
  scene.plate(Vec3(22.0, 6.0, 0.0), Vec3(4.0, 0.0, 0.0), Vec3(0.0, 0.0, 8.0), { 0.3, 0.0, 1.0 }, 2);
  return scene;
}

std::vector<double> strongestOf(const ScanResult& result)
{
  std::vector<double> energies(result.reports.size(), 0.0);
  for (std::size_t e = 0; e < result.echoes.size(); ++e)
  {
    double& energy = energies[result.beamOfEcho[e]];
    energy = std::max(energy, result.echoes[e].energyReceived);
  }
  return energies;
}

/// From air in which nothing is perceived to other air, with Qlow just below what each of the beams
/// receives there: what was concluded from the first must not keep it silent.
void expectHeardInOtherAir(Series& series, double first, double second)
{
  series.setup.settings.attenuationCoefficient = second;
  series.setup.sensor.lowerEnergyLimit = 0.0;
  series.check("energies");
  const std::vector<double> energies = strongestOf(series.result);
  for (std::size_t b = 0; b < energies.size(); ++b)
  {
    series.setup.settings.attenuationCoefficient = first;
    series.setup.sensor.lowerEnergyLimit = 1e3;
    series.check("silence");
    ASSERT_TRUE(series.result.echoes.empty());
    series.setup.settings.attenuationCoefficient = second;
    series.setup.sensor.lowerEnergyLimit = energies[b] * (1.0 - 1e-6);
    series.check("beam " + std::to_string(b));
    ASSERT_TRUE(energies[b] == 0.0 || series.result.reports[b].status == BeamStatus::Echo);
  }
}
}

TEST(ScanAgain, DroppedPathsCountAgainUnderALowerLimit)
{
  // Two plates in two range units, each below Qlow, and beside the stronger one a surface so dark
  // that its rays are dropped under the higher limit.
  Sensor sensor = mirrorSensor();
  sensor.halfBeamwidth = 0.05;
  EchoSettings settings = quiet(40);
  settings.numberOfReflections = 1;
  Scene scene;
  const Vec3 across(0.0, 10.0, 0.0);
  scene.plate(Vec3(50.0, -10.0, -9.0), across, Vec3(0.0, 0.0, 10.0), { 0.5, 0.0, 1.0 }, 1);
  scene.plate(Vec3(50.0, -10.0, 11.0), across, Vec3(0.0, 0.0, 10.0), { 1.4e-4, 0.0, 1.0 }, 2);
  scene.plate(Vec3(60.0, 0.0, 0.0), across, Vec3(0.0, 0.0, 10.0), { 0.3, 0.0, 1.0 }, 3);
  Series series(sensor, settings, scene, alike(1));
  const double energy = strongestOf(series.result)[0];
  series.setup.sensor.lowerEnergyLimit = 1.5 * energy;
  series.check("dropped");
  ASSERT_GT(series.result.reports[0].lost, 2e-5 * energy);
  series.setup.sensor.lowerEnergyLimit = (1.0 - 1e-5) * energy;
  series.check("counted");
  EXPECT_EQ(series.result.echoes.size(), 1u);
}

TEST(ScanAgain, PathsOverTwoReflectionsGainMoreThanAllHitsWhereAirClears)
{
  EchoSettings settings = quiet(16);
  settings.lightEnergyConstraint = false;
  Series series(mirrorSensor(), settings, mirrorAndWall({ 1e-6, 0.9, 1e5 }), alike(12));
  expectHeardInOtherAir(series, 0.1, 0.01);
}

TEST(ScanAgain, PathsThatWereCutToTheBudgetLoseNothingInDenserAir)
{
  // Walls in a corner, so bright that connections use up the budget; one to each ray, and some
  // within a stratum of two rays, which weigh more than the mean.
  Sensor sensor = mirrorSensor();
  sensor.halfBeamwidth = 0.05;
  sensor.samplingInterval = 1e-3;
  sensor.rangeGate = 1e6;
  EchoSettings settings = quiet(6, 1);
  settings.lightEnergyConstraint = false;
  Scene scene;
  for (const double side : { -1.0, 1.0 })
  {
    scene.plate(Vec3(191.0, side * 6.0, 0.0), Vec3(9.0, -side * 6.0, 0.0), Vec3(0.0, 0.0, 20.0),
      { 0.95, 0.0, 1.0 }, 1);
  }
  Series series(sensor, settings, scene, alike(40));
  expectHeardInOtherAir(series, 8e-4, 9.6e-4);
}

TEST(ScanAgain, PathsNotYetTracedArriveUnderALowerLimit)
{
  // What mirrors up leads nowhere, but keeps all paths together from being skipped; the faint gloss
  // of the other surface is traced under a lower limit, and arrives.
  Sensor sensor = mirrorSensor();
  sensor.samplingInterval = 1e-3;
  sensor.rangeGate = 1e6;
  sensor.lowerEnergyLimit = 2e-5;
  Scene scene = mirrorAndWall({ 0.1, 1e-6, 1e5 });
  scene.plate(Vec3(20.0, 0.0, 8.5), Vec3(0.0, 8.0, 0.0), Vec3(2.0, 0.0, 2.0), { 0.1, 0.5, 1e5 }, 3);
  Series series(sensor, quiet(40), scene, alike(4));
  for (int i = 0; i < 60; ++i)
  {
    series.setup.sensor.lowerEnergyLimit /= 1.2;
    series.check("step " + std::to_string(i));
  }
  EXPECT_GT(series.kept, 50u);
}

TEST(ScanAgain, APilotMeetsWhatTheBeamDoesNot)
{
  // With a target error the number of rays follows from what the pilot meets: materials that only
  // the pilot sees count, too.
  EchoSettings settings = quiet(100);
  settings.targetRelativeError = 0.3;
  Scene scene;
  scene.plate(
    Vec3(50.0, 0.0, 0.0), Vec3(0.0, 10.0, 0.0), Vec3(0.0, 0.0, 10.0), { 0.1, 0.0, 1.0 }, 1);
  scene.plate(Vec3(40.0, 0.0, 0.0), Vec3(0.0, 0.4, 0.0), Vec3(0.0, 0.0, 0.4), { 0.1, 0.0, 1.0 }, 2);
  scene.plate(Vec3(-9.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0), { 1.0, 0.0, 1.0 }, 3);
  Sensor sensor = mirrorSensor();
  sensor.halfBeamwidth = 0.05;
  Series series(sensor, settings, scene, alike(40));
  for (const double kd : { 1.0, 0.01, 0.5 })
  {
    series.setup.materials[2].kd = kd;
    series.setup.materials[3].kd = kd;
    series.check(std::to_string(kd));
  }
}

TEST(ScanAgain, WhatIsKnownOfPathsDoesNotChangeTheReport)
{
  // The mirror is so dark from ahead that its direct echoes are dropped; what comes back by the
  // wall arrives beyond the gate.
  for (const int rays : { 1, 2, 3 })
  {
    Sensor sensor = mirrorSensor();
    sensor.rangeGate = 24.0;
    sensor.lowerEnergyLimit = 1e-3;
    Series series(sensor, quiet(rays), mirrorAndWall({ 1e-12, 0.9, 1e5 }), alike(40));
    for (const double step : { 0.8, 1.3 })
    {
      for (int i = 0; i < 30; ++i)
      {
        series.setup.sensor.lowerEnergyLimit *= step;
        series.check(std::to_string(rays) + " rays, step " + std::to_string(i));
      }
    }
  }
}

TEST(ScanAgain, WhereEnergiesUnderflow)
{
  for (const bool constraint : { true, false })
  {
    for (const double gate : { 4000.0, 15.0 })
    {
      Sensor sensor = mirrorSensor();
      sensor.rangeGate = gate;
      EchoSettings settings = quiet(16);
      settings.lightEnergyConstraint = constraint;
      Scene scene = mirrorAndWall({ 1e-6, 0.9, 1e5 });
      Series series(sensor, settings, scene, alike(12));
      for (double first = 10.0; first < 22.0; first += 0.7)
      {
        series.setup.sensor.upperEnergyLimit = 1e9;
        for (const double second : { first + 0.3, first + 3.0, 5.0, 0.5 })
        {
          series.setup.settings.attenuationCoefficient = second;
          series.setup.sensor.lowerEnergyLimit = 0.0;
          series.check("energies");
          const double energy = strongestOf(series.result)[3];
          series.setup.settings.attenuationCoefficient = first;
          series.setup.sensor.lowerEnergyLimit = 1e8;
          series.check("first");
          series.setup.settings.attenuationCoefficient = second;
          for (const double limit : { energy * (1.0 - 1e-6), 1e-322, 1e8 })
          {
            series.setup.sensor.lowerEnergyLimit = limit;
            series.check(
              "from " + std::to_string(first) + " to " + std::to_string(second) + " per m");
          }
        }
      }
    }
  }
}

TEST(ScanAgain, AnotherResultOrAnotherCacheStartsAfresh)
{
  Series series;
  const ScanResult first = series.result;
  series.setup.settings.attenuationCoefficient = 1e-3;
  series.check("air");
  EXPECT_EQ(series.result.before, first.run);
  // The result before the last is not what the cache remembers.
  series.result = first;
  series.check("an older result");
  EXPECT_EQ(series.result.before, 0u);
  series.result = ScanResult{};
  series.check("no result");
  EXPECT_EQ(series.result.before, 0u);
  Series other;
  other.setup.sensor.lowerEnergyLimit *= 1.5;
  other.result = series.result;
  other.check("the result of another cache");
  EXPECT_EQ(other.result.before, 0u);
}

TEST(ScanAgain, ACacheThatIsTooSmallRemembersNothing)
{
  Series series;
  for (const std::size_t bytes : { std::size_t(0), std::size_t(200000) })
  {
    for (int run = 0; run < 2; ++run)
    {
      series.setup.sensor.lowerEnergyLimit *= 1.01;
      ASSERT_TRUE(
        simulateScan(series.setup, series.beams, 2, series.cache, bytes, {}, series.result));
      expectSame(series.result, runScan(series.setup, series.beams));
    }
    EXPECT_EQ(series.result.before, 0u);
    EXPECT_EQ(series.cache.memory.run, 0u);
    EXPECT_LE(series.cache.bytes(), bytes + series.beams.size() * sizeof(BeamTrace));
  }
}

TEST(ScanAgain, NothingIsRememberedThatIsOfNoUse)
{
  EchoSettings settings = usual();
  settings.targetRelativeError = 0.2;
  Series series({}, settings);
  EXPECT_EQ(series.cache.memory.run, 0u);
  EXPECT_EQ(series.cache.memory.bytes(), 0u);
  series.setup.settings.attenuationCoefficient = 1e-3;
  series.check("air");
  EXPECT_EQ(series.result.before, 0u);
  EXPECT_EQ(series.cache.memory.run, 0u);
}

TEST(ScanAgain, BytesOfAResultIncludeItsChanges)
{
  Series series;
  series.setup.settings.attenuationCoefficient = 1e-3;
  series.check("air");
  ASSERT_FALSE(series.result.changed.empty());
  const std::size_t all = series.result.bytes();
  EXPECT_EQ(series.cache.memory.resultBytes, all);
  const std::size_t changed = series.result.changed.capacity() * sizeof(std::uint32_t);
  std::vector<std::uint32_t>().swap(series.result.changed);
  EXPECT_EQ(series.result.bytes(), all - changed);
}

TEST(ScanAgain, AStoppedRunLeavesNothing)
{
  Series series;
  series.setup.settings.attenuationCoefficient = 1e-3;
  int calls = 0;
  const auto stop = [&calls](double) { return ++calls < 2; };
  EXPECT_FALSE(simulateScan(
    series.setup, series.beams, 1, series.cache, std::size_t(1) << 30, stop, series.result));
  EXPECT_TRUE(series.result.echoes.empty());
  EXPECT_EQ(series.cache.memory.run, 0u);
  series.check("after the stop");
}

TEST(ScanAgain, BeamsOfAKnownChecksumAreNotLookedAt)
{
  Series series;
  ScanBeams beams = series.beams;
  beams.checksum = checksumOf(beams);
  EXPECT_EQ(traceKey(series.setup, beams), traceKey(series.setup, series.beams));
  beams.directions[3].x += 1e-3;
  const std::uint64_t other = checksumOf(beams);
  EXPECT_NE(other, beams.checksum);
  beams.checksum = 0;
  EXPECT_NE(traceKey(series.setup, beams), traceKey(series.setup, series.beams));
}

TEST(ScanAgain, WhatIsBelowStaysBelowWhereNoPathCanGainMore)
{
  BeamOutcome outcome;
  outcome.attenuation = 1e-3;
  outcome.loudest = 1e-6;
  outcome.surest = 1e-8;
  outcome.shortest = 100.0;
  outcome.longest = 300.0;
  const auto holds = [&](double limit, double attenuation, double threshold = 1e-10) {
    return outcome.holds({ limit, attenuation, threshold });
  };
  EXPECT_TRUE(holds(1.001e-6, 1e-3));
  EXPECT_FALSE(holds(1e-6, 1e-3)); // too near to say
  // Clearer air: the longest path gains most. Denser: the shortest loses least.
  EXPECT_TRUE(holds(1.001e-6 * std::exp(0.15), 5e-4));
  EXPECT_FALSE(holds(0.999e-6 * std::exp(0.15), 5e-4));
  EXPECT_TRUE(holds(1.001e-6 * std::exp(-0.1), 2e-3));
  EXPECT_FALSE(holds(0.999e-6 * std::exp(-0.1), 2e-3));
  // The surest path must not be dropped, or the report might say another thing.
  EXPECT_TRUE(holds(1e-5, 2e-3, 0.99e-8 * std::exp(-0.3)));
  EXPECT_FALSE(holds(1e-5, 2e-3, 1.01e-8 * std::exp(-0.3)));
  EXPECT_FALSE(holds(1e-5, 100.0, 0.0));
  // Near underflow nobody knows whether it arrives, nor what was lost of the loudest.
  EXPECT_TRUE(holds(1e-5, 2.1, 0.0));
  EXPECT_FALSE(holds(1e-5, 2.3, 0.0));
  BeamOutcome silent = outcome;
  silent.loudest = 0.0;
  EXPECT_TRUE(silent.holds({ 1e-280, 1e-3, 0.0 }));
  EXPECT_FALSE(silent.holds({ 1e-300, 1e-3, 0.0 }));
  // Echoes stay in the same air alone, and while the limit parts the same units.
  outcome.echoes = 1;
  outcome.window.atLeast(1e-7);
  outcome.window.below(3e-7);
  EXPECT_TRUE(holds(1e-7, 1e-3));
  EXPECT_FALSE(holds(3e-7, 1e-3));
  EXPECT_FALSE(holds(0.9e-7, 1e-3));
  EXPECT_FALSE(holds(2e-7, 1.1e-3));
}
