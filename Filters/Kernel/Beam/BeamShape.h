// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamShape.h
 * @brief Outline and profile of the sensor's beams in the coordinates of their plane (BeamFrame.h).
 *
 * An elliptical beam fills the unit disc of the plane. A rectangular beam fills the square with its
 * corners on the rim of the disc. Beams are at least as wide along x as along y. Beams that are not
 * round have half-beamwidths of at most 0.1 rad. The energy of a round beam is uniform in solid
 * angle or Gaussian (rayDensity()). The energy of any other beam is uniform over the plane or
 * Gaussian, proportional to exp(-2 k^2 (x^2 + y^2)) with the truncation k and with x and y in
 * half-beamwidths. Across a rectangle, x and y go from -1 to 1.
 *
 * Source: none.
 * Valid: any sensor that checkSensor() accepts. At 0.1 rad, a beam that is uniform over its plane
 * is 1.5 % brighter at the rim (3 % at the corners of a square) than a beam that is uniform in
 * solid angle.
 * Test: TestBeamShape.cxx.
 */
#ifndef avianlidar_BeamShape_h
#define avianlidar_BeamShape_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "Sensor.h"

namespace avianlidar
{
class BeamShape
{
public:
  explicit BeamShape(const Sensor& sensor);

  /// Width from which the frames of the beams are made.
  const BeamWidth& width() const { return this->Width; }
  bool isRound() const { return this->Width.isRound; }

  /// Half the side of a rectangle, in the unit of the plane: the square root of 1/2.
  static constexpr double HalfSide = 0.70710678118654752;

  /// True if a point of the disc lies within the outline.
  template <class T>
  bool holds(T x, T y) const
  {
    return this->Width.isRectangle ? std::fabs(x) <= HalfSide && std::fabs(y) <= HalfSide
                                   : x * x + y * y <= 1;
  }

  /// Area of the outline, in the squared unit of the plane.
  double area() const { return this->Width.isRectangle ? 2.0 : Pi; }

  /// Share of the pulse per area of the plane at the axis, for a uniform profile.
  double shareOfArea() const { return this->ShareOfArea; }

  /// Density of the energy at a point, divided by the density of a uniform profile.
  double density(double x, double y) const
  {
    return this->isRound() ? rayDensity(this->Profile, x * x + y * y)
                           : this->PerMean * std::exp(-this->Fall * (x * x + y * y));
  }

  /// Upper bound of the density.
  double mostDensity() const { return this->MostDensity; }

  /// Profile from which the rays are drawn.
  const RadialProfile& profile() const { return this->Profile; }

  /// Moves rays that were drawn with profile() to the profile of a rectangle. Rays of any other
  /// outline do not change.
  void fit(BeamRays& rays) const;

private:
  BeamWidth Width;
  RadialProfile Profile;
  double ShareOfArea;
  double MostDensity;
  double Truncation = 0.0; ///< truncation k of a Gaussian profile in a rectangle; 0: uniform
  double Fall = 0.0;       ///< factor c of the Gaussian exp(-c (x^2 + y^2)); 0: uniform
  double PerMean = 1.0;    ///< inverse of the mean of the Gaussian over the outline
};
}

#endif
