// SPDX-License-Identifier: BSD-3-Clause
// A town of boxes, a scan of its horizon, and the comparison of two scans bit for bit.
#ifndef ScanTestTown_h
#define ScanTestTown_h

#include "EchoTestScene.h"
#include "SameEchoes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <utility>

namespace echotest
{
/// Boxes of four materials on a ground plane, about the point `at`.
inline Scene town(const Vec3& at = Vec3(0.0), double snap = 0.0)
{
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Material materials[] = { Wall, Glass, Metal, Wood };
  // On the grid that far coordinates have, so that moving the scene rounds nothing.
  const auto grid = [snap](double v) { return snap > 0.0 ? snap * std::round(v / snap) : v; };
  Scene scene;
  scene.plate(at + Vec3(0.0, 0.0, -2.0), Vec3(500.0, 0.0, 0.0), Vec3(0.0, 500.0, 0.0), Wall, 0);
  for (int i = 1; i <= 60; ++i)
  {
    const double angle = 2.0 * Pi * uniform(random);
    const double range = 30.0 + 250.0 * uniform(random);
    const Vec3 half(grid(2.0 + 8.0 * uniform(random)), grid(2.0 + 8.0 * uniform(random)),
      grid(3.0 + 9.0 * uniform(random)));
    const Vec3 center(
      grid(range * std::cos(angle)), grid(range * std::sin(angle)), grid(half.z - 2.0));
    scene.box(at + center, half, materials[i % 4], i);
  }
  return scene;
}

/// Add a wall of so many parts that beams which meet it are divided into cells.
inline void addFineWall(Scene& scene)
{
  for (int i = 0; i < 1200; ++i)
  {
    scene.plate(Vec3(-12.0 + 0.2 * (i % 40), 30.0, 0.2 * (i / 40)), Vec3(0.1, 0.0, 0.0),
      Vec3(0.0, 0.0, 0.1), i % 2 ? Wall : Metal, 100 + i % 3);
  }
}

inline ScanBeams horizon(int columns, int channels, const Vec3& origin = Vec3(0.0))
{
  ScanBeams beams;
  for (int i = 0; i < columns * channels; ++i)
  {
    const double azimuth = 2.0 * Pi * (i / channels) / columns;
    const double elevation = Degree * (i % channels);
    addBeam(beams,
      Vec3(std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
        std::sin(elevation)),
      origin);
  }
  return beams;
}

inline bool sameBits(double a, double b)
{
  return std::memcmp(&a, &b, sizeof(double)) == 0;
}

inline void expectSame(const ScanResult& a, const ScanResult& b)
{
  ASSERT_EQ(a.echoes.size(), b.echoes.size());
  EXPECT_EQ(firstDifference(a, b), a.echoes.size());
}

inline EchoSettings usual()
{
  EchoSettings settings;
  settings.raysPerBeam = 40;
  settings.numberOfConnections = 8;
  return settings;
}

/// A scan that goes on from one change to the next, beside fresh ones.
struct ScanSeries
{
  ScanSetup setup;
  ScanBeams beams;
  TraceCache cache;
  ScanResult result;

  explicit ScanSeries(const Sensor& sensor = {}, const EchoSettings& settings = usual(),
    const Scene& scene = town(), ScanBeams scanned = horizon(60, 2))
    : ScanSeries(makeSetup(scene, sensor, settings), std::move(scanned))
  {
  }

  ScanSeries(ScanSetup first, ScanBeams scanned)
    : setup(std::move(first))
    , beams(std::move(scanned))
  {
    this->check("first");
  }

  bool scan(const KeepGoing& keepGoing = {})
  {
    finishSetup(this->setup);
    return simulateScan(
      this->setup, this->beams, 2, this->cache, std::size_t(1) << 30, keepGoing, this->result);
  }

  void check(const std::string& what)
  {
    ASSERT_TRUE(this->scan());
    const ScanResult fresh = runScan(this->setup, this->beams);
    expectSame(this->result, fresh);
    this->expectSameReports(fresh);
    for (const KeptBeam& trace : this->cache.beams)
    {
      ASSERT_EQ(trace.held, trace.heldBytes());
    }
    ASSERT_FALSE(testing::Test::HasFailure()) << what;
  }

  /// What was left out is bounded in any state, if not by the same number.
  void expectSameReports(const ScanResult& fresh) const
  {
    const double lower = this->setup.sensor.lowerEnergyLimit;
    const EchoSettings& s = this->setup.settings;
    const bool each =
      s.lightEnergyThreshold != LightEnergyThreshold::ShareOfLimit; // path by itself
    const double share = each ? Infinity : 1.001 * s.lightEnergyFraction;
    for (std::size_t i = 0; i < fresh.reports.size(); ++i)
    {
      const BeamReport& now = this->result.reports[i];
      ASSERT_EQ(now.status, fresh.reports[i].status) << "beam " << i;
      ASSERT_TRUE(sameBits(now.range, fresh.reports[i].range)) << "beam " << i;
      const bool isEcho = now.status == BeamStatus::Echo || now.status == BeamStatus::Saturated;
      ASSERT_LE(now.lost, (isEcho ? share : std::max(1.0, share)) * lower) << "beam " << i;
      ASSERT_TRUE(!isEcho || (now.skipped & SkippedBeam) == 0) << "beam " << i;
      ASSERT_TRUE(now.skipped != 0 || now.lost == 0.0) << "beam " << i;
    }
  }
};
}

#endif
