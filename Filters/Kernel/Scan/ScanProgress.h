// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanProgress.h
 * @brief How far a scan is, and whether it is still wanted.
 */
#ifndef avianlidar_ScanProgress_h
#define avianlidar_ScanProgress_h

#include "ParallelLoop.h"

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace avianlidar
{
/// Progress is told and the wish to stop heard between blocks and within beams, on the calling
/// thread only.
class ScanProgress
{
public:
  ScanProgress(std::size_t beams, const KeepGoing& keepGoing)
    : Beams(beams)
    , Continue(keepGoing)
  {
  }

  void beamDone() { ++this->Done; }

  /// On the calling thread. Never falls.
  bool report(double fraction)
  {
    this->Last = std::max(this->Last, fraction);
    if (this->Continue && !this->Stopped && !this->Continue(this->Last))
    {
      this->Stopped = true;
    }
    return !this->Stopped;
  }

  /// On any thread.
  bool goOn(int thread)
  {
    return thread == 0
      ? this->report(static_cast<double>(this->Done) / static_cast<double>(this->Beams))
      : !this->Stopped;
  }

private:
  std::size_t Beams;
  const KeepGoing& Continue;
  std::atomic<std::size_t> Done{ 0 };
  std::atomic<bool> Stopped{ false };
  double Last = 0.0;
};
}

#endif
