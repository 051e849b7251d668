// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Advice.h
 * @brief What a scene requires, measured on some of a scan's beams: errors and times of settings
 * against a reference of high fidelity, and the fastest setting that meets errors that are asked.
 *
 * 1. Some beams are scanned with default settings, to know which have an echo, which meet a surface
 *    without one, which meet a mover and which nothing. Of each kind some are drawn, with weights.
 * 2. The reference: two scans of these by cells, ReferenceRays each; of beams of which the two
 *    differ by much eight scans of four times as many. From their spread, and from what two scans
 *    by plain rays differ by from them beyond their own spread, follows the reference's own error.
 * 3. Each setting scans the same beams: its errors, with bounds, are those of EchoErrors.h.
 * 4. Times are processor times of one thread, over runs of neighbouring beams, as neighbours share
 *    work. Errors are those of the first turn. Settings that clearly fail, or that take far longer
 * than one that is good, get one turn.
 *
 * An error is met if its upper bound is below what is asked.
 *
 * Source: none.
 * Valid: noise is off: it belongs to the receiver and is no error. Errors and choices are the same
 * for any number of threads but for times, which decide what is fastest.
 * Test: Testing/Python/TestAdvice.py.
 */
#ifndef avianlidar_Advice_h
#define avianlidar_Advice_h

#include "EchoErrors.h"
#include "Scan.h"

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace avianlidar
{
/// Settings among which advice chooses.
struct AdviceSettings
{
  BeamSampleSource samples = BeamSampleSource::Cells;
  int rays = 100;
  int reflections = 2;
  int connections = 2;
  Sampling sampling = Sampling::Stratified;
  void apply(EchoSettings& settings) const;
};

enum class AdviceVerdict
{
  NotMet = 0,
  Undecided = 1, ///< the beams cannot tell
  Met = 2
};

struct AdviceTrial
{
  AdviceSettings settings;
  std::array<MeasuredError, ErrorKinds> errors;
  double seconds = 0.0; ///< of a beam, one core, median of turns
  int turns = 0;
  AdviceVerdict verdict = AdviceVerdict::NotMet;
};

/// What is asked, and how it is looked for.
struct AdviceQuestion
{
  std::array<double, ErrorKinds> asked{ { 0.02, 0.05, 0.01 } };
  int beams = 1000; ///< to measure on, of all ranks
  int threads = 0;  ///< of scans that are not timed
};

/// What the scene requires.
struct AdviceAnswer
{
  std::vector<AdviceTrial> trials; ///< the first: settings as they are
  int advised = -1;                ///< index of a trial; -1: none meets what is asked
  int best = -1;      ///< if none does: the one whose errors are the smallest parts of those asked
  double beams = 0.0; ///< of the scan
  double measured = 0.0;                ///< of them, looked at
  double echoes = 0.0;                  ///< of these, in the reference
  std::array<double, ErrorKinds> own{}; ///< errors of the reference
  // Shares, of what the reference receives.
  double secondary = 0.0;        ///< of the energy, over two reflections
  double largestSecondary = 0.0; ///< of an echo
  bool reflectsTwice = true;     ///< second reflections are more than rounding
  double connected = 0.0;        ///< of the energy, over connections
  std::array<MeasuredError, ErrorKinds> withoutSecondary;
  std::array<MeasuredError, ErrorKinds> withoutConnections;
  // Costs, of default settings with another.
  double secondaryCost = 0.0;   ///< time of two reflections over one, less 1
  double connectionCost = 0.0;  ///< time of two connections over none, less 1
  std::array<double, 5> direct; ///< share of beams by DirectEcho
  // Air and media.
  double lostInAir = 0.0;     ///< echoes without air over those with it, less 1
  double pointsOfAir = 0.0;   ///< share of the echoes
  double airCost = 0.0;       ///< time with scattering air over that without, less 1
  double weakenedByAir = 0.0; ///< energy without air over that with it, less 1
  // Processes.
  double treeSeconds = 0.0; ///< of one core, to build the tree; 0: not measured
  double scanSeconds = 0.0; ///< of one core, the scan with what is advised, else with default
  bool convex = false;      ///< the surfaces are one closed convex body, seen from outside
};

/// How processes work together.
struct AdviceHost
{
  /// Run a step that may fail on any of them. @return false: on one it failed or was stopped
  std::function<bool(const std::function<void()>&)> together;
  std::function<double(double)> sum; ///< over all
  std::function<double(double)> largest;
  KeepGoing keepGoing;
};

/// Rays per beam of the reference, and of the plain rays that it is compared with.
constexpr int ReferenceRays = 6400;
constexpr int WitnessRays = 10000;

/// Measure and choose. @param setup complete, with its tree @return false if a step was
bool advise(const ScanSetup& setup, const ScanBeams& beams, const AdviceQuestion& question,
  const AdviceHost& host, AdviceAnswer& answer);
}

#endif
