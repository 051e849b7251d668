// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanClock.h
 * @brief When a rotating lidar has fired which beams: revolutions, steps within them, and the
 * beams of a step.
 *
 * Revolution k lasts from k / RotationRate to (k + 1) / RotationRate seconds and is shown in n
 * steps. Step j shows the beams fired before the share (j + 1) / n of the revolution is over. So
 * no step is empty, and the last one has all beams.
 *
 * Source: none.
 * Valid: RotationRate from 1e-20 to 1e20 Hz, up to MaximumSteps steps.
 * Test: TestScanClock.cxx.
 */
#ifndef avianlidar_ScanClock_h
#define avianlidar_ScanClock_h

#include "ScanPattern.h"

#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Steps that an animation can have.
constexpr std::int64_t MaximumSteps = 1000000;

struct ScanClock
{
  double rotationRate = 0.5; ///< Hz
  int revolutions = 1;       ///< revolutions that are played
  int steps = 1;             ///< n, steps of a revolution
};

/// A step of a revolution.
struct ScanMoment
{
  int revolution = 0; ///< k
  int step = 0;       ///< j
};

/// The beams of a piece of the scan, up to a step. Columns are given to the pieces in turn.
struct ScanPart
{
  int piece = 0;
  int pieces = 1;
  int step = 0;
  int steps = 1;
};

/// The first bad value in words, or an empty string. @param pattern a good one, with the clock's
/// rate
std::string checkClock(const ScanClock& clock, const ScanPattern& pattern);

/// (k + j/n) / RotationRate, s.
double timeOf(const ScanClock& clock, const ScanMoment& moment);

/// All steps of all revolutions to be played, s, strictly ascending. Just 0 where the clock is not
/// good.
std::vector<double> timesOf(const ScanClock& clock);

/**
 * The step in which a time falls. A time that is less than 1e-9 of a step before one, or within
 * the rounding of (k + j/n) / RotationRate to double, is that step's. @return empty, or what is
 * wrong with the time: it is not finite, or its revolution is not an int
 */
std::string momentAt(const ScanClock& clock, double time, ScanMoment& moment);

/// The beams of a part, ascending. @param pattern a good one (checkPattern())
std::vector<std::int64_t> beamsOf(const ScanPattern& pattern, const ScanPart& part);
}

#endif
