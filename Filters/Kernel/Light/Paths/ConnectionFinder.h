// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ConnectionFinder.h
 * @brief Diffuse connections of a beam (SecondaryReflection.h): the connected hits, their weights,
 * and the throughput of each connection without attenuation by air.
 *
 * 1. Two surfaces may face each other if each surface has a hit in front of the plane of the other
 * surface. A beam without two such surfaces, as at the outer corner of two walls, has no
 * connections.
 * 2. Each ray is connected to M other rays, its partners, by M cyclic shifts of the ray numbers.
 * Rays are stored twice in a row, so that one SIMD loop tests all pairs of a shift, with about
 * thirty operations per vector of pairs.
 * 3. Throughputs are computed in SIMD loops, in about 5 ns per connection.
 *
 * Source: paper, Sec. 3.4; Floyd's algorithm for samples without repetition, for the shifts.
 * Differs: the paper leaves open which secondary directions are followed, and with which weight.
 * Here the weighted sum of the throughputs of a ray's connections is an unbiased estimate of the
 * mean throughput over the cone's solid angle. With an aperture, the sum estimates the mean of the
 * form factor, limited to MostFormFactor.
 * Valid: M from 1 to N - 1, with N the number of rays. Connected pairs face each other by more than
 * surfaceMargin().
 * Test: TestSecondaryReflection.cxx, TestSecondaryPaths.cxx.
 */
#ifndef avianlidar_ConnectionFinder_h
#define avianlidar_ConnectionFinder_h

#include "BeamShape.h"
#include "LaneMath.h"
#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Finds the connections of one beam after the other, without allocation for each beam. Each thread
/// needs its own object.
class ConnectionFinder
{
public:
  explicit ConnectionFinder(const ScanSetup& setup);

  /// Set the connections in the trace of a beam. @param partners M, at least 1
  void find(const SecondaryBeam& beam, std::uint32_t partners);

  /// Find the pairs of surfaces that may face each other: each surface has a hit in front of the
  /// plane of the other surface. @return false if there are no such pairs
  bool findFacing(const BeamSamples& hits, const SampleGeometry& geometry);

  /// False if a surface certainly faces no other surface. @param surfaces number of all surfaces
  bool faces(std::uint32_t surface, std::size_t surfaces) const;

private:
  void chooseShifts(std::uint64_t beam, std::uint32_t rays, std::uint32_t count);
  double partnerWeight(
    const SecondaryBeam& beam, std::uint32_t n, std::uint32_t partner, double partnerShare) const;
  double solidAngleShare(const SecondaryBeam& beam, std::uint32_t ray) const;

  void findPartners(const BeamSamples& hits, const SampleGeometry& geometry);

  const ScanSetup& Setup;
  const BeamShape Shape;
  std::vector<std::uint32_t> Shifts;
  std::vector<char> Taken;
  std::vector<std::uint32_t> HitOfRay;
  /// Points (m), normals and margins (m) of hits by ray, twice in a row; normal 0: no hit.
  struct RayLanes
  {
    std::vector<double> px, py, pz, nx, ny, nz, margin;
  };
  RayLanes Rays;
  std::vector<std::uint64_t> Partners; ///< bits of the partners that face a ray, 64 in a row
  std::vector<char> Facing;            ///< whether two surfaces may face each other; empty: unknown
  std::vector<double> Heights;         ///< largest heights of surfaces above planes, m
};

/// Form factor at P1 of the part of a surface in the cone, computed as if all of the part lay at
/// P2: the solid angle of the part, weighted with cosOut, divided by pi.
/// @param cosOut, cosIn cosines of the segment at P1 and P2 @param length distance from P1 to P2, m
/// @param range range of P2, m @param cosBack cosine of incidence of the lidar's own light at P2
/// @param solidAngle solid angle of the cone, sr
AVIANLIDAR_ALWAYS_INLINE double formFactor(
  double cosOut, double cosIn, double length, double range, double cosBack, double solidAngle)
{
  const double area = range * range * solidAngle / lanes::larger(cosBack, 1e-300);
  return cosOut * cosIn * area / (Pi * length * length);
}

/// Largest form factor of a connection. Short paths account for the excess of form factors above
/// this value.
constexpr double MostFormFactor = 1.0;

/// Find the throughput that each connection has unless a surface blocks the connection. @param
/// materials material of each sample
void connectionThroughputs(const ScanSetup& setup, const SecondaryBeam& beam,
  const MaterialLanes& materials, std::vector<double>& throughputs);

/// Scale min(1, B/(g R2)) of a path with two reflections. The scale keeps the ray within the ray's
/// budget (SecondaryReflection.h). @param direct share of the arriving energy that the first
/// surface returns as the direct echo
double secondaryScale(const ScanSetup& setup, const Material& first, const Material& second,
  double cosIncidence, double direct);
}

#endif
