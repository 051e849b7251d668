// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ConnectionFinder.h
 * @brief Which hits of a beam are connected (see SecondaryReflection.h), and with which weight.
 *
 * Partners are drawn as M cyclic shifts of the ray numbers. With the rays twice in a row, all pairs
 * of one shift are a loop over lanes that looks at neighbours: some thirty operations for a whole
 * vector of pairs. Where there is no
 * pair of surfaces of which each has a hit before the plane of the other, as with two walls at an
 * outer corner, not even that is done.
 */
#ifndef avianlidar_ConnectionFinder_h
#define avianlidar_ConnectionFinder_h

#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Reusable without allocation; one per thread.
class ConnectionFinder
{
public:
  explicit ConnectionFinder(const ScanSetup& setup);

  /// Fill the connections of the beam's trace for `partners` >= 1 a ray.
  void find(const SecondaryBeam& beam, std::uint32_t partners);

private:
  bool findFacingSurfaces(const BeamSamples& hits, const SampleGeometry& geometry);
  void chooseShifts(std::uint64_t beam, std::uint32_t rays, std::uint32_t count);
  double partnerWeight(
    const SecondaryBeam& beam, std::uint32_t n, std::uint32_t partner, double partnerShare) const;
  double solidAngleShare(const SecondaryScene& scene, std::uint32_t ray) const;

  void lookAtPairs(const BeamSamples& hits, const SampleGeometry& geometry);

  const ScanSetup& Setup;
  std::vector<std::uint32_t> Shifts;
  std::vector<char> Taken;
  std::vector<std::uint32_t> HitOfRay;
  /// Hits by ray, twice in a row; rays without a hit have no normal.
  struct RayLanes
  {
    std::vector<double> px, py, pz, nx, ny, nz, margin;
  };
  RayLanes Rays;
  std::vector<std::uint64_t> Partners; ///< by ray, 64 a row: bits of those that face it
  std::vector<char> Facing;            ///< pairs of surfaces, if they are few
  std::vector<double> Heights;         ///< of surfaces above planes, m
};

/// Throughput of each connection if nothing blocks it. @param materials of the samples
void connectionThroughputs(const ScanSetup& setup, const SecondaryBeam& beam,
  const MaterialLanes& materials, std::vector<double>& throughputs);

/// min(1, B/(g R2)): scale of a path from `sample` to a surface `second` that keeps the ray within
/// its budget.
double secondaryScale(const ScanSetup& setup, const SecondaryBeam& beam, std::uint32_t sample,
  const Material& first, const Material& second);

/// Solid angle of a cone of half-angle t, sr.
double coneSolidAngle(double halfBeamwidth);
}

#endif
