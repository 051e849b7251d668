// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTrace.h
 * @brief What is kept of one beam: the geometric facts that do not depend on energies (where its
 * rays hit and at which angle, where mirror paths end, which pairs of hit points see each other),
 * and what its paths bring back without air.
 *
 * They are found when first needed and kept, so that a scan with other coefficients, limits, noise
 * or attenuation traces nothing that is already known, and does not look at triangles again. A beam
 * that meets nothing costs 112 bytes, a hit 33, a connection of two hits 85, and 40 more if it
 * arrives.
 */
#ifndef avianlidar_BeamTrace_h
#define avianlidar_BeamTrace_h

#include "BeamTracer.h"
#include "PathStrengths.h"
#include "PrimaryHits.h"
#include "Reflectance.h"
#include "SecondaryLinks.h"
#include "SmallTargets.h"
#include "VisiblePatch.h"

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
  SecondaryLinks links;
  std::uint32_t connections = 0; ///< M that `links` was made for
  bool linksKnown = false;
  std::size_t unknown = 0; ///< mirror paths not yet traced
  std::size_t unseen = 0;  ///< links whose visibility is not known

  /// Nothing can arrive over two reflections, whatever the materials.
  bool isDark() const
  {
    return this->linksKnown && this->unknown == 0 && this->mirrorPaths.empty() &&
      this->links.size() == 0;
  }
  std::size_t bytes() const
  {
    return sizeof(SecondaryTrace) + this->mirror.capacity() * sizeof(MirrorEnd) +
      this->mirrorPaths.capacity() * sizeof(MirrorPath) + this->links.bytes();
  }
};

struct BeamTrace
{
  std::uint32_t rays = 0;              ///< N of this beam; 0: no rays traced yet
  std::uint32_t targetsLeftOut = 0;    ///< small ones without rays of their own, being too many
  std::unique_ptr<TargetRays> targets; ///< rays of each small one that has its own; null: none
  double smallestTarget = -1.0;        ///< of the needs that they were chosen for
  bool surveyed = false;               ///< it is known whether planes fill it
  /// m, in range; planes (negative: several) may fill the beam, but are of several surfaces, or go
  /// over so many range units, that rays take less time, and this was not looked into. 0: it was,
  /// or it need not be.
  double footprint = 0.0;
  std::unique_ptr<VisiblePatch> patch;       ///< the planes that fill it; null if none do
  std::unique_ptr<PrimaryHits> hits;         ///< null if no ray hit anything
  std::unique_ptr<SecondaryTrace> secondary; ///< null before the first need
  std::unique_ptr<PathStrengths> strengths;  ///< null before the first need
  std::unique_ptr<PrimaryHits> pilot;        ///< of the pilot's rays, if a target error is set
  TraceCounters counters;                    ///< cost of all tracing so far
  std::size_t held = 0;                      ///< heldBytes() when it was lit last

  bool meetsSomething() const { return this->hits || this->patch; }

  /// What it holds besides itself.
  std::size_t heldBytes() const
  {
    return (this->hits ? this->hits->bytes() : 0) +
      (this->strengths ? this->strengths->bytes() : 0) +
      (this->secondary ? this->secondary->bytes() : 0) + (this->pilot ? this->pilot->bytes() : 0) +
      (this->patch ? this->patch->bytes() : 0) +
      (this->targets ? sizeof(TargetRays) + this->targets->capacity() * sizeof(std::uint32_t) : 0);
  }
};
static_assert(sizeof(void*) != 8 || sizeof(BeamTrace) == 112, "as said above");

/// What lighting reads of beams lies far apart in memory: these begin to fetch it while other beams
/// are lit: the beam first, then what it holds, then the arrays of that.
void fetchBeam(const BeamTrace& trace);
void fetchParts(const BeamTrace& trace);
void fetchArrays(const BeamTrace& trace);

/// From one shading to the next: most changes are of the materials of some triangles, and leave the
/// beams that do not meet them as they are.
struct ShadingChange
{
  Shading shading;             ///< the present one
  std::uint32_t number = 0;    ///< of this shading, from 1
  std::vector<char> repainted; ///< by triangle; empty: everything changed
  bool isNew = true;           ///< it came with the last call of follow()

  /// Go on to the setup's shading. Takes a pass over all materials if they are not the same array.
  void follow(const ScanSetup& setup);

  /// True if the last change may have changed strengths of the beam.
  bool touch(const BeamTrace& trace) const;

  /// True if the last change may have changed what the patch returns.
  bool touch(const VisiblePatch& patch) const;

private:
  bool isRepainted(std::uint32_t triangle) const { return this->repainted[triangle] != 0; }
};
}

#endif
