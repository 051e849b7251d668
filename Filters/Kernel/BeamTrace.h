// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTrace.h
 * @brief The geometric facts of one beam that do not depend on energies: where its rays hit and at
 * which angle, where mirror paths end, which pairs of hit points see each other.
 *
 * They are found when first needed and kept, so that a scan with other coefficients, limits, noise
 * or attenuation traces nothing that is already known, and does not look at triangles again. A beam
 * that meets nothing costs 64 bytes, a hit 25, a path over two reflections 200.
 */
#ifndef avianlidar_BeamTrace_h
#define avianlidar_BeamTrace_h

#include "BeamTracer.h"
#include "PrimaryHits.h"
#include "Reflectance.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
enum class MirrorEnd : std::uint8_t
{
  NotTraced = 0,
  Nowhere = 1,
  Arrives = 2
};

enum class Visibility : std::uint8_t
{
  Unknown = 0,
  Blocked = 1,
  Clear = 2
};

/// Two hits that look at each other, and may be connected.
struct SecondaryLink
{
  std::uint32_t one;        ///< hit where the path is reflected first
  std::uint32_t two;        ///< and second
  std::uint32_t connection; ///< k: `two` is the k-th partner of the ray of `one`
  Visibility visibility = Visibility::Unknown;
  double weight = 0.0; ///< of the connection, in the mean over the cone
};

/// A path over two reflections that is not blocked: all that its energy depends on but materials.
struct PathGeometry
{
  std::uint32_t path;        ///< number (see PathNumbers)
  std::uint32_t one;         ///< hit where it is reflected first
  std::uint32_t triangle;    ///< of the second reflection
  std::uint32_t link;        ///< index of its connection; NoLink for a mirror path
  double length;             ///< m, all of it
  double range;              ///< m, of the second point
  double angle;              ///< rad, of incidence at the second point
  double formFactor;         ///< of a connection, for receivers with an aperture
  ReflectionGeometry first;  ///< angles at P1
  ReflectionGeometry second; ///< angles at P2
};
constexpr std::uint32_t NoLink = 0xffffffffu;

struct SecondaryTrace
{
  std::vector<MirrorEnd> mirror;    ///< of each hit; empty before the first need
  std::vector<SecondaryLink> links; ///< in the order of path numbers
  std::vector<PathGeometry> paths;  ///< in the order of path numbers
  std::uint32_t connections = 0;    ///< M that `links` was made for
  bool linksKnown = false;
  std::size_t unknown = 0; ///< mirror paths and links not yet traced

  /// Nothing can arrive over two reflections, whatever the materials.
  bool isDark() const { return this->linksKnown && this->unknown == 0 && this->paths.empty(); }
  std::size_t bytes() const
  {
    return sizeof(SecondaryTrace) + this->mirror.capacity() * sizeof(MirrorEnd) +
      this->links.capacity() * sizeof(SecondaryLink) +
      this->paths.capacity() * sizeof(PathGeometry);
  }
};

struct BeamTrace
{
  std::uint32_t rays = 0;                    ///< N of this beam; 0: nothing traced yet
  std::unique_ptr<PrimaryHits> hits;         ///< null if no ray hit anything
  std::unique_ptr<SecondaryTrace> secondary; ///< null before the first need
  std::unique_ptr<PrimaryHits> pilot;        ///< of the pilot's rays, if a target error is set
  TraceCounters counters;                    ///< cost of all tracing so far

  /// What it holds besides itself.
  std::size_t heldBytes() const
  {
    return (this->hits ? this->hits->bytes() : 0) +
      (this->secondary ? this->secondary->bytes() : 0) + (this->pilot ? this->pilot->bytes() : 0);
  }
};
}

#endif
