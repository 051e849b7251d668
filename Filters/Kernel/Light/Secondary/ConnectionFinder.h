// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ConnectionFinder.h
 * @brief Diffuse connections of a beam (SecondaryReflection.h): which hits are connected, with
 * which weight, and the throughput of each connection without air.
 *
 * Partners are M cyclic shifts of the ray numbers. With the rays stored twice in a row, all pairs
 * of one shift are one SIMD loop over neighbours: some thirty operations for a vector of pairs.
 * Beams in which no two surfaces each have a hit before the plane of the other, such as two walls
 * at an outer corner, are excluded before that. Throughputs are found in SIMD loops, about 5 ns
 * each.
 *
 * Source: paper, Sec. 3.4; the shifts are drawn by Floyd's algorithm for samples without
 * repetition.
 * Differs: the paper leaves open which secondary directions are followed, and their weight. Here
 * the sum over a ray's connections is an unbiased estimate of the mean over the cone's solid angle;
 * with an aperture it is the mean of the form factor, as far as that is below MostFormFactor.
 * Valid: M from 1 to N - 1; pairs that do not face each other by more than surfaceMargin() have no
 * connection.
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
/// Finds the connections of one beam after the other. Reusable without allocation; one per thread.
class ConnectionFinder
{
public:
  explicit ConnectionFinder(const ScanSetup& setup);

  /// Set the connections of the beam's trace, for `partners` >= 1 a ray.
  void find(const SecondaryBeam& beam, std::uint32_t partners);

  /// Find the pairs of surfaces with hits that may face each other: each has a hit before the plane
  /// of the other. @return false if there are none
  bool findFacing(const BeamSamples& hits, const SampleGeometry& geometry);

  /// False if a surface, one of so many, faces none of the others.
  bool faces(std::uint32_t surface, std::size_t surfaces) const;

private:
  void chooseShifts(std::uint64_t beam, std::uint32_t rays, std::uint32_t count);
  double partnerWeight(
    const SecondaryBeam& beam, std::uint32_t n, std::uint32_t partner, double partnerShare) const;
  double solidAngleShare(const SecondaryBeam& beam, std::uint32_t ray) const;

  void lookAtPairs(const BeamSamples& hits, const SampleGeometry& geometry);

  const ScanSetup& Setup;
  const BeamShape Shape;
  std::vector<std::uint32_t> Shifts;
  std::vector<char> Taken;
  std::vector<std::uint32_t> HitOfRay;
  /// Hits by ray, twice in a row; rays without a hit have no normal.
  struct RayLanes
  {
    std::vector<double> px, py, pz, nx, ny, nz, margin;
  };
  RayLanes Rays;
  std::vector<std::uint64_t> Partners; ///< by ray, 64 a row: bits of partners that face it
  std::vector<char> Facing;            ///< by pair of surfaces, if they are few
  std::vector<double> Heights;         ///< of surfaces above planes, m
};

/// Form factor of the cone's part of a surface, as if all of it lay where it is seen at P2, from
/// P1: solid angle of that surface, weighted with cosOut, over pi. @param length from P1 to P2, m
/// @param range of P2, m @param cosBack cosine of incidence of the lidar's own light at P2
/// @param solidAngle of the cone
AVIANLIDAR_ALWAYS_INLINE double formFactor(
  double cosOut, double cosIn, double length, double range, double cosBack, double solidAngle)
{
  const double area = range * range * solidAngle / lanes::larger(cosBack, 1e-300);
  return cosOut * cosIn * area / (Pi * length * length);
}

/// Largest form factor of a connection; what exceeds it is left to short paths.
constexpr double MostFormFactor = 1.0;

/// Throughput of each connection if nothing blocks it. @param materials of the samples
void connectionThroughputs(const ScanSetup& setup, const SecondaryBeam& beam,
  const MaterialLanes& materials, std::vector<double>& throughputs);

/// Scale min(1, B/(g R2)) of a path from a surface to a second one that keeps the ray within its
/// budget (SecondaryReflection.h). @param direct what the direct echo returns there
double secondaryScale(const ScanSetup& setup, const Material& first, const Material& second,
  double cosIncidence, double direct);
}

#endif
