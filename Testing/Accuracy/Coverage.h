// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Coverage.h
 * @brief How often +-1.96 standard errors hold the truth, and how wide they are.
 */
#ifndef avianlidar_Coverage_h
#define avianlidar_Coverage_h

#include "Windows.h"

#include <array>

namespace accuracy
{
/// Of some echoes, each in many seeds. Widths and errors are relative to the truth.
struct Coverage
{
  std::size_t estimates = 0;
  std::size_t held = 0;
  std::size_t unseen = 0; ///< of the estimates: the seed saw nothing, so there is no echo
  double widths = 0.0;    ///< sum of 1.96 s.e.
  double squares = 0.0;   ///< sum of squared errors
  double errors = 0.0;    ///< sum of errors

  void add(double truth, double energy, double standardError);
  void add(const Coverage& other);

  double share() const; ///< of estimates that hold the truth
  double shareOfSeen() const;
  double width() const; ///< mean of 1.96 s.e.
  double rms() const;
  double bias() const;
  double ratio() const { return this->width() / this->rms(); }
};

/// By decile of covered share; above `SecondaryFrom` of their energy over two reflections, echoes
/// are counted apart.
struct CoverageTable
{
  static constexpr double SecondaryFrom = 0.01;
  std::array<Coverage, 10> deciles;
  Coverage all;
  Coverage direct;
  Coverage secondary;
  std::array<std::size_t, 10> windows{}; ///< of the deciles

  /// Smallest share held in any decile of at least so many windows.
  double leastDecile(std::size_t windows) const;
};

/// Estimates of every window with seeds first ... first + seeds - 1. A window where a seed sees
/// nothing counts as not held.
CoverageTable measureCoverage(const AccuracyScene& scene, const std::vector<Window>& windows,
  avianlidar::EchoSettings settings, int first, int seeds);
}

#endif
