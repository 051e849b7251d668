// SPDX-License-Identifier: BSD-3-Clause
// A scan that is brought up to date change by change, each time compared with a fresh one.
#ifndef ScanSeries_h
#define ScanSeries_h

#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace echotest
{
/// A scan that goes on from one change to the next, beside fresh ones.
struct ScanSeries
{
  ScanSetup setup;
  ScanBeams beams;
  TraceCache cache;
  ScanResult result;
  std::vector<BeamReport> before; ///< reports of the run before
  std::size_t kept = 0;           ///< beams that met something and were not lit again

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

#endif
