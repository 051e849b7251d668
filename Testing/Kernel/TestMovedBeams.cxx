// SPDX-License-Identifier: BSD-3-Clause
// Beams meet movers where these are at the beam's own time.
#include "Bird.h"
#include "CellTestScene.h"
#include "MoverReport.h"
#include "PhotonReceiver.h"
#include "ScanTestTown.h"
#include "Silhouette.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace echotest;

namespace
{
/// A part of a scene as a mover, at rest unless poses are given.
Mover moverOf(const Scene& scene, std::vector<Pose> poses = {})
{
  Mover mover;
  mover.mesh = *scene.mesh;
  mover.parts.assign(scene.mesh->points.size(), 0);
  mover.materials = scene.materials;
  mover.objectIds = scene.objects;
  mover.materialIds.assign(scene.objects.size(), 0);
  mover.always = poses.empty();
  mover.poses = poses.empty() ? std::vector<Pose>(1) : std::move(poses);
  EXPECT_EQ(prepareMover(mover), "");
  return mover;
}

void setMovers(ScanSetup& setup, std::vector<Mover> movers)
{
  orderMovers(movers);
  setup.movers = std::make_shared<const std::vector<Mover>>(std::move(movers));
  finishSetup(setup);
}

ScanBeams timed(ScanBeams beams, double step)
{
  for (std::size_t b = 0; b < beams.size(); ++b)
  {
    beams.times.push_back(step * static_cast<double>(b));
  }
  return beams;
}

Scene joined(const Scene& one, const Scene& two)
{
  Scene all;
  *all.mesh = *one.mesh;
  all.materials = one.materials;
  all.objects = one.objects;
  const auto first = static_cast<std::uint32_t>(all.mesh->points.size());
  all.mesh->points.insert(all.mesh->points.end(), two.mesh->points.begin(), two.mesh->points.end());
  for (const auto& t : two.mesh->triangles)
  {
    all.mesh->triangles.push_back({ first + t[0], first + t[1], first + t[2] });
  }
  all.materials.insert(all.materials.end(), two.materials.begin(), two.materials.end());
  all.objects.insert(all.objects.end(), two.objects.begin(), two.objects.end());
  return all;
}

/// Add a triangle, cut into four so many times.
void addInPieces(Scene& scene, const Vec3& a, const Vec3& b, const Vec3& c,
  const Material& material, int object, int cuts)
{
  if (cuts == 0)
  {
    scene.triangle(a, b, c, material, object);
    return;
  }
  const Vec3 ab = 0.5 * (a + b);
  const Vec3 bc = 0.5 * (b + c);
  const Vec3 ca = 0.5 * (c + a);
  addInPieces(scene, a, ab, ca, material, object, cuts - 1);
  addInPieces(scene, ab, b, bc, material, object, cuts - 1);
  addInPieces(scene, ca, bc, c, material, object, cuts - 1);
  addInPieces(scene, ab, bc, ca, material, object, cuts - 1);
}

Scene goose(const Vec3& at, int object, int cuts = 0)
{
  const BirdShape shape({ "goose", 4.2, 1.0, 1.69, 0.37, false, 16.5 });
  Scene scene;
  for (const BirdPart part : { BirdPart::Body, BirdPart::LeftWing, BirdPart::RightWing })
  {
    const TriangleMesh mesh = birdPart(shape, part, 0.3);
    for (std::uint32_t t = 0; t < mesh.size(); ++t)
    {
      addInPieces(scene, at + mesh.corner(t, 0), at + mesh.corner(t, 1), at + mesh.corner(t, 2),
        Material{ 0.3, 0.0, 1.0 }, object, cuts);
    }
  }
  return scene;
}

/// Objects as movers would have them: far and near, plates before walls, mirrors, small and large.
Scene things()
{
  Scene scene = goose(Vec3(3.0, 60.0, 1.0), 100);
  scene = joined(scene, goose(Vec3(-200.0, 40.0, 2.0), 101));
  scene.box(Vec3(25.0, -12.0, 0.0), Vec3(2.0, 3.0, 1.5), Metal, 102);
  scene.plate(Vec3(-40.0, -40.0, 4.0), Vec3(3.0, -3.0, 0.0), Vec3(0.0, 0.0, 3.0), Glass, 103);
  scene.box(Vec3(100.0, 100.0, 1.0), Vec3(0.2), Wood, 104);
  return scene;
}

void expectRestIsSurface(
  const Scene& scene, const Scene& moving, const EchoSettings& settings, const TreeOptions& options)
{
  Sensor sensor;
  sensor.halfBeamwidth = 2e-2;
  const ScanBeams beams = timed(horizon(180, 4), 1e-3);
  const ScanResult wanted = runScan(makeSetup(joined(scene, moving), sensor, settings), beams);
  ScanSetup setup = makeSetup(scene, sensor, settings, options);
  setMovers(setup, { moverOf(moving) });
  for (const int threads : { 1, 2 })
  {
    const ScanResult got = runScan(setup, beams, threads);
    echotest::expectSame(got, wanted);
    for (std::size_t i = 0; i < beams.size(); ++i)
    {
      ASSERT_EQ(got.reports[i].status, wanted.reports[i].status) << "beam " << i;
      ASSERT_TRUE(sameBits(got.reports[i].range, wanted.reports[i].range)) << "beam " << i;
    }
    EXPECT_GT(got.beamsTouched, 20u);
  }
}
}

TEST(MovedBeams, AtRestAMoverIsASurface)
{
  EchoSettings settings = usual();
  expectRestIsSurface(town(), things(), settings, {});
  settings.raysPerBeam = 100;
  expectRestIsSurface(town(), things(), settings, {});
  settings.beamSamples = BeamSampleSource::Rays;
  expectRestIsSurface(town(), things(), settings, {});
  settings.sampling = Sampling::MonteCarlo;
  settings.beamConstraint = false;
  settings.traceMode = TraceMode::Beams;
  expectRestIsSurface(
    town(), things(), settings, { SplitRule::Median, BoundingVolumeType::OBB, 1 });
  settings = usual();
  settings.fullModel = true;
  expectRestIsSurface(town(), things(), settings, {});
  settings = usual();
  settings.lightEnergyConstraint = false;
  settings.beamSamples = BeamSampleSource::Rays;
  expectRestIsSurface(town(), things(), settings, {});
}

TEST(MovedBeams, WithoutAnyStaticSurface)
{
  expectRestIsSurface(Scene(), things(), usual(), {});
}

TEST(MovedBeams, TrianglesThatAreNotNeighboursInTheSceneAreNotJoined)
{
  // Two halves of a square whose numbers are not consecutive, as a third stands behind the lidar.
  Scene scene;
  scene.triangle(Vec3(50, -5, -5), Vec3(50, 5, -5), Vec3(50, 5, 5), Wall, 0);
  scene.triangle(Vec3(-50, -5, -5), Vec3(-50, 5, -5), Vec3(-50, 5, 5), Wall, 0);
  scene.triangle(Vec3(50, -5, -5), Vec3(50, 5, 5), Vec3(50, -5, 5), Wall, 0);
  Scene plate;
  plate.square(Vec3(30, 0, 0.2), 0.1, Glass, 1);
  ScanBeams beams = timed(oneBeam(Vec3(1, 0.004, 0.006)), 0.0);
  const ScanResult wanted = runScan(makeSetup(joined(scene, plate), {}, {}), beams);
  ScanSetup setup = makeSetup(scene, {}, {});
  setMovers(setup, { moverOf(plate) });
  const ScanResult got = runScan(setup, beams);
  EXPECT_EQ(got.beamsTouched, 1u);
  expectSame(got, wanted);
}

TEST(MovedBeams, APlateThatCrossesIsSeenByTheBeamsOfThoseTimes)
{
  // One direction, a beam each millisecond; a plate of 2 m crosses it at 100 m and 20 m/s.
  ScanBeams beams = timed(alike(1000), 1e-3);
  for (double& time : beams.times)
  {
    time += 5.0;
  }
  Scene plate;
  plate.plate(Vec3(0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0), Wall, 1);
  Scene wall = squareAt(200.0, 9.0, Wall, 0);
  Sensor sensor;
  sensor.halfBeamwidth = 1e-3;
  ScanSetup setup = makeSetup(wall, sensor, {});
  setMovers(setup,
    { moverOf(plate, { { 5.0, Vec3(100.0, -8.0, 0.0) }, { 5.75, Vec3(100.0, 7.0, 0.0) } }) });
  const ScanResult result = runScan(setup, beams);
  // Between -1 m and 1 m from the axis, less or more by the beam's radius of 0.1 m.
  for (std::size_t i = 0; i < result.echoes.size(); ++i)
  {
    const double y = -8.0 + 20.0 * 1e-3 * static_cast<double>(result.beamOfEcho[i]);
    const bool near = result.echoes[i].range < 150.0;
    EXPECT_EQ(result.echoes[i].objectId, near ? 1 : 0);
    if (near)
    {
      EXPECT_LT(std::fabs(y), 1.1);
    }
    else
    {
      EXPECT_GT(std::fabs(y), 0.9); // in its shadow the wall is not seen
    }
  }
  std::size_t whole = 0;
  for (std::size_t i = 0; i < result.echoes.size(); ++i)
  {
    whole += result.echoes[i].range < 150.0;
  }
  EXPECT_NEAR(static_cast<double>(whole), 2.0 / 20.0 * 1000.0, 10.0);
  // After 5.75 s it is gone.
  EXPECT_LE(result.beamsTouched, 300u);
}

TEST(MovedBeams, AUnitAtTheLimitIsNoEchoAndNotProbable)
{
  Scene plate = squareAt(100.0, 0.2, Wall, 1);
  Sensor sensor;
  sensor.pulseWidth = 0.0; // all in one range unit
  sensor.lowerEnergyLimit = 1e-9;
  ScanSetup setup = makeSetup(Scene(), sensor, {});
  setMovers(setup, { moverOf(plate) });
  const ScanBeams beams = timed(oneBeam(), 0.0);
  const double energy = runScan(setup, beams).echoes.at(0).energyReceived;
  const struct
  {
    double limit;
    int echoes; ///< and probability
  } cases[] = { { energy, 0 }, { std::nextafter(energy, 0.0), 1 }, { 2.0 * energy, 0 } };
  for (const auto& c : cases)
  {
    setup.sensor.lowerEnergyLimit = c.limit;
    finishSetup(setup);
    const ScanResult result = runScan(setup, beams);
    EXPECT_EQ(result.echoes.size(), static_cast<std::size_t>(c.echoes));
    const MoverReport report = reportMovers(setup, beams, result.sights, 1).at(0);
    EXPECT_EQ(report.energy, energy);
    EXPECT_EQ(report.probability, c.echoes);
  }
}

TEST(MovedBeams, ASunlitWallBehindAMoverMakesItLessProbable)
{
  // A plate in front of the sky, or of a white wall in the sun: the same light, more noise.
  Scene plate = squareAt(100.0, 0.1, Wall, 1);
  Scene wall = squareAt(200.0, 50.0, { 0.9, 0.0, 1.0 }, 2);
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.receiverAperture = 0.00785;
  sensor.pulseWidth = 0.0;
  sensor.sunlight = 0.7;
  sensor.sunAzimuth = 270.0; // behind the lidar
  ASSERT_EQ(setPhotonLimits(sensor, 1.0, 40.0, 2000.0), "");
  EchoSettings settings;
  settings.numberOfReflections = 1;
  ScanBeams beams = timed(oneBeam(), 0.0);
  const auto probabilityBefore = [&](const Scene& scene)
  {
    ScanSetup setup = makeSetup(scene, sensor, settings);
    setMovers(setup, { moverOf(plate) });
    const ScanResult result = runScan(setup, beams);
    return reportMovers(setup, beams, result.sights, 1).at(0).probability;
  };
  // As bright as half of what is seen before the sky needs.
  for (sensor.pulseEnergy = 1e-9; probabilityBefore(Scene()) < 0.5;)
  {
    sensor.pulseEnergy *= 1.1;
  }
  EXPECT_LT(probabilityBefore(Scene()), 0.9);
  EXPECT_LT(probabilityBefore(wall), 0.1);
}

TEST(MovedBeams, TwoPartsThatFlapCloseAndOpenALid)
{
  // A plate 1 m up, hinged in the beam's axis, turns into the beam at a quarter of its period.
  Scene plate;
  plate.plate(Vec3(50.0, 0.0, 1.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 0.9), Wall, 1);
  Mover mover = moverOf(plate);
  mover.parts.assign(mover.parts.size(), 1);
  mover.flaps = { { Vec3(50.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0), Pi / 2.0, 1.0, 0.0 } };
  ASSERT_EQ(prepareMover(mover), "");
  Sensor sensor;
  sensor.halfBeamwidth = 1e-3;
  ScanSetup setup = makeSetup(Scene(), sensor, {});
  setMovers(setup, { mover });
  ScanBeams beams = oneBeam(Vec3(50.0, -0.9, 0.0)); // where the plate lies, turned by 90 degrees
  for (const double time : { 0.0, 0.25, 0.5, 0.75, 1.25 })
  {
    beams.times = { time };
    const bool wanted = time == 0.25 || time == 1.25;
    EXPECT_EQ(runScan(setup, beams).echoes.size(), wanted ? 1u : 0u) << time;
  }
}

TEST(MovedBeams, OrderAndPiecesChangeNoBit)
{
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Mover> movers;
  for (int k = 0; k < 40; ++k)
  {
    const Vec3 from(60.0 * uniform(random), 60.0 * uniform(random), 3.0 + 2.0 * uniform(random));
    const Vec3 to = from + 20.0 * Vec3(uniform(random), uniform(random), 0.0);
    movers.push_back(moverOf(goose(Vec3(0.0), 100 + k), { { 0.0, from }, { 0.72, to } }));
  }
  Sensor sensor;
  sensor.halfBeamwidth = 0.1; // several birds in one beam
  EchoSettings settings = usual();
  settings.beamSamples = BeamSampleSource::Rays;
  settings.raysPerBeam = 400;
  ScanSetup setup = makeSetup(town(), sensor, settings);
  setMovers(setup, movers);
  const ScanBeams beams = timed(horizon(180, 4), 1e-3);
  const ScanResult wanted = runScan(setup, beams);
  EXPECT_GT(wanted.beamsTouched, 150u);
  std::shuffle(movers.begin(), movers.end(), random);
  setMovers(setup, movers);
  expectSame(runScan(setup, beams, 2), wanted);

  ScanResult pieces;
  for (std::size_t first = 0; first < beams.size(); first += 37)
  {
    const ScanResult part =
      runScan(setup, chosen(beams, first, std::min(first + 37, beams.size())));
    pieces.echoes.insert(pieces.echoes.end(), part.echoes.begin(), part.echoes.end());
    for (const std::size_t b : part.beamOfEcho)
    {
      pieces.beamOfEcho.push_back(first + b);
    }
  }
  expectSame(pieces, wanted);
}

namespace
{
/// A wall of many triangles across the beam, 50 m behind a goose.
Scene wallBehind()
{
  Scene wall;
  celltest::fine(
    wall, Vec3(300.0, 0.0, 0.0), Vec3(0.0, 2.0, 0.0), Vec3(0.0, 0.0, 2.0), 40, Wall, 0);
  return wall;
}

/// Largest relative difference of what a goose of any heading is expected to return from the closed
/// form: the beam's share that it fills, its albedo, and its effective area.
double worstOfGeese(const Scene& behind, int cuts = 0, BeamProfile profile = BeamProfile::Uniform)
{
  Sensor sensor = openSensor(profile == BeamProfile::Gaussian ? 0.05 : 5.6e-3);
  sensor.beamProfile = profile;
  sensor.samplingInterval = 5e-8; // units of 7.5 m: the goose in the middle of one
  EchoSettings settings = usual();
  settings.attenuationCoefficient = 0.0;
  settings.raysPerBeam = 400;
  const double solidAngle = 2.0 * Pi * (1.0 - std::cos(sensor.halfBeamwidth));
  double worst = 0.0;
  for (int k = 0; k < 40; ++k)
  {
    const Vec3 at(33.5 * 7.494811, 0.0, 0.0);
    Mover bird = moverOf(goose(Vec3(0.0), 100, cuts));
    const double half = 0.5 * k * Pi / 40.0;
    bird.poses = { { 0.0, at, { std::cos(half), 0.0, 0.0, std::sin(half) } } };
    EXPECT_EQ(prepareMover(bird), "");
    TriangleMesh mesh;
    place(bird, bird.poses[0], mesh);
    const double area = effectiveArea(mesh, Vec3(1.0, 0.0, 0.0));
    // The bird is small beside the beam, in whose middle a Gaussian one is brighter.
    const double bright = profile == BeamProfile::Gaussian ? 2.0 / (1.0 - std::exp(-2.0)) : 1.0;
    const double wanted =
      bright * sensor.pulseEnergy * 0.3 * area / (glm::dot(at, at) * solidAngle);
    ScanSetup setup = makeSetup(behind, sensor, settings);
    setMovers(setup, { bird });
    const ScanResult result = runScan(setup, timed(oneBeam(), 0.0));
    EXPECT_EQ(result.sights.size(), 1u);
    worst = std::max(worst, std::fabs(result.sights.front().energy / wanted - 1.0));
  }
  return worst;
}
}

TEST(MovedBeams, WhatAMoverReturnsFollowsFromItsEffectiveArea)
{
  // Alone; before a wall or another bird (beams that many triangles enter are divided into cells);
  // in a wide Gaussian beam; of 288, 1,152 and 4,608 triangles, by lists of surfaces and by rays
  // through the tree.
  EXPECT_LT(worstOfGeese(Scene()), 0.02);
  EXPECT_LT(worstOfGeese(wallBehind()), 0.06);
  EXPECT_LT(worstOfGeese(goose(Vec3(300.0, 0.0, 0.0), 5)), 0.06);
  EXPECT_LT(worstOfGeese(Scene(), 0, BeamProfile::Gaussian), 0.06);
  EXPECT_LT(worstOfGeese(wallBehind(), 0, BeamProfile::Gaussian), 0.06);
  for (const int cuts : { 1, 2, 3 })
  {
    EXPECT_LT(worstOfGeese(Scene(), cuts), 0.06) << cuts; // of 40; 1.7 % rms
  }
}

TEST(MovedBeams, KeptBeamsDoNotChangeWhichObjectsCoincide)
{
  Scene walls = squareAt(100.0, 5.0, Wall, 1);
  walls.square(Vec3(100.0, 1.0, 0.0), 3.0, Wood, 2);
  const ScanBeams beams = timed(oneBeam(), 0.0);
  for (const BeamSampleSource source : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    EchoSettings settings = usual();
    settings.beamSamples = source;
    ScanSeries series({}, settings, walls, beams);
    const auto pairs = [&]()
    {
      series.check("lid");
      EXPECT_EQ(series.result.coincident, runScan(series.setup, beams).coincident);
      return series.result.coincident.size();
    };
    EXPECT_EQ(pairs(), 1u);
    for (const double half : { 5.0, 0.05 }) // hides the beam, or a part of it
    {
      Scene lid = squareAt(50.0, half, Wall, 3);
      setMovers(series.setup, { moverOf(lid) });
      EXPECT_EQ(pairs(), half < 1.0 ? 1u : 0u);
    }
  }
}

TEST(MovedBeams, ReportsNeedNoTimes)
{
  ScanSetup setup = makeSetup(Scene(), {}, usual());
  ScanBeams beams = oneBeam();
  EXPECT_TRUE(reportMovers(setup, beams, {}, 1).empty()); // nothing moves, and no beam has a time
  setMovers(setup, { moverOf(goose(Vec3(50.0, 0.0, 0.0), 100)) });
  const ScanResult untimed = runScan(setup, beams);
  const MoverReport without = reportMovers(setup, beams, untimed.sights, 1).at(0);
  beams = timed(beams, 0.0);
  const ScanResult result = runScan(setup, beams);
  EXPECT_GT(result.beamsTouched, 0u);
  expectSame(untimed, result);
  const MoverReport with = reportMovers(setup, beams, result.sights, 1).at(0);
  EXPECT_EQ(without.energy, with.energy);
  EXPECT_EQ(without.range, with.range);
}

TEST(MovedBeams, TheReportStopsWhenItIsNotWanted)
{
  std::vector<Mover> movers;
  for (int k = 0; k < 20; ++k)
  {
    movers.push_back(moverOf(goose(Vec3(50.0 + k, 0.0, 0.0), 100 + k)));
  }
  ScanSetup setup = makeSetup(Scene(), {}, usual());
  setMovers(setup, movers);
  const ScanBeams beams = timed(horizon(30, 1), 1e-3);
  int calls = 0;
  const auto wanted = [&] { return ++calls < 3; };
  EXPECT_THROW(reportMovers(setup, beams, {}, 1, wanted), WorkStopped);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(reportMovers(setup, beams, {}, 2).size(), 20u);
}

TEST(MovedBeams, NothingStaticIsTracedTwice)
{
  ScanSetup setup = makeSetup(town(), {}, usual());
  ScanBeams beams = timed(horizon(90, 4), 1e-3);
  TraceCache cache;
  ScanResult result;
  std::uint64_t traced = 0;
  std::uint64_t touched = 0;
  std::vector<Mover> movers;
  for (int k = 0; k < 10; ++k)
  {
    const Vec3 from(20.0 + 5.0 * k, -50.0, 2.0);
    movers.push_back(moverOf(
      goose(Vec3(0.0), 100 + k), { { 0.0, from }, { 400.0, from + Vec3(-60.0, 100.0, 0.0) } }));
  }
  setMovers(setup, movers);
  constexpr int scans = 40;
  for (int scan = 0; scan < scans; ++scan)
  {
    for (std::size_t b = 0; b < beams.size(); ++b)
    {
      beams.times[b] = 0.36 * scan + 1e-3 * static_cast<double>(b);
    }
    setup.revolution = scan;
    ASSERT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
    traced += result.beamsTraced;
    touched += result.beamsTouched;
    if (scan % 13 == 7)
    {
      const ScanResult fresh = runScan(setup, beams);
      expectSame(result, fresh);
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << scan;
    }
  }
  EXPECT_LE(traced, beams.size());
  EXPECT_GT(touched, static_cast<std::uint64_t>(scans));
  // Nor is a beam with echoes lit again. (A beam that now holds a bird may be of sky, or may have
  // held one in each scan so far.)
  std::vector<std::size_t> touchedNow;
  for (const MoverLight& sight : result.sights)
  {
    touchedNow.push_back(sight.beam);
  }
  std::size_t kept = 0;
  for (const std::size_t beam : result.beamOfEcho)
  {
    if (std::find(touchedNow.begin(), touchedNow.end(), beam) == touchedNow.end())
    {
      const KeptBeam& trace = cache.beams[beam];
      EXPECT_TRUE(trace.lit && !trace.lit->returns.empty()) << "beam " << beam;
      ++kept;
    }
  }
  EXPECT_GT(kept, beams.size() / 2);
}
