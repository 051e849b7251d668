// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTrace.h
 * @brief The geometric facts of one beam that do not depend on energies: what each ray hits first,
 * where its mirror path ends, which pairs of hit points see each other.
 *
 * They are found when first needed and kept, so that a scan with other coefficients, limits, noise
 * or attenuation traces nothing that is already known. Ranges and angles are not kept: they follow,
 * bit for bit, from the triangle and the ray.
 */
#ifndef avianlidar_BeamTrace_h
#define avianlidar_BeamTrace_h

#include "BeamTracer.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// A mirror path that nobody has traced yet.
constexpr std::uint32_t NotTraced = 0xfffffffeu;

enum class Visibility : std::uint8_t
{
  Unknown = 0,
  Blocked = 1,
  Clear = 2
};

struct BeamTrace
{
  std::uint32_t rays = 0; ///< N of this beam; 0: nothing traced yet
  bool anyHit = false;
  std::vector<std::uint32_t>
    primary; ///< triangle of each ray, NoTriangle if none; empty if !anyHit
  std::vector<std::uint32_t>
    mirror; ///< triangle at the end of each mirror path, NoTriangle, or NotTraced
  std::vector<Visibility> links;    ///< of ray n and its k-th connection: [n * connections + k]
  std::uint32_t connections = 0;    ///< M that `links` was made for
  std::vector<std::uint32_t> pilot; ///< triangles of the pilot's rays, if a target error is set
  TraceCounters counters;           ///< cost of all tracing so far

  std::size_t bytes() const
  {
    return sizeof(BeamTrace) +
      4 * (this->primary.capacity() + this->mirror.capacity() + this->pilot.capacity()) +
      this->links.capacity();
  }
};
}

#endif
