// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LinkFinder.h
 * @brief Which hits of a beam are connected (see SecondaryReflection.h), and with which weight.
 *
 * Partners are drawn as M cyclic shifts of the ray numbers. Pairs of surfaces of which none has a
 * hit before the plane of the other, as two walls at an outer corner, are told apart first; of the
 * rest each pair of hits is looked at: about 5 ns each.
 */
#ifndef avianlidar_LinkFinder_h
#define avianlidar_LinkFinder_h

#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Reusable without allocation; one per thread.
class LinkFinder
{
public:
  explicit LinkFinder(const ScanSetup& setup);

  /// Fill the links of the beam's trace for `connections` >= 1 partners a ray.
  void find(const SecondaryBeam& beam, std::uint32_t connections);

private:
  bool findFacingSurfaces(const PrimaryHits& hits, const HitGeometry& geometry);
  void chooseShifts(std::uint64_t beam, std::uint32_t rays, std::uint32_t count);
  double partnerWeight(
    const SecondaryBeam& beam, std::uint32_t n, std::uint32_t partner, double partnerShare) const;
  double solidAngleShare(const SecondaryScene& scene, std::uint32_t ray) const;

  const ScanSetup& Setup;
  std::vector<std::uint32_t> Shifts;
  std::vector<char> Taken;
  /// Hits of a connection, and its number.
  struct Pair
  {
    std::uint32_t one;
    std::uint32_t two;
    std::uint32_t connection;
  };
  std::vector<std::uint32_t> HitOfRay;
  std::vector<HitPoint> Points; ///< by hit
  std::vector<Pair> Found;
  std::vector<char> Facing;    ///< pairs of surfaces, if they are few
  std::vector<double> Heights; ///< of surfaces above planes, m
};
}

#endif
