// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTrace.h
 * @brief What is known of the geometry of a beam's paths over two reflections: where mirror paths
 * and short paths end, and which hits are connected and visible to each other. Found when first
 * needed and kept with the beam.
 *
 * A connection is a pair of hits that face each other, with all that the energy of a path over both
 * depends on but materials, in SIMD lanes. Where a beam looks into a corner there are M of them for
 * each ray: 85 bytes and some ns each.
 *
 * Source: paper, Sec. 3.4; angles as ReflectionGeometry (Reflectance.h).
 * Differs: see SecondaryReflection.h.
 * Valid: for the beam's hits, and connections for `partners` = M.
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
/// Whether anything stands between the hits of a connection.
enum class Visibility : std::uint8_t
{
  Unknown = 0,
  Blocked = 1,
  Clear = 2
};

/// Connections, one value each, in the order of path numbers. The light is reflected first at the
/// hit P1, then at P2; angles at P2 are those of light from P1 to the apex (ReflectionGeometry).
struct SecondaryConnections
{
  std::vector<std::uint32_t> one;    ///< hit P1
  std::vector<std::uint32_t> two;    ///< hit P2
  std::vector<std::uint32_t> number; ///< k: P2 is hit by the k-th partner of the ray of P1
  std::vector<Visibility> visibility;
  std::vector<double> weight;        ///< weight in the mean over the cone
  std::vector<double> length;        ///< from P1 to P2, m
  std::vector<double> cosOut;        ///< cosine of the segment at P1
  std::vector<double> differenceOne; ///< cos theta_d at P1
  std::vector<double> cosIn;         ///< cosine of the segment at P2
  std::vector<double> cosLobe;       ///< at P2, as the two below
  std::vector<double> sin2Lobe;
  std::vector<double> sin2Half;
  std::vector<double> differenceTwo; ///< cos theta_d at P2

  std::size_t size() const { return this->one.size(); }
  std::size_t bytes() const;
  void clear() { *this = SecondaryConnections{}; }

  /// Reserve memory for so many.
  void reserve(std::size_t connections);

  /// Add P1, P2, k and weight; measure() sets the other values of all.
  void add(std::uint32_t hit1, std::uint32_t hit2, std::uint32_t k, double meanWeight);
  void measure(const BeamSamples& hits, const SampleGeometry& geometry);
};

/// Where a mirror path ends.
enum class MirrorEnd : std::uint8_t
{
  NotTraced = 0,
  Nowhere = 1,
  Arrives = 2
};

/// A mirror path that arrives, with all that its energy depends on but materials.
struct MirrorPath
{
  std::uint32_t start;       ///< by regions: surface on which it starts
  std::uint32_t one;         ///< hit of the first reflection; by regions: sample of the surface
  std::uint32_t first;       ///< triangle of the first reflection
  std::uint32_t triangle;    ///< of the second reflection
  double weight;             ///< share of the pulse's energy
  double back;               ///< the same of light that goes the other way, over `weight`
  double cosine;             ///< of incidence at the first point
  double rangeOne;           ///< of the first point, m
  double length;             ///< whole path, m
  double range;              ///< of the second point, m
  ReflectionGeometry second; ///< angles at the second point
  Vec3 from, end;            ///< the two points, m, from the apex
  Visibility visibility;     ///< whether anything stands in its way
};

/// A path of matt light whose form factor exceeds MostFormFactor (SecondaryReflection.h).
struct ShortPath
{
  std::uint32_t one;         ///< hit of the first reflection
  std::uint32_t triangle;    ///< of the second reflection
  double weight;             ///< share of the pulse's energy
  double length;             ///< whole path, m
  double range;              ///< of the second point, m
  ReflectionGeometry first;  ///< angles at the first point
  ReflectionGeometry second; ///< angles at the second point
  Vec3 from, end;            ///< the two points, m, from the apex
};

/// Known paths of a beam.
struct SecondaryTrace
{
  std::vector<MirrorEnd> mirror; ///< one per hit; empty until first needed
  /// By surface, if mirror paths are found by regions (MirrorRegions.h): whether they are.
  std::vector<char> searched;
  std::vector<MirrorPath> mirrorPaths; ///< in the order of hits
  SecondaryConnections connections;
  std::uint32_t partners = 0;        ///< M of `connections`
  std::vector<ShortPath> shortPaths; ///< in the order of hits
  bool shortTraced = false;          ///< true once `shortPaths` holds all of them

  std::size_t bytes() const
  {
    return sizeof(SecondaryTrace) + this->mirror.capacity() * sizeof(MirrorEnd) +
      this->mirrorPaths.capacity() * sizeof(MirrorPath) + this->searched.capacity() +
      this->shortPaths.capacity() * sizeof(ShortPath) + this->connections.bytes();
  }
};
}

#endif
