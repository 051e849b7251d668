// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamRays.h
 * @brief Sampling of the beam: N rays of equal energy Qs/N, independent or stratified.
 *
 * Source: paper, Sec. 2.1, Eq. 1-3; cells after Beckers and Beckers, Computational Geometry 45(7),
 * 2012.
 * Differs: stratified rays and the Gaussian profile are added (for beams that are not round see
 * BeamShape.h). A ray's radius comes from
 * sin^2(theta/2), not from 1 - cos theta.
 * Valid: half-beamwidth from 1e-9 rad to pi/3, where radii are exact to a few units of round-off.
 * The sum over rays has no bias for any N.
 * Test: TestBeamRays.cxx.
 */
#ifndef avianlidar_BeamRays_h
#define avianlidar_BeamRays_h

#include "Random.h"
#include "Sensor.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
enum class Sampling
{
  MonteCarlo = 0, ///< N independent rays (the paper)
  Stratified = 1  ///< two independent rays in each of N/2 compact strata; odd N: three in the last
};

/// The rays of one beam in its own plane (see BeamFrame.h), structure of arrays.
struct BeamRays
{
  std::vector<double> x;
  std::vector<double> y;
  std::size_t size() const { return this->x.size(); }
  void resize(std::size_t n)
  {
    this->x.resize(n);
    this->y.resize(n);
  }
};

/// Compact cells of the unit disc, rings cut into sectors, whose shares of the energy are
/// proportional to the rays they hold: for odd N the last cell, at the rim, is 3/2 as large as the
/// others. So every ray carries Qs/N and the estimate has no bias for any N. Made once per N; the
/// profile enters when a share becomes a radius.
class StrataPartition
{
public:
  struct Cell
  {
    double v0, v1;     ///< range of the cumulative radial share
    double phi0, phi1; ///< rad
  };
  /// @param numberOfRays N >= 1; the cells hold 2 rays each, the last 3 if N is odd (N = 1: one
  /// cell, one ray)
  explicit StrataPartition(std::size_t numberOfRays);
  const std::vector<Cell>& cells() const { return this->Cells; }
  std::size_t numberOfRays() const { return this->NumberOfRays; }
  /// Cell of ray n, and how many rays that cell holds.
  std::size_t cellOfRay(std::size_t n) const;
  std::size_t raysInCell(std::size_t cell) const;

  /// The cell of every ray, in lanes.
  struct RayCells
  {
    std::vector<double> v0, dv;        ///< beginning and length of the cumulative radial share
    std::vector<double> turn0, dturns; ///< beginning and length of the angle, full turns
  };
  const RayCells& rayCells() const { return this->Lanes; }

private:
  std::size_t NumberOfRays;
  std::vector<Cell> Cells;
  RayCells Lanes;
};

/// How rays of a disc are distributed along its radius.
struct RadialProfile
{
  double halfBeamwidth; ///< rad
  BeamProfile profile = BeamProfile::Uniform;
  double truncation = 1.0; ///< k of a Gaussian one
};

/// Density of the rays at a place of the beam's plane, over its mean, per solid angle: 1 in a
/// uniform beam; 2 k^2 e^(-2 k^2 u)/(1 - e^(-2 k^2)) in a Gaussian one, u the share of the solid
/// angle nearer the axis.
/// @param radius2 x^2 + y^2, in [0, 1]
double rayDensity(const RadialProfile& profile, double radius2);

/// Draw the rays of beam `beam`, in loops over lanes: about 3 ns a ray. `strata` is used (and must
/// fit `numberOfRays`) for Sampling::Stratified only. Accurate for half-beamwidths from 1e-9 rad to
/// pi/3. Deterministic in (seed, beam, ray).
void sampleBeam(std::int32_t seed, std::uint64_t beam, std::size_t numberOfRays,
  const RadialProfile& profile, Sampling sampling, const StrataPartition* strata, BeamRays& rays);

/// Draw the rays of one of `patterns` (a power of 2) patterns. In each, a ray may lie anywhere in
/// its cell. Over all of them it comes once into each of `patterns` parts of its cell's range of
/// radii, so that means over many beams have next to no error of the patterns.
void samplePattern(std::int32_t seed, std::size_t pattern, std::size_t patterns,
  const RadialProfile& profile, const StrataPartition& strata, BeamRays& rays);

/// The rays of a pattern turned about the axis, by a share of a full turn. About 0.3 ns a ray.
void turnRays(const BeamRays& pattern, double turns, BeamRays& rays);
}

#endif
