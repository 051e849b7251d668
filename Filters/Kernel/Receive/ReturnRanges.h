// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ReturnRanges.h
 * @brief Ranges of returns.
 *
 * The range of a return is the mean range (half the path length) of its paths, weighted with the
 * energies that these paths put into the return's units. A run of false alarms has no paths. In
 * each unit of such a run the noise has a random place (placeOfNoise()). The range of the return is
 * then the mean of these places, weighted with the energies of the units. The reported range has an
 * error (RangeErrors.h).
 *
 * Source: paper, Sec. 2.4.
 * Differs: in ReturnMode::RangeUnits a return is one unit and its range is the unit's centre, as in
 * the paper, without error.
 * Valid: on a plane at any tilt the range of a return differs from the range on the axis by at most
 * theta0.5^2/4, relative.
 * Test: TestReceiver.cxx.
 */
#ifndef avianlidar_ReturnRanges_h
#define avianlidar_ReturnRanges_h

#include "EchoSettings.h"
#include "RangeShares.h"
#include "Received.h"
#include "Sensor.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
class ReturnRanges
{
public:
  ReturnRanges(const Sensor& sensor, ReturnMode mode);

  /// Range, m, of a place in the part of a unit that lies inside the gate. @param place 0 to 1
  double placeIn(std::int64_t unit, double place) const;

  /// Range of a return without light, m, from its units alone.
  double ofNoise(const Received& received, const Return& run) const;

  /// Range of a return, m. @param shares shares of the beam's paths in the return's units @param
  /// lengths lengths of these paths, m
  double of(const Received& received, const Return& run, const RangeShares& shares,
    const std::vector<double>& lengths) const;

  /// The range that the receiver reports for a return at `range`, m.
  double reported(const Return& run, double range) const;

private:
  const Sensor Instrument;
  const double UnitLength;
  const bool AtCentres; ///< whether the range of a return is the centre of its unit
};
}

#endif
