// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTrace.h
 * @brief Geometry of a beam's paths with two reflections: ends of mirror paths and short paths, and
 * connections of hits. The geometry is found when first needed, and kept with the beam.
 *
 * A connection is a pair of hits that face each other. All values on which the connection's energy
 * depends, except materials, are stored for SIMD lanes. A beam into a corner has M connections per
 * ray. A connection takes 81 bytes of memory and a few ns of time.
 *
 * Source: paper, Sec. 3.4; angles as in ReflectionGeometry (Reflectance.h).
 * Differs: see SecondaryReflection.h.
 * Valid: for the hits of one beam. Connections are valid for one M (`partners`).
 * Test: TestSecondaryPaths.cxx, TestSecondaryReflection.cxx.
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
/// Whether a surface blocks the segment of a path.
enum class Visibility : std::uint8_t
{
  Unknown = 0,
  Blocked = 1,
  Clear = 2
};

/// Connections, one value per connection and member, in the order of path numbers. The light is
/// reflected first at the hit P1, then at P2. Angles at P2 belong to light from P1 to the apex
/// (ReflectionGeometry).
struct SecondaryConnections
{
  std::vector<std::uint32_t> one; ///< hit P1
  std::vector<std::uint32_t> two; ///< hit P2
  std::vector<Visibility> visibility;
  std::vector<double> weight;        ///< weight in the mean over the cone
  std::vector<double> length;        ///< distance from P1 to P2, m
  std::vector<double> cosOut;        ///< cosine of the segment at P1
  std::vector<double> differenceOne; ///< cos theta_d at P1
  std::vector<double> cosIn;         ///< cosine of the segment at P2
  std::vector<double> cosLobe;       ///< ReflectionGeometry::cosLobe at P2
  std::vector<double> sin2Lobe;      ///< ReflectionGeometry::sin2Lobe at P2
  std::vector<double> sin2Half;      ///< ReflectionGeometry::sin2Half at P2
  std::vector<double> differenceTwo; ///< cos theta_d at P2

  std::size_t size() const { return this->one.size(); }
  std::size_t bytes() const;
  void clear() { *this = SecondaryConnections{}; }

  /// Reserve memory for a number of connections.
  void reserve(std::size_t connections);

  /// Add P1, P2 and the weight of a connection. measure() sets the other values of all connections.
  void add(std::uint32_t hit1, std::uint32_t hit2, double meanWeight);
  void measure(const BeamSamples& hits, const SampleGeometry& geometry);
};

/// End of a mirror path.
enum class MirrorEnd : std::uint8_t
{
  NotTraced = 0,
  Nowhere = 1, ///< where neither the apex nor a mirror sees it in the cone
  Arrives = 2
};

/// Where light from a mirror meets a matt surface, in a direction drawn from the mirror's lobe, and
/// where the mirror shows this place.
struct MattEnd
{
  bool seen = false;         ///< whether the apex sees the place, in the cone
  bool shown = false;        ///< whether the apex sees the place in the mirror, in the cone
  std::uint32_t triangle;    ///< triangle of the second reflection
  std::uint32_t mirror;      ///< triangle of the third reflection
  double back;               ///< weight of the reverse path / weight of the path
  double again;              ///< weight of the path back by the mirror / weight of the path
  double range;              ///< range of the place, m
  double image;              ///< range of its image behind the mirror, m
  double length;             ///< length of the whole path, m
  double lengthAgain;        ///< length of the whole path back by the mirror, m
  double cosine;             ///< cosine of incidence at the third point, seen from the apex
  ReflectionGeometry second; ///< angles of the light to the apex
  ReflectionGeometry third;  ///< angles of the light to the third point
  Vec3 end, through;         ///< second and third point relative to the apex, m
};

/// A mirror path that arrives, with all values on which the path's energy depends, except
/// materials.
struct MirrorPath
{
  std::uint32_t start;           ///< surface of MirrorRegions.h on which the path starts
  std::uint32_t one;             ///< hit of the first reflection, or sample of MirrorRegions.h
  std::uint32_t first;           ///< triangle of the first reflection
  std::uint32_t triangle;        ///< triangle of the second reflection
  double weight;                 ///< share of the pulse's energy
  double cosine;                 ///< cosine of incidence at the first point
  double rangeOne;               ///< range of the first point, m
  double length;                 ///< length of the whole path, m
  double range;                  ///< range of the second point, m
  ReflectionGeometry second;     ///< angles at the second point
  Vec3 from, end;                ///< the two points relative to the apex, m
  Visibility visibility;         ///< whether the path is blocked
  bool seen = true;              ///< whether the apex sees the second point, in the cone
  std::uint32_t matt = NoSample; ///< number of the matt end, or NoSample
};

/// Number of a mirror path by MirrorRegions.h, after the path `before` (null: none) of the number
/// `number`. The two samples 2k and 2k + 1 of a surface, a stratum, have the numbers 2n and 2n + 1.
/// There are fewer numbers than paths, times two, so that no number overflows.
inline std::uint32_t numberAfter(
  const MirrorPath* before, std::uint32_t number, const MirrorPath& path)
{
  const bool isSame = before && before->start == path.start && before->one / 2 == path.one / 2;
  return (before ? number / 2 + (isSame ? 0 : 1) : 0) * 2 + path.one % 2;
}

/// A path of matt light whose form factor exceeds MostFormFactor (SecondaryReflection.h).
struct ShortPath
{
  std::uint32_t one;         ///< hit of the first reflection
  std::uint32_t triangle;    ///< triangle of the second reflection
  double weight;             ///< share of the pulse's energy
  double length;             ///< length of the whole path, m
  double range;              ///< range of the second point, m
  ReflectionGeometry first;  ///< angles at the first point
  ReflectionGeometry second; ///< angles at the second point
  Vec3 from, end;            ///< the two points relative to the apex, m
};

/// Paths of a beam that have been found.
struct SecondaryTrace
{
  std::vector<MirrorEnd> mirror; ///< end of the mirror path of each hit; empty until first needed
  /// How far MirrorRegions.h has searched each surface: 0 not at all, 1 for ends that the apex
  /// sees, 2 for all ends. Empty: mirror paths start from hits.
  std::vector<char> searched;
  std::uint64_t lobes = 0; ///< hash of the lobes from which directions of `mirrorPaths` were drawn
  std::vector<MirrorPath> mirrorPaths; ///< mirror paths, in the order of hits or surfaces
  std::vector<MattEnd> mattEnds;       ///< with an aperture, those of paths that are not blocked
  SecondaryConnections connections;
  std::uint32_t partners = 0;        ///< M of `connections`
  std::vector<ShortPath> shortPaths; ///< short paths, in the order of hits
  bool shortTraced = false;          ///< true once all short paths have been found

  std::size_t bytes() const
  {
    return sizeof(SecondaryTrace) + this->mirror.capacity() * sizeof(MirrorEnd) +
      this->mirrorPaths.capacity() * sizeof(MirrorPath) +
      this->mattEnds.capacity() * sizeof(MattEnd) + this->searched.capacity() +
      this->shortPaths.capacity() * sizeof(ShortPath) + this->connections.bytes();
  }
};
}

#endif
