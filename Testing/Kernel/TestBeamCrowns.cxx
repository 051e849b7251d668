// SPDX-License-Identifier: BSD-3-Clause
// Crowns of leaves against leaves that an independent program places one by one.
#include "FollowedAir.h"
#include "MediumTestScene.h"
#include "Sanitized.h"
#include "Statistics.h"

#include <cmath>

using namespace echotest;

TEST(BeamCrowns, LeavesThatStayReturnTheSameInEveryScan)
{
  Sensor sensor = search905();
  Medium leaves{ 0.5, 30.0, 20.0, SquareOfLeaves, 0.0, false, 9, true };
  const MediumVolume crown = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(4.0, 50.0, 50.0));
  const auto energies = [&](double renewed, int revolution)
  {
    leaves.renewed = renewed;
    ScanSetup setup = inMedium(Scene{}, sensor, leaves, crown);
    setup.noise.active = true; // of leaves alone: the receiver's is far below
    setup.settings.noise = true;
    planModel(setup);
    setup.revolution = revolution;
    return sumsOfBeams(
      runScan(setup, alike(300)), 300, [](const Echo& echo) { return echo.energyReceived; });
  };
  const auto correlation = [](const std::vector<double>& a, const std::vector<double>& b)
  {
    double sa = 0.0, sb = 0.0, saa = 0.0, sbb = 0.0, sab = 0.0;
    const auto n = static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
    {
      sa += a[i];
      sb += b[i];
      saa += a[i] * a[i];
      sbb += b[i] * b[i];
      sab += a[i] * b[i];
    }
    return (n * sab - sa * sb) / std::sqrt((n * saa - sa * sa) * (n * sbb - sb * sb));
  };
  EXPECT_GT(correlation(energies(0.0, 1), energies(0.0, 2)), 0.9);
  EXPECT_LT(std::fabs(correlation(energies(1.0, 1), energies(1.0, 2))), 0.2);
  EXPECT_NEAR(correlation(energies(0.5, 1), energies(0.5, 2)), 0.5, 0.2);
}

/// A crown of leaves of 40 cm2 that face all ways, before a wall, and a lidar. Expected values are
/// those of an independent program, which places leaves one by one as discs in space and follows
/// rays to points of the beam and back to points of the aperture: means and standard errors of
/// 4,000 to 16,000 crowns with fixed seeds, of 24 rays each or, where shares of beams are given, of
/// 120.
struct CrownCase
{
  double halfBeamwidth, aperture; ///< rad, m in radius
  double density;                 ///< m2/m3
  double begin, end, wall;        ///< m
  std::array<double, 2> behind;   ///< light of the wall, over that in clear air
  std::array<double, 2> leaves;   ///< 1/m2: share of the pulse that leaves return, 3/2 cos/r2 of it
  /// Shares of beams with less than 2 % and with more than 98 % of the wall's light; below 0: not
  /// known.
  double dark, bright;
};
constexpr CrownCase CrownCases[] = {
  { 5.6e-3, 0.05, 1.0, 8.5, 11.5, 50.0, { 0.0956, 0.0009 }, { 8.244e-3, 2.2e-5 }, -1.0, -1.0 },
  { 3e-3, 0.075, 1.0, 33.5, 36.5, 50.0, { 0.1300, 0.0011 }, { 6.391e-4, 1.5e-6 }, -1.0, -1.0 },
  { 3e-3, 0.075, 0.6, 6.0, 10.0, 14.0, { 0.1687, 0.0017 }, { 1.2149e-2, 6.4e-5 }, -1.0, -1.0 },
  { 9.5e-4, 0.0125, 1.0, 4.0, 6.0, 40.0, { 0.3048, 0.0032 }, { 2.786e-2, 1.9e-4 }, -1.0, -1.0 },
  { 9.5e-4, 0.0125, 1.0, 10.0, 13.0, 15.0, { 0.2054, 0.0035 }, { 6.332e-3, 4.1e-5 }, 0.544, 0.046 },
  { 5.6e-3, 0.05, 1.0, 10.0, 13.0, 15.0, { 0.1639, 0.0018 }, { 6.149e-3, 2.6e-5 }, 0.059, 0.0 },
  { 9.5e-4, 0.0125, 0.5, 20.0, 25.0, 40.0, { 0.2518, 0.0031 }, { 1.4892e-3, 9.3e-6 }, 0.289,
    0.015 },
  { 3e-3, 0.075, 1.0, 10.0, 13.0, 40.0, { 0.0795, 0.0017 }, { 6.062e-3, 4.0e-5 }, 0.400, 0.0 },
};

Medium leavesOf(double density)
{
  return { 0.5 * density, 10.5, 250.0 * density, SquareOfLeaves, 1.0, false, 9, true };
}

MediumVolume crownOf(const CrownCase& of)
{
  return boxOf(
    Vec3(0.5 * (of.begin + of.end), 0.0, 0.0), Vec3(0.5 * (of.end - of.begin), 50.0, 50.0));
}

Sensor lidarOf(const CrownCase& of)
{
  Sensor sensor = search905();
  sensor.halfBeamwidth = of.halfBeamwidth;
  sensor.receiverAperture = Pi * of.aperture * of.aperture;
  sensor.pulseEnergy *= 0.0025 / (of.aperture * of.aperture); // so that it receives as much
  sensor.rangeGate = 60.0;
  EXPECT_EQ(setPhotonLimits(sensor, 1e-4, 40.0, 15360.0), "");
  return sensor;
}

TEST(BeamCrowns, TheWayBackMeetsOtherLeaves)
{
  for (const CrownCase& of : CrownCases)
  {
    const Sensor sensor = lidarOf(of);
    FollowedAir air(sensor, { 0.0, { { leavesOf(of.density), crownOf(of) } } });
    air.begin(makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth));
    EXPECT_NEAR(air.transmission(of.wall), of.behind[0], 3.0 * of.behind[1]) << of.wall;
    double leaves = 0.0;
    for (std::int64_t unit = 0; unit < 100; ++unit)
    {
      for (const AirLight::Share& share : air.sharesOf(unit))
      {
        leaves += share.mean * 10.5 / (sensor.pulseEnergy * sensor.receiverAperture);
      }
    }
    EXPECT_NEAR(leaves, of.leaves[0], 3.0 * of.leaves[1]) << of.wall;
    // Along one direction, as coverage sees it.
    air.beginRay(Vec3(1.0, 0.0, 0.0));
    EXPECT_NEAR(air.transmission(of.wall), of.behind[0], 3.0 * of.behind[1]) << of.wall;
  }
}

constexpr std::size_t Scans = 1500;

ScanResult throughLeaves(const CrownCase& of, bool noise)
{
  ScanSetup setup = inMedium(wallAt(of.wall), lidarOf(of), leavesOf(of.density), crownOf(of));
  setup.noise.active = noise; // of leaves alone: the receiver's is far below
  setup.settings.noise = noise;
  setup.settings.returnMode = ReturnMode::RangeUnits;
  planModel(setup);
  return runScan(setup, alike(noise ? Scans : 1));
}

TEST(BeamCrowns, ABeamMeetsLeavesWithAPartOfIt)
{
  int looked = 0;
  for (const CrownCase& of : CrownCases)
  {
    if (of.dark < 0.0 || (IsSanitized && ++looked > 1))
    {
      continue;
    }
    CrownCase without = of;
    without.density = 1e-9;
    const double clear = receivedFrom(throughLeaves(without, false));
    const std::vector<double> walls = sumsOfBeams(throughLeaves(of, true), Scans,
      [&](const Echo& echo) { return echo.range > of.end + 1.0 ? echo.energyReceived : 0.0; });
    const auto count = [&](double from, double to)
    {
      return static_cast<double>(std::count_if(walls.begin(), walls.end(),
               [=](double energy) { return energy >= from * clear && energy < to * clear; })) /
        static_cast<double>(Scans);
    };
    EXPECT_NEAR(count(-1.0, 0.02), of.dark, 0.045) << of.wall;
    EXPECT_NEAR(count(0.98, 2.0), of.bright, 0.02) << of.wall;
  }
}

/// A small plate behind a crown of 3 m, in the middle of a beam that is narrow or much wider than
/// leaves. Expected values are those of the independent program, for 4,000 crowns and 64 rays to
/// the plate.
struct PlateCase
{
  double halfBeamwidth, aperture; ///< rad, m in radius
  double begin, plate;            ///< m
  double halfWidth, halfHeight;   ///< m
  std::array<double, 2> mean;     ///< light of the plate, over that in clear air
  double deviation;               ///< standard deviation of this light
  double dark;                    ///< share of beams with less than 2 % of the light
};

constexpr PlateCase PlateCases[] = {
  { 3e-3, 0.075, 30.0, 35.0, 0.01, 0.008, { 0.1921, 0.0049 }, 0.3107, 0.5815 },
  { 5.6e-3, 0.05, 95.0, 100.0, 0.01, 0.008, { 0.2177, 0.0052 }, 0.3282, 0.5495 },
  { 5.6e-3, 0.05, 95.0, 100.0, 0.1, 0.05, { 0.2135, 0.0018 }, 0.1169, 0.0165 },
};

namespace
{
/// Light of the echoes that pass a test, J, for each of Scans scans with drawn leaves.
template <class F>
std::vector<double> lightOfScans(ScanSetup setup, F isWanted)
{
  setup.settings.noise = true;
  setup.settings.returnMode = ReturnMode::RangeUnits;
  planModel(setup);
  return sumsOfBeams(runScan(setup, alike(Scans)), Scans,
    [&](const Echo& echo) { return isWanted(echo) ? echo.energyReceived : 0.0; });
}
}

TEST(BeamCrowns, LeavesHideSmallObjectsOrDoNot)
{
  for (const PlateCase& of : PlateCases)
  {
    if (IsSanitized && &of != PlateCases)
    {
      break;
    }
    const Sensor sensor =
      lidarOf({ of.halfBeamwidth, of.aperture, 1.0, 0.0, 0.0, 0.0, {}, {}, 0.0, 0.0 });
    const auto seen = [&](double density, bool wall)
    {
      Scene scene;
      scene.plate(Vec3(of.plate, 0.0, 0.0), Vec3(0.0, of.halfWidth, 0.0),
        Vec3(0.0, 0.0, of.halfHeight), Wall, 7);
      if (wall)
      {
        scene.square(Vec3(of.plate + 8.0, 0.0, 0.0), 50.0, Wall, 8);
      }
      Sensor wide = sensor;
      wide.rangeGate = 130.0;
      wide.lowerEnergyLimit = 1e-30;
      wide.receiverModel = ReceiverModel::EnergyLimits;
      return lightOfScans(inMedium(scene, wide, leavesOf(density),
                            boxOf(Vec3(of.begin + 1.5, 0.0, 0.0), Vec3(1.5, 50.0, 50.0))),
        [&](const Echo& echo)
        { return std::fabs(echo.range - of.plate) < 1.5 && echo.objectId == 7; });
    };
    const double clear = statistics::sumOf(seen(1e-9, false)) / static_cast<double>(Scans);
    for (const bool wall : { false, true })
    {
      statistics::Moments shares;
      double dark = 0.0;
      for (const double energy : seen(1.0, wall))
      {
        shares.add(energy / clear);
        dark += energy < 0.02 * clear ? 1.0 / static_cast<double>(Scans) : 0.0;
      }
      const double deviation = std::sqrt(shares.variance());
      const double error = std::hypot(of.mean[1], shares.error());
      EXPECT_NEAR(shares.mean(), of.mean[0], 3.0 * error) << of.plate << " " << wall;
      EXPECT_NEAR(deviation / of.deviation, 1.0, 0.08) << of.plate << " " << wall;
      EXPECT_NEAR(dark, of.dark, 0.045) << of.plate << " " << wall;
    }
  }
}

/// A crown of 4 m before a wall; where nothing is wider than leaves.
constexpr CrownCase ThinRay{ 1e-8, 1e-6, 1.0, 18.0, 22.0, 40.0, {}, {}, 0.0, 0.0 };

TEST(BeamCrowns, AThinRayEndsAtItsFirstLeafOrPasses)
{
  const double left = std::exp(-2.0);
  const ScanResult result = throughLeaves(ThinRay, true);
  std::vector<double> depths(Scans, 0.0);
  std::vector<double> walls(Scans, 0.0);
  for (std::size_t k = 0; k < result.echoes.size(); ++k)
  {
    const Echo& echo = result.echoes[k];
    const std::size_t beam = result.beamOfEcho[k];
    if (echo.objectId == 9)
    {
      EXPECT_EQ(depths[beam], 0.0) << "leaves at two depths";
      depths[beam] = echo.range - 18.0;
    }
    walls[beam] += echo.objectId == 7 ? echo.energyReceived : 0.0;
  }
  const double unit = Sensor{ search905() }.rangeUnitLength();
  const double end = unit * std::ceil(18.0 / unit); // of the first unit in the crown
  double passed = 0.0, first = 0.0;
  for (std::size_t beam = 0; beam < depths.size(); ++beam)
  {
    passed += walls[beam] > 0.0 ? 1.0 : 0.0;
    first += depths[beam] > 0.0 && depths[beam] < end - 18.0 ? 1.0 : 0.0;
    EXPECT_NE(walls[beam] > 0.0, depths[beam] > 0.0);
  }
  const auto within = [](double count, double share)
  {
    EXPECT_NEAR(count, static_cast<double>(Scans) * share,
      3.0 * std::sqrt(static_cast<double>(Scans) * share * (1.0 - share)));
  };
  within(passed, left);
  within(first, 1.0 - std::exp(-0.5 * (end - 18.0)));
}

TEST(BeamCrowns, LeavesAreDrawnWithoutNoisePhotons)
{
  // The independent program gives a standard deviation of 0.99 +- 0.05 of the mean.
  const CrownCase of{ 9.5e-4, 0.0125, 1.0, 30.0, 33.0, 35.0, {}, {}, 0.0, 0.0 };
  for (const double rate : { 0.0, 1e-3 })
  {
    Sensor sensor = lidarOf(of);
    sensor.receiverModel = ReceiverModel::EnergyLimits;
    sensor.lowerEnergyLimit = 1e-30;
    sensor.noisePhotonRate = rate;
    statistics::Moments walls;
    for (const double energy :
      lightOfScans(inMedium(wallAt(of.wall), sensor, leavesOf(of.density), crownOf(of)),
        [&](const Echo& echo) { return echo.range > of.end + 1.0; }))
    {
      walls.add(energy);
    }
    EXPECT_NEAR(std::sqrt(walls.variance()) / walls.mean(), 0.99, 0.1) << rate;
  }
}

TEST(BeamCrowns, NoiseOfLeavesLeavesTheMean)
{
  for (const double halfBeamwidth : { 1e-4, 1e-3, 4e-3, 2e-2 })
  {
    if (IsSanitized && halfBeamwidth != 4e-3)
    {
      continue;
    }
    CrownCase of = ThinRay;
    of.halfBeamwidth = halfBeamwidth;
    of.aperture = 0.05;
    const ScanResult noisy = throughLeaves(of, true);
    const ScanResult quiet = throughLeaves(of, false);
    for (const bool isWall : { false, true })
    {
      const auto energyOf = [=](const Echo& echo)
      { return (echo.range > 30.0) == isWall ? echo.energyReceived : 0.0; };
      statistics::Moments beams;
      for (const double energy : sumsOfBeams(noisy, Scans, energyOf))
      {
        beams.add(energy);
      }
      const double mean = sumsOfBeams(quiet, 1, energyOf)[0];
      EXPECT_NEAR(beams.mean(), mean, 3.5 * beams.error() + 2e-3 * mean)
        << halfBeamwidth << (isWall ? " wall" : " leaves");
    }
  }
}
