// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EchoErrors.h
 * @brief Errors of echoes against a reference of the same beams: of energy, of range, and echoes
 * missed or invented; with bounds, where the beams are a weighted sample.
 *
 * Echoes are matched within a beam: each is the nearest of the other, within a tolerance. Energy
 * and range are those of strong echoes that are no ghosts (at most half of the energy over two
 * reflections, in the reference); a strong echo that is missed has an energy error of -1. Of ghosts
 * counts whether they are there. Echoes that only some scans of the reference have are not judged.
 *
 * Bounds are one-sided with 95 %, for a scan of all beams with another seed: from the spread among
 * beams, which counts twice where all beams were taken, as both draws differ, and three times the
 * part of a beam that errs more, as few such beams tell little of their number (of a share without
 * any wrong echo 3/n); plus the reference's own error. An rms of fewer than 30 beams has none.
 *
 * Source: variance of a ratio of weighted sums, linearised: Cochran, Sampling Techniques, 3rd ed.,
 * section 6 (second-hand).
 * Valid: noise is off in all scans.
 * Test: Testing/Python/TestAdvice.py.
 */
#ifndef avianlidar_EchoErrors_h
#define avianlidar_EchoErrors_h

#include "Scan.h"

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace avianlidar
{
/// What an error is of.
enum ErrorKind
{
  EnergyError = 0, ///< rms, relative, of the energy received
  RangeError = 1,  ///< rms, m
  EchoError = 2,   ///< share of the true echoes that is missed or invented
  ErrorKinds = 3
};

/// An error, and the bounds within which it lies.
struct MeasuredError
{
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

struct SeenEcho
{
  double range;
  double energy;
  double secondary; ///< share of the energy
};
using EchoesByBeam = std::vector<std::vector<SeenEcho>>;

EchoesByBeam byBeam(const ScanResult& result);

/// A ratio of sums over beams, x over y, of each kind of error.
struct CountedErrors
{
  std::array<double, ErrorKinds> x{};
  std::array<double, ErrorKinds> y{};
};

/// What is taken for true of some beams, and how sure that is.
class EchoReference
{
public:
  /// @param tolerance between echoes that are one, m @param strong least energy that is judged, J
  EchoReference(double tolerance, double strong);

  void resize(std::size_t beams);

  /// A beam is the mean of some scans of it; echoes that not all have are undecided.
  void average(std::size_t beam, const std::vector<std::vector<SeenEcho>>& scans);

  /// What the mean of two scans by other means differs by from it, less what it should by their own
  /// spread, in squares.
  void compare(std::size_t beam, const std::array<EchoesByBeam, 2>& witness);

  /// Add the errors of a scan, by beam.
  void count(const ScanResult& result, std::vector<CountedErrors>& counted) const;

  std::size_t numberOfEchoes() const;
  const std::vector<CountedErrors>& spread() const { return this->Spread; }
  const std::vector<CountedErrors>& bias() const { return this->Bias; }

private:
  bool isStrong(const SeenEcho& echo) const;

  double Tolerance;
  double Strong;
  EchoesByBeam Sure;
  EchoesByBeam Undecided;
  std::vector<CountedErrors> Spread; ///< of the mean
  std::vector<CountedErrors> Bias;
};

/// Errors of a population of which beams were drawn, each for `weight` others.
class SampledErrors
{
public:
  /// @param weights by beam; kept by reference @param sum over all ranks
  SampledErrors(const std::vector<double>& weights, const std::function<double(double)>& sum);

  /// Errors of the reference itself.
  std::array<double, ErrorKinds> ownErrors(const EchoReference& reference) const;

  /// Errors with their bounds. @param own errors of the reference
  std::array<MeasuredError, ErrorKinds> errorsOf(
    const std::vector<CountedErrors>& counted, const std::array<double, ErrorKinds>& own) const;

private:
  struct Sums;
  Sums sumsOf(const std::vector<CountedErrors>& counted, int kind) const;

  const std::vector<double>& Weights;
  const std::function<double(double)>& Sum;
};
}

#endif
