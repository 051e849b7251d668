// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ReceivedPulse.h
 * @brief The emitted pulse after the receiver's response: which share of an echo's energy arrives
 * by which time.
 *
 * A pulse is a rectangle, a Gaussian, or samples of a power with straight lines between them. The
 * response is a Gaussian of area 1. The mean time of the received pulse is the delay of its path,
 * so shape and response move no range. A Gaussian ends two full widths at half maximum from its
 * middle, where 2.5e-6 of its energy are cut off; the rest is scaled to 1.
 *
 * Source: paper, Sec. 2.4, has the rectangle. W. Wagner et al., "Gaussian decomposition and
 * calibration of a novel small-footprint full-waveform digitising airborne laser scanner", ISPRS J.
 * 60, 2006, has the system waveform: pulse convolved with response.
 * Differs: the paper's receiver responds at once.
 * Valid: a response below 1/1000 of the pulse's length counts as 0. shareBefore() of a Gaussian
 * differs from the error function by the share that is cut off.
 * Test: TestReceivedPulse.cxx.
 */
#ifndef avianlidar_ReceivedPulse_h
#define avianlidar_ReceivedPulse_h

#include <cstddef>
#include <string>
#include <vector>

namespace avianlidar
{
struct Sensor;

/// Shape of the emitted pulse.
enum class PulseShape
{
  Rectangle = 0, ///< constant power for the pulse width (paper)
  Gaussian = 1,  ///< Gaussian whose full width at half maximum is the pulse width
  Samples = 2    ///< Sensor::pulseSamples
};

/// Places are in intervals (range units, or samples of a digitiser).
class ReceivedPulse
{
public:
  /// A rectangle. @param width width, intervals; 0: all energy arrives at the delay
  ReceivedPulse(double width) // NOLINT(google-explicit-constructor): a width is a rectangle
    : Before(0.5 * width)
    , After(0.5 * width)
  {
  }
  /// @param interval length of an interval, s
  ReceivedPulse(const Sensor& sensor, double interval);

  /// From its delay, a pulse begins before() earlier and ends after() later.
  double before() const { return this->Before; }
  double after() const { return this->After; }
  double width() const { return this->Before + this->After; }
  bool isRectangle() const { return this->Table.empty(); }

  /// Share of the energy that arrives in the first part of the pulse. @param part 0 (its beginning)
  /// to 1 (its end)
  double shareOf(double part) const { return this->isRectangle() ? part : this->lookUp(part); }

  /// Share of the energy that arrives before `place`, counted from the delay.
  double shareBefore(double place) const;

private:
  /// Share of the energy up to a node, and its increase per step of the table.
  struct Node
  {
    double share, slope;
  };
  double lookUp(double part) const;

  double Before;
  double After;
  std::vector<Node> Table; ///< nodes at equal steps from the beginning to the end; empty: rectangle
};

/// Full width at half maximum of a Gaussian over its standard deviation, 2 (2 ln 2)^(1/2).
constexpr double WidthOfGaussian = 2.3548200450309493;

/// Returns an empty string, or a sentence on what is wrong with Sensor::pulseSamples.
std::string checkPulseSamples(const Sensor& sensor);
}

#endif
