// SPDX-License-Identifier: BSD-3-Clause
// A scan that is lit again change by change, each time compared with a fresh one.
#ifndef ScanSeries_h
#define ScanSeries_h

#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace echotest
{
/// A scan that goes on from one change to the next, beside fresh ones.
struct ScanSeries
{
  ScanSetup setup;
  ScanBeams beams;
  TraceCache cache;
  ScanResult result;

  explicit ScanSeries(const Sensor& sensor = {}, const EchoSettings& settings = usual(),
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
    ASSERT_FALSE(testing::Test::HasFatalFailure()) << what;
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
        const bool noEcho =
          report.status != BeamStatus::Echo && report.status != BeamStatus::Saturated;
        ASSERT_LE(
          report.lost, (noEcho ? 1.0 : 1.001 * this->setup.settings.lightEnergyFraction) * lower)
          << "beam " << i;
        ASSERT_TRUE(noEcho || !whole) << "beam " << i;
        ASSERT_TRUE(report.skipped != 0 || report.lost == 0.0) << "beam " << i;
      }
    }
  }
};
}

#endif
