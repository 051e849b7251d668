// SPDX-License-Identifier: BSD-3-Clause
// Media that do not fill the scene: boxes that hold everything against air that fills it, walls
// behind and before parts of them, rain and layers.
#include "FollowedAir.h"
#include "MediumTestScene.h"
#include "ScanTestTown.h"
#include "SecondaryTestScene.h"
#include "Statistics.h"

#include <cmath>
#include <limits>

using namespace echotest;

TEST(BeamAir, ABoxThatHoldsEverythingIsAirThatFillsTheScene)
{
  const Sensor sensor = search905();
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.2, 0.1), sensor.halfBeamwidth);
  for (Medium medium : { Medium{ 4e-3, 18.8, 0.0 }, rainOf(10.0, 20.0, {}) })
  {
    const double clear = 1e-4;
    FollowedAir echo(sensor, { clear, { { medium, {} } } });
    FollowedAir air(sensor, { clear, { { medium, boxOf(Vec3(0.0), Vec3(1e4)) } } });
    air.begin(frame);
    ASSERT_TRUE(air.along.isLocal());
    for (const std::int64_t unit : { 0, 1, 3, 20, 300, 1000 })
    {
      const double mean = air.followed(unit);
      EXPECT_NEAR(mean / echo.followed(unit), 1.0, unit == 0 ? 1e-3 : 2e-6) << unit;
      if (medium.drops > 0.0)
      {
        EXPECT_NEAR(air.sharesOf(unit)[0].drops / echo.sharesOf(unit)[0].drops, 1.0, 1e-5);
      }
    }
    EXPECT_NEAR(air.transmission(500.0), std::exp(-1000.0 * medium.extinction), 1e-12);
    EXPECT_EQ(air.along.alone().empty(), !(medium.drops > 0.0));
  }
}

TEST(BeamAir, UnitsAreLookedAtWhereMediaMayBePerceived)
{
  const Sensor sensor = search905();
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth);
  Medium leaves{ 0.15, 11.8, 30.0, SquareOfLeaves };
  leaves.isFollowed = false;
  leaves.sharesGaps = true;
  const double length = sensor.rangeUnitLength();
  const auto unitAt = [=](double range) { return static_cast<std::int64_t>(range / length); };
  // A tree, a gap, and a wood that is deeper than light goes.
  const std::vector<PlacedMedium> placed = { { leaves, boxOf(Vec3(105.0, 0.0, 0.0), Vec3(5.0)) },
    { leaves, boxOf(Vec3(650.0, 0.0, 0.0), Vec3(350.0, 50.0, 50.0)) } };
  std::vector<PlacedMedium> andRain = placed;
  andRain.insert(andRain.begin(), { rainOf(10.0, 20.0, {}), {} });
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  FollowedAir air(sensor, { 1e-4, placed });
  air.begin(frame);
  EXPECT_EQ(air.light.nextLooked(0, 0), unitAt(100.0));
  EXPECT_EQ(air.light.nextLooked(unitAt(200.0), 0), unitAt(300.0));
  for (std::int64_t unit = 0; unit < unitAt(1100.0); ++unit)
  {
    double mean = 0.0;
    for (const AirLight::Share& share : air.sharesOf(unit))
    {
      mean += share.mean;
    }
    EXPECT_TRUE(air.light.nextLooked(unit, 0) == unit || mean < 2e-6 * sensor.lowerEnergyLimit)
      << unit;
  }
  EXPECT_EQ(air.light.nextLooked(unitAt(600.0), 0), most);
  // Air that fills the scene is looked at as far as the receiver says.
  FollowedAir inRain(sensor, { 0.0, andRain });
  inRain.begin(frame);
  EXPECT_EQ(inRain.light.nextLooked(0, 20), 0);
  EXPECT_EQ(inRain.light.nextLooked(20, 20), unitAt(100.0));
}

TEST(BeamAir, AVolumeThatABeamPassesReturnsNothing)
{
  // A thin box along a diagonal: the ball about it reaches the beam, the box does not.
  const Sensor sensor = search905();
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth);
  const std::vector<PlacedMedium> rain = { { rainOf(10.0, 20.0, {}), {} } };
  std::vector<PlacedMedium> andBox = rain;
  andBox.push_back({ { 0.15, 11.8, 30.0 }, boxOf(Vec3(100.0, 50.0, 0.0), Vec3(1.0, 40.0, 60.0)) });
  ASSERT_TRUE(mayMeet(andBox[1].volume, frame, sensor.rangeGate, 0.0));
  FollowedAir alone(sensor, { 0.0, rain });
  alone.begin(frame);
  FollowedAir air(sensor, { 0.0, andBox });
  const auto expectRain = [&]()
  {
    EXPECT_FALSE(air.along.isLocal());
    for (const std::int64_t unit : { 3, 20, 70, 300 })
    {
      ASSERT_EQ(air.sharesOf(unit).size(), 1u) << unit;
      EXPECT_EQ(air.sharesOf(unit)[0].mean, alone.sharesOf(unit)[0].mean) << unit;
    }
  };
  air.begin(frame);
  expectRain();
  air.beginRay(Vec3(1.0, 0.0, 0.0));
  expectRain();
}

TEST(BeamAir, AVolumeAboutALidarWithoutNearViewIsLookedAtBeyondIt)
{
  // Nothing is gathered from range 0, but light remains for later units.
  Sensor sensor = search905();
  sensor.minimumRange = 0.0;
  sensor.overlapRange = 20.0;
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth);
  Medium smoke{ 4e-3, 18.8, 0.0 };
  smoke.isFollowed = false;
  FollowedAir air(sensor, { 0.0, { { smoke, boxOf(Vec3(0.0), Vec3(200.0)) } } });
  air.begin(frame);
  for (const std::int64_t unit : { 0, 1, 2, 20 })
  {
    EXPECT_EQ(air.light.nextLooked(unit, 0), unit);
    air.sharesOf(unit);
  }
}

TEST(BeamAir, WhatSurfacesMeetTheAirDoesNotReturn)
{
  const Sensor sensor = search905();
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth);
  const Medium fog{ 4e-3, 18.8, 0.0 };
  FollowedAir echo(sensor, { 0.0, { { fog, {} } } });
  for (const bool isLocal : { false, true })
  {
    Air all{ 0.0, { { fog, {} } } };
    if (isLocal)
    {
      all.media.push_back({ { 0.0, 1.0, 0.0 }, boxOf(Vec3(0.0), Vec3(9.0)) });
    }
    FollowedAir air(sensor, all);
    air.begin(frame);
    EXPECT_EQ(air.along.isLocal(), isLocal);
    air.take({ { 100.0, 0.25, 0 }, { 60.0, 0.25, 0 }, { 100.2, 0.5, 0 } });
    for (const auto& [range, open] : { std::pair(30.0, 1.0), std::pair(80.0, 0.75),
           std::pair(120.0, 0.0), std::pair(3000.0, 0.0), std::pair(30.0, 1.0) })
    {
      const auto unit = static_cast<std::int64_t>(range / sensor.rangeUnitLength());
      const double clear = echo.followed(unit);
      EXPECT_NEAR(air.followed(unit), open * clear, 1e-5 * clear);
    }
  }
}

TEST(BeamAir, NoRainIsSeenThroughAWall)
{
  Sensor sensor = search905();
  const Medium rain = rainOf(10.0, 20.0, {});
  EchoSettings settings = directSettings(100);
  settings.noise = true;
  int everywhere = 0;
  for (const bool isLocal : { false, true })
  {
    ScanSetup setup = makeSetup(wallAt(60.0), sensor, settings);
    setup.media = { { rain, isLocal ? boxOf(Vec3(0.0), Vec3(1e4)) : MediumVolume() } };
    planModel(setup);
    const ScanResult result = runScan(setup, alike(200));
    int before = 0;
    int behind = 0;
    for (const Echo& echo : result.echoes)
    {
      before += echo.range < 58.0 && echo.objectId == ObjectOfAir;
      behind += echo.range > 62.0 && echo.objectId == ObjectOfAir;
    }
    EXPECT_GT(before, 500);
    // The same drops either way.
    everywhere = isLocal ? everywhere : before;
    EXPECT_NEAR(before, everywhere, 0.01 * everywhere);
    EXPECT_EQ(behind, 0);
  }
}

TEST(BeamAir, SurfacesBehindAreWeakenedWhereTheMediumIs)
{
  Sensor sensor = openSensor(5.6e-3);
  const double clear = onlyEcho(wallAt(200.0), sensor, directSettings(400)).energyReceived;
  const Medium fog{ 0.05, 18.8, 0.0 };
  const double weak = std::exp(-2.0 * 0.05 * 20.0);
  for (const bool cells : { false, true })
  {
    // All of the beam, half of it (the box ends at y = 0), and a wall that only the other half has.
    const auto received = [&](const Scene& scene, const MediumVolume& volume)
    { return receivedFrom(runScan(inMedium(scene, sensor, fog, volume, cells), oneBeam())); };
    const MediumVolume whole = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(10.0, 50.0, 50.0));
    const MediumVolume half = boxOf(Vec3(100.0, -50.0, 0.0), Vec3(10.0, 50.0, 50.0));
    EXPECT_NEAR(received(wallAt(200.0), whole) / clear, weak, 2e-3);
    EXPECT_NEAR(received(wallAt(200.0), meshOf(half)) / clear, 0.5 * (1.0 + weak), 2e-2);
    EXPECT_NEAR(received(wallAt(200.0), half) / clear, 0.5 * (1.0 + weak), 2e-2);
    EXPECT_NEAR(received(wallAt(200.0, 0.0, 50.0), half) / clear, 0.5, 2e-2);
    EXPECT_NEAR(received(wallAt(200.0, -50.0, 0.0), half) / clear, 0.5 * weak, 2e-2);
    EXPECT_NEAR(received(wallAt(80.0), half) / clear, 1.0, 2e-3);
  }
}

TEST(BeamAir, PathsOverTwoReflectionsPassTheMediumToo)
{
  const Scene scene = groove(0.9, Metal);
  Sensor sensor = openSensor(2e-3);
  const Medium fog{ 0.01, 18.8, 0.0 };
  MediumVolume all = boxOf(Vec3(0.0), Vec3(1e4));
  for (const int connections : { 0, 4 })
  {
    ScanSetup clear =
      makeSetup(scene, sensor, secondarySettings(100, connections, BeamSampleSource::Cells));
    ScanSetup uniform = clear;
    uniform.settings.attenuationCoefficient = fog.extinction;
    planModel(uniform);
    ScanSetup placed = clear;
    placed.media = { { fog, all } };
    planModel(placed);
    const ScanBeams beam = oneBeam(Vec3(1.0, 0.0, 0.02));
    const ScanResult a = runScan(uniform, beam);
    const ScanResult b = runScan(placed, beam);
    ASSERT_EQ(a.echoes.size(), b.echoes.size());
    ASSERT_FALSE(a.echoes.empty());
    double ofPaths = 0.0;
    for (std::size_t k = 0; k < a.echoes.size(); ++k)
    {
      EXPECT_NEAR(b.echoes[k].energyReceived / a.echoes[k].energyReceived, 1.0, 2e-3);
      ofPaths += a.echoes[k].secondaryShare;
    }
    EXPECT_GT(ofPaths, 0.01);
  }
}

TEST(BeamAir, ATreeReturnsLightAndLetsPass)
{
  // Beer and Lambert: of the beam exp(-mu L) reaches the wall, and the crown returns the rest by
  // the lidar equation.
  Sensor sensor = openSensor(5.6e-3);
  sensor.receiverAperture = 0.0078539816;
  sensor.samplingInterval = 5e-9;
  Medium leaves{ 0.3, 30.0, 0.0 };
  leaves.isFollowed = false;
  leaves.objectId = 9;
  leaves.sharesGaps = true;
  const MediumVolume crown = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(4.0, 50.0, 50.0));
  const ScanResult result = runScan(inMedium(wallAt(200.0), sensor, leaves, crown), oneBeam());
  ASSERT_EQ(result.echoes.size(), 2u);
  EXPECT_EQ(result.echoes[0].objectId, 9);
  EXPECT_NEAR(result.echoes[0].labelShare, 1.0, 1e-9);
  double crowns = 0.0; // by midpoints
  constexpr int steps = 100000;
  for (int i = 0; i < steps; ++i)
  {
    const double r = 96.0 + 8.0 * (i + 0.5) / steps;
    crowns += sensor.pulseEnergy * 0.3 / 30.0 * sensor.receiverAperture / (r * r) *
      std::exp(-0.3 * (r - 96.0)) * 8.0 / steps;
  }
  EXPECT_NEAR(result.echoes[0].returnEnergy / crowns, 1.0, 1e-4);
  EXPECT_GT(result.echoes[0].range, 96.0);
  EXPECT_LT(result.echoes[0].range, 104.0);
  EXPECT_EQ(result.echoes[1].objectId, 7);
  const double wall =
    receivedFrom(runScan(inMedium(wallAt(200.0), sensor, { 0.0, 1.0, 0.0 }, crown), oneBeam()));
  EXPECT_NEAR(result.echoes[1].returnEnergy / wall, std::exp(-0.3 * 8.0), 2e-3);
}

TEST(BeamAir, FarAndDenseMediaReturnLight)
{
  // Brightest where they begin: mu/S A/r^2 over a unit, by midpoints.
  const Sensor sensor = search905();
  for (const double from : { 240.0, 710.0, 1500.0 })
  {
    for (const double extinction : { 0.5, 1.5, 20.0 })
    {
      Medium leaves{ extinction, 10.5, 0.0, 6.0, 1.0, false, 9, true };
      FollowedAir air(sensor,
        { 0.0, { { leaves, boxOf(Vec3(from + 50.0, 0.0, 0.0), Vec3(50.0, 400.0, 400.0)) } } });
      air.begin(makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth));
      const auto unit = static_cast<std::int64_t>((from + 1.0) / sensor.rangeUnitLength());
      const double begin = sensor.rangeUnitLength() * static_cast<double>(unit);
      const double truth = statistics::byMidpoints(begin, begin + sensor.rangeUnitLength(), 20000,
        [&](double r)
        {
          return r < from ? 0.0
                          : sensor.pulseEnergy * extinction / 10.5 * sensor.receiverAperture /
              (r * r) * std::exp(-extinction * (r - from));
        });
      ASSERT_EQ(air.sharesOf(unit).size(), 1u);
      EXPECT_NEAR(air.sharesOf(unit)[0].mean / truth, 1.0, extinction > 10.0 ? 0.3 : 5e-3);
    }
  }
}

TEST(BeamAir, LayersSeenFromHighAbove)
{
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.top = -2.0;
  MediumCrosser crosser;
  for (const double softness : { 0.01, 0.04, 0.5, 5.0 })
  {
    layer.softness = softness;
    for (const double height : { 0.0, 40.0, 500.0 })
    {
      for (const Vec3& direction : { Vec3(0.0, 0.0, -1.0), unitVector(Vec3(1.0, 0.0, -0.02)) })
      {
        std::vector<MediumCrossing> parts;
        crosser.find(layer, Vec3(0.0, 0.0, height), direction, 1e5, 0.0, parts);
        double depth = 0.0;
        const double to = (height + 2.0 + 10.0) / -direction.z; // 10 m below the top
        for (const MediumCrossing& part : parts)
        {
          depth += part.upTo(to);
        }
        const double truth =
          (10.0 + softness * (1.0 - std::exp(-(height + 2.0) / softness))) / -direction.z;
        EXPECT_NEAR(depth / truth, 1.0, 1e-9) << softness << " " << height;
      }
    }
  }
}

TEST(BeamAir, BordersAnywhereInABeam)
{
  // What an opaque half leaves of a beam, against the segment of a disc. The half is a box beside a
  // beam that is turned about its axis, or a layer before a beam of any azimuth, of which the
  // vertical has any angle in the beam.
  const Sensor sensor = openSensor(5.6e-3);
  constexpr double range = 100.0;
  const double radius = range * std::tan(5.6e-3);
  constexpr int angles = 360;
  constexpr int offsets = 399;
  const MediumVolume box = boxOf(Vec3(range, 40.0, 0.0), Vec3(1e-3, 40.0, 40.0));
  MediumVolume below;
  below.shape = MediumShape::Layer;
  MediumVolume above = below;
  above.bottom = 0.0;
  above.top = 1e3;
  for (const bool isLayer : { false, true })
  {
    const Medium opaque{ 1e9, 18.8, 0.0 };
    FollowedAir low(sensor, { 0.0, { { opaque, isLayer ? below : box } } });
    FollowedAir high(sensor, { 0.0, { { opaque, isLayer ? above : box } } });
    double worst = 0.0;
    double squares = 0.0;
    for (int k = 0; k < angles * offsets; ++k)
    {
      const double angle = 2.0 * Pi * (k % angles) / angles;
      const double offset = 2.0 * (k / angles + 1) / (offsets + 1) - 1.0;
      const Vec3 axis = isLayer ? Vec3(std::cos(angle), std::sin(angle), 0.0) : Vec3(1.0, 0.0, 0.0);
      const Vec3 origin = -offset * radius * (isLayer ? Vec3(0.0, 0.0, 1.0) : Vec3(0.0, 1.0, 0.0));
      BeamFrame frame = makeBeamFrame(origin, axis, 5.6e-3);
      for (Vec3* v : { &frame.e1, &frame.e2 })
      {
        const double cosine = isLayer ? 1.0 : std::cos(angle);
        const double sine = isLayer ? 0.0 : std::sin(angle);
        *v = Vec3(v->x, cosine * v->y + sine * v->z, cosine * v->z - sine * v->y);
      }
      const double left = isLayer && offset < 0.0 ? -offset : offset; // the layer is below the beam
      const double truth = 1.0 - statistics::shareBeyond(left);
      FollowedAir& air = offset < 0.0 ? low : high;
      air.begin(frame);
      const double error = air.transmission(range + 0.1) - truth;
      worst = std::max(worst, std::fabs(error));
      squares += error * error / (angles * offsets);
    }
    // As BeamAir.h states.
    EXPECT_NEAR(worst, isLayer ? 0.093 : 0.095, 1e-3);
    EXPECT_NEAR(std::sqrt(squares), isLayer ? 0.037 : 0.017, 1e-3);
  }
}

TEST(BeamAir, LayersAndMovingBanksWeakenWhatIsInThem)
{
  // The border lies on the axis; a wall below it and one above.
  Sensor sensor = openSensor(5.6e-3);
  const Medium fog{ 0.02, 18.8, 0.0 };
  const double weak = std::exp(-2.0 * 0.02 * 200.0);
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  MediumVolume moving = boxOf(Vec3(0.0, 0.0, -500.0), Vec3(1000.0, 1000.0, 500.0));
  moving.velocity = Vec3(1e-9, 0.0, 0.0);
  for (const bool isAbove : { false, true })
  {
    Scene scene;
    scene.plate(Vec3(200.0, 0.0, isAbove ? 25.0 : -25.0), Vec3(0.0, 50.0, 0.0),
      Vec3(0.0, 0.0, 25.0), Wall, 7);
    const double clear = onlyEcho(scene, sensor, directSettings(400)).energyReceived;
    for (const MediumVolume& volume : { layer, moving })
    {
      const double seen = receivedFrom(runScan(inMedium(scene, sensor, fog, volume), oneBeam()));
      EXPECT_NEAR(seen / clear, isAbove ? 1.0 : weak, isAbove ? 0.02 : 0.1 * weak);
    }
  }
}

TEST(BeamAir, WhatIsKeptOfBeamsDoesNotDependOnTheAirBefore)
{
  Sensor sensor = search905();
  ScanSetup setup = makeSetup(town(), sensor, usual());
  setup.settings.attenuationCoefficient = 4e-3;
  ScanSeries series(setup, horizon(90, 4));
  series.setup.settings.attenuationCoefficient = 0.0;
  series.setup.media = { { { 4e-3, 18.8, 0.0 }, {} } };
  series.check("fog");
}

TEST(BeamAir, AnyThreadsAndPartsGiveTheSameBits)
{
  Sensor sensor = search905();
  EchoSettings settings = usual();
  ScanSetup setup = makeSetup(town(), sensor, settings);
  Medium leaves{ 0.5, 30.0, 100.0, SquareOfLeaves, 0.3, false, 9, true };
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.top = 3.0;
  layer.softness = 4.0;
  MediumVolume crown = boxOf(Vec3(40.0, 30.0, 4.0), Vec3(6.0, 5.0, 4.0));
  crown.shape = MediumShape::Ellipsoid;
  setup.media = { { { 0.01, 18.8, 0.0 }, layer }, { leaves, crown },
    { rainOf(20.0, 20.0, {}), boxOf(Vec3(-100.0, 0.0, 0.0), Vec3(60.0, 80.0, 100.0)) } };
  planModel(setup);
  const ScanBeams beams = horizon(180, 4);
  const ScanResult one = runScan(setup, beams, 1);
  ASSERT_GT(one.echoes.size(), 100u);
  expectSame(one, runScan(setup, beams, 3));
  int leavesSeen = 0, rain = 0;
  for (const Echo& echo : one.echoes)
  {
    leavesSeen += echo.objectId == 9;
    rain += echo.objectId == ObjectOfAir;
  }
  EXPECT_GT(leavesSeen, 0);
  EXPECT_GT(rain, 100);
  // Lit again in other weather, and back: nothing is traced.
  ScanSeries series(setup, beams);
  for (const double extinction : { 0.05, setup.media[0].medium.extinction })
  {
    series.setup.media[0].medium.extinction = extinction;
    series.check("weather");
    EXPECT_EQ(series.result.beamsTraced, 0u);
  }
}
