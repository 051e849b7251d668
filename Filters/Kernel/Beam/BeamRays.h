// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamRays.h
 * @brief Sampling of the beam: N rays of equal energy Qs/N, independent or stratified.
 *
 * Source: paper, Sec. 2.1, Eq. 1-3; cells after Beckers and Beckers, Computational Geometry 45(7),
 * 2012.
 * Differs: stratified rays and the Gaussian profile are added. BeamShape.h describes beams that are
 * not round. A ray's radius comes from sin^2(theta/2), not from 1 - cos theta, with theta the angle
 * between ray and axis.
 * Valid: half-beamwidths from 1e-9 rad to pi/3. In this range radii are exact to a few units of
 * round-off. A sum of energies over the rays is unbiased for any N.
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
  MonteCarlo = 0, ///< N independent rays, as in the paper
  Stratified = 1  ///< two independent rays in each of N/2 compact cells (StrataPartition)
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

/// Compact cells of the unit disc: rings cut into sectors. The energy of a cell is proportional to
/// the number of the cell's rays. For odd N the last cell, at the rim, has 3/2 of the energy of any
/// other cell. Every ray has the energy Qs/N, so a sum of energies over the rays is unbiased for
/// any N. The cells depend only on N. The profile is applied when shares of the energy are
/// converted to radii.
class StrataPartition
{
public:
  struct Cell
  {
    double v0, v1;     ///< inner and outer radius, as shares of the energy within the radius
    double phi0, phi1; ///< range of the angle about the axis, rad
  };
  /// @param numberOfRays N, at least 1. Each cell has 2 rays. For odd N the last cell has 3 rays,
  /// or 1 ray if N = 1.
  explicit StrataPartition(std::size_t numberOfRays);
  const std::vector<Cell>& cells() const { return this->Cells; }
  std::size_t numberOfRays() const { return this->NumberOfRays; }
  /// Cell in which ray n lies, and number of rays in a cell.
  std::size_t cellOfRay(std::size_t n) const;
  std::size_t raysInCell(std::size_t cell) const;

  /// The cell of every ray, structure of arrays.
  struct RayCells
  {
    std::vector<double> v0, dv;        ///< Cell::v0, and length of the range from v0 to v1
    std::vector<double> turn0, dturns; ///< begin and length of the range of the angle, turns
  };
  const RayCells& rayCells() const { return this->Lanes; }

private:
  std::size_t NumberOfRays;
  std::vector<Cell> Cells;
  RayCells Lanes;
};

/// Distribution of the rays along the radius of the disc.
struct RadialProfile
{
  double halfBeamwidth; ///< half-beamwidth, rad
  BeamProfile profile = BeamProfile::Uniform;
  double truncation = 1.0; ///< truncation k of a Gaussian profile (Sensor.h)
};

/// Density of the rays per solid angle at a point of the beam's plane, divided by the mean density:
/// 1 in a uniform beam, and 2 k^2 e^(-2 k^2 u)/(1 - e^(-2 k^2)) in a Gaussian beam, where u is the
/// share of the solid angle that lies nearer to the axis than the point.
/// @param radius2 x^2 + y^2, in [0, 1]
double rayDensity(const RadialProfile& profile, double radius2);

/// Draws the rays of a beam, in about 3 ns per ray. The random numbers of a ray depend only on the
/// seed and on the numbers of beam and ray.
/// @param strata strata of numberOfRays rays; may be null for Sampling::MonteCarlo, which has no
/// strata
void sampleBeam(std::int32_t seed, std::uint64_t beam, std::size_t numberOfRays,
  const RadialProfile& profile, Sampling sampling, const StrataPartition* strata, BeamRays& rays);

/// Draws the rays of pattern number `pattern`. The number `patterns` of patterns is a power of 2.
/// In a single pattern, a ray may lie anywhere in its cell. Over all patterns the ray lies once in
/// each of `patterns` parts of its cell's range of radii. The patterns therefore add almost no
/// error to means over many beams.
void samplePattern(std::int32_t seed, std::size_t pattern, std::size_t patterns,
  const RadialProfile& profile, const StrataPartition& strata, BeamRays& rays);

/// Turns the rays of a pattern about the axis by a share of a full turn, in about 0.3 ns per ray.
void turnRays(const BeamRays& pattern, double turns, BeamRays& rays);
}

#endif
