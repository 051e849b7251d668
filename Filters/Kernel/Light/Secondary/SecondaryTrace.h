// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTrace.h
 * @brief What is known of the geometry of a beam's paths over two reflections: where mirror paths
 * end, and which samples see each other. Found when first needed, and kept with the beam.
 */
#ifndef avianlidar_SecondaryTrace_h
#define avianlidar_SecondaryTrace_h

#include "Reflectance.h"
#include "SecondaryConnections.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
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
