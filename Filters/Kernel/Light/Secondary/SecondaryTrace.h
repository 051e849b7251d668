// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTrace.h
 * @brief What is known of the geometry of a beam's paths over two reflections: where mirror paths
 * end, and which samples see each other. Found when first needed, and kept with the beam.
 */
#ifndef avianlidar_SecondaryTrace_h
#define avianlidar_SecondaryTrace_h

#include "BeamSamples.h"
#include "Reflectance.h"

#include <cstddef>
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

enum class MirrorEnd : std::uint8_t
{
  NotTraced = 0,
  Nowhere = 1,
  Arrives = 2
};

/// A mirror path that arrives: all that its energy depends on but materials.
struct MirrorPath
{
  std::uint32_t one;         ///< hit where it is reflected first
  std::uint32_t triangle;    ///< of the second reflection
  double length;             ///< m, all of it
  double range;              ///< m, of the second point
  ReflectionGeometry second; ///< angles there
};

struct SecondaryTrace
{
  std::vector<MirrorEnd> mirror;       ///< of each hit; empty before the first need
  std::vector<MirrorPath> mirrorPaths; ///< in the order of hits
  SecondaryConnections connections;
  std::uint32_t partners = 0; ///< M that `connections` was made for
  bool connectionsKnown = false;
  std::size_t unknown = 0; ///< mirror paths not yet traced
  std::size_t unseen = 0;  ///< connections whose visibility is not known

  std::size_t bytes() const
  {
    return sizeof(SecondaryTrace) + this->mirror.capacity() * sizeof(MirrorEnd) +
      this->mirrorPaths.capacity() * sizeof(MirrorPath) + this->connections.bytes();
  }
};
}

#endif
