// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanClock.h
 * @brief Times of a rotating lidar: revolutions, steps of a revolution, and the beams of a step.
 *
 * Revolution k lasts from k / RotationRate to (k + 1) / RotationRate seconds and is shown in n
 * steps. Step j shows the beams fired before the share (j + 1) / n of the revolution is over. So
 * every step has beams, and the last step has all beams.
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
/// Largest number of steps in an animation.
constexpr std::int64_t MaximumSteps = 1000000;

struct ScanClock
{
  double rotationRate = 0.5; ///< revolutions per second, Hz
  int revolutions = 1;       ///< number of revolutions to be played
  int steps = 1;             ///< n, number of steps of a revolution
};

/// A step of a revolution.
struct ScanMoment
{
  int revolution = 0; ///< number k of the revolution
  int step = 0;       ///< number j of the step
};

/// The beams of a piece of the scan, up to a step. Columns are distributed among the pieces in
/// turn.
struct ScanPart
{
  int piece = 0;
  int pieces = 1;
  int step = 0;
  int steps = 1;
};

/// The first bad value in words, or an empty string. @param pattern valid pattern with the clock's
/// rotation rate
std::string checkClock(const ScanClock& clock, const ScanPattern& pattern);

/// Time of a moment, (k + j/n) / RotationRate, s.
double timeOf(const ScanClock& clock, const ScanMoment& moment);

/// Times of all steps of all revolutions to be played, s, strictly ascending. If the clock is not
/// valid, the result is the single time 0.
std::vector<double> timesOf(const ScanClock& clock);

/**
 * Find the step of a time. A time slightly before a step belongs to this step if the difference is
 * less than 1e-9 of a step or within the rounding of (k + j/n) / RotationRate to double. @return
 * empty, or what is wrong with the time: the time is not finite, or its revolution does not fit
 * into an int
 */
std::string momentAt(const ScanClock& clock, double time, ScanMoment& moment);

/// Numbers of the beams of a part, ascending. @param pattern valid pattern (checkPattern())
std::vector<std::int64_t> beamsOf(const ScanPattern& pattern, const ScanPart& part);
}

#endif
