// SPDX-License-Identifier: BSD-3-Clause
#include "ScanClock.h"

#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace avianlidar
{
namespace
{
constexpr double StepTolerance = 1e-9;        // share of a step
constexpr double RoundingTolerance = 8.9e-16; // share of a step's number: 4 units of round-off
constexpr double MostTolerance = 0.25;        // share of a step

bool isGood(const ScanClock& clock)
{
  return clock.rotationRate >= MinimumRotationRate && clock.rotationRate <= MaximumRotationRate &&
    clock.revolutions >= 1 && clock.steps >= 1 &&
    static_cast<std::int64_t>(clock.revolutions) * clock.steps <= MaximumSteps;
}
}

std::string checkClock(const ScanClock& clock, const ScanPattern& pattern)
{
  const auto columns = numberOfColumns(pattern);
  return firstError({
    rangeError("NumberOfRevolutions", clock.revolutions, 1.0, LargestFinite, "at least 1"),
    rangeError("StepsPerRevolution", clock.steps, 1.0, LargestFinite, "at least 1"),
    rangeError("StepsPerRevolution", clock.steps, 1.0, static_cast<double>(columns),
      "at most the " + std::to_string(columns) + " columns of a revolution"),
    rangeError("NumberOfRevolutions times StepsPerRevolution",
      static_cast<double>(clock.revolutions) * clock.steps, 1.0, MaximumSteps,
      "at most 1e6 steps to play"),
  });
}

double timeOf(const ScanClock& clock, const ScanMoment& moment)
{
  return (moment.revolution + static_cast<double>(moment.step) / clock.steps) / clock.rotationRate;
}

std::vector<double> timesOf(const ScanClock& clock)
{
  if (!isGood(clock))
  {
    return { 0.0 };
  }
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(clock.revolutions) * clock.steps);
  for (int revolution = 0; revolution < clock.revolutions; ++revolution)
  {
    for (int step = 0; step < clock.steps; ++step)
    {
      times.push_back(timeOf(clock, { revolution, step }));
    }
  }
  return times;
}

std::string momentAt(const ScanClock& clock, double time, ScanMoment& moment)
{
  const double place = time * clock.rotationRate * clock.steps;
  const double nearest = std::round(place);
  const double tolerance =
    std::clamp(RoundingTolerance * std::fabs(place), StepTolerance, MostTolerance);
  const double step = std::fabs(place - nearest) <= tolerance ? nearest : std::floor(place);
  const double revolution = std::floor(step / clock.steps);
  if (!(revolution >= std::numeric_limits<int>::min() &&
        revolution <= std::numeric_limits<int>::max()))
  {
    std::ostringstream text;
    text << "the time asked for is " << time << " s, which is revolution "
         << time * clock.rotationRate << " at a RotationRate of " << clock.rotationRate
         << " Hz, expected a revolution from -2^31 to 2^31 - 1";
    return text.str();
  }
  moment.revolution = static_cast<int>(revolution);
  moment.step = static_cast<int>(step - revolution * clock.steps);
  return std::string();
}

std::vector<std::int64_t> beamsOf(const ScanPattern& pattern, const ScanPart& part)
{
  const std::int64_t columns = numberOfColumns(pattern);
  const int channels = numberOfChannels(pattern);
  const std::int64_t shown = part.step + std::int64_t{ 1 };
  const double share = static_cast<double>(shown) / part.steps; // share of the scan
  const bool isRotor = !pattern.table && pattern.prisms.none();
  const auto hasFired = [&](std::int64_t column, int channel)
  {
    if (shown == part.steps)
    {
      return true;
    }
    if (!isRotor)
    {
      return beamTime(pattern, column, channel) * pattern.rotationRate < share;
    }
    // Column c begins when c/columns of the revolution is over. Whole numbers are compared, so that
    // no column is early.
    return column * part.steps < shown * columns &&
      ((column + 1) * part.steps <= shown * columns ||
        firingTime(pattern, channel) * pattern.rotationRate <
          share - static_cast<double>(column) / static_cast<double>(columns));
  };
  std::vector<std::int64_t> beams;
  beams.reserve(static_cast<std::size_t>(channels * (columns / part.pieces + 1)));
  for (std::int64_t column = part.piece; column < columns; column += part.pieces)
  {
    for (int channel = isBlanked(pattern, column) ? channels : 0; channel < channels; ++channel)
    {
      if (hasFired(column, channel))
      {
        beams.push_back(column * channels + channel);
      }
    }
  }
  return beams;
}
}
