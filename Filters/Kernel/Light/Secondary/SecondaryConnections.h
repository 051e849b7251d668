// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryConnections.h
 * @brief Diffuse connections of a beam: pairs of its hits that look at each other, with all that
 * the energy of a path over both depends on but materials, in lanes.
 *
 * Where a beam looks into a corner, there are M of them for each ray: 85 bytes and some ns each.
 */
#ifndef avianlidar_SecondaryConnections_h
#define avianlidar_SecondaryConnections_h

#include "BeamSamples.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
enum class Visibility : std::uint8_t
{
  Unknown = 0,
  Blocked = 1,
  Clear = 2
};

/// One value per connection, in the order of path numbers. P1 is the hit where the light is
/// reflected first, P2 the second; what is said of P2 holds for light that comes from P1 and goes
/// to the apex (see ReflectionGeometry).
struct SecondaryConnections
{
  std::vector<std::uint32_t> one;    ///< hit P1
  std::vector<std::uint32_t> two;    ///< hit P2
  std::vector<std::uint32_t> number; ///< k: P2 is hit by the k-th partner of the ray of P1
  std::vector<Visibility> visibility;
  std::vector<double> weight;        ///< in the mean over the cone
  std::vector<double> length;        ///< m, from P1 to P2
  std::vector<double> cosOut;        ///< at P1, of the segment
  std::vector<double> differenceOne; ///< at P1, cos theta_d
  std::vector<double> cosIn;         ///< at P2, of the segment
  std::vector<double> cosLobe;       ///< at P2
  std::vector<double> sin2Lobe;      ///< at P2
  std::vector<double> sin2Half;      ///< at P2
  std::vector<double> differenceTwo; ///< at P2, cos theta_d

  std::size_t size() const { return this->one.size(); }
  std::size_t bytes() const;
  void clear() { *this = SecondaryConnections{}; }

  /// Make room for so many at once.
  void reserve(std::size_t connections);

  /// Add P1, P2, k and weight; measure() does the rest.
  void add(std::uint32_t hit1, std::uint32_t hit2, std::uint32_t k, double meanWeight);
  void measure(const BeamSamples& hits, const SampleGeometry& geometry);
};
}

#endif
