// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamShape.h
 * @brief Outline and profile of the sensor's beams in the coordinates of their plane (BeamFrame.h).
 *
 * An ellipse is the unit disc there, a rectangle the square whose corners lie on its rim; the axis
 * of x is the one along which the beam is wider. A round beam is uniform in solid angle, or falls
 * with it. One that is not round is narrow: its energy is uniform over the plane, or falls with the
 * squared distance from the axis, in half-beamwidths: exp(-2 k^2 (x^2 + y^2)), for a rectangle with
 * x and y from -1 to 1.
 *
 * Source: none.
 * Valid: any sensor that checkSensor() accepts. At 0.1 rad a beam uniform over its plane is 1.5 %
 * brighter at its rim (3 % at the corners of a square), per solid angle, than one uniform in that.
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

  /// What frames of the beams are made of.
  const BeamWidth& width() const { return this->Width; }
  bool isRound() const { return this->Width.isRound; }

  /// Half the side of a rectangle, in the unit of the plane: the root of 1/2.
  static constexpr double HalfSide = 0.70710678118654752;

  /// Whether a point of the disc lies in the outline.
  template <class T>
  bool holds(T x, T y) const
  {
    return this->Width.isRectangle ? std::fabs(x) <= HalfSide && std::fabs(y) <= HalfSide
                                   : x * x + y * y <= 1;
  }

  /// Area of the outline.
  double area() const { return this->Width.isRectangle ? 2.0 : Pi; }

  /// Share of the pulse of a uniform profile for an area of the plane at the axis.
  double shareOfArea() const { return this->ShareOfArea; }

  /// Density of the energy over that of a uniform profile.
  double density(double x, double y) const
  {
    return this->isRound() ? rayDensity(this->Profile, x * x + y * y)
                           : this->PerMean * std::exp(-this->Fall * (x * x + y * y));
  }

  /// The largest density, or more.
  double mostDensity() const { return this->MostDensity; }

  /// What rays are drawn with.
  const RadialProfile& profile() const { return this->Profile; }

  /// Move rays of profile() into a rectangle, so that they have its profile; into other outlines
  /// they fit.
  void fit(BeamRays& rays) const;

private:
  BeamWidth Width;
  RadialProfile Profile;
  double ShareOfArea;
  double MostDensity;
  double Truncation = 0.0; ///< k of a Gaussian in a rectangle; 0: it is uniform
  double Fall = 0.0;       ///< of a Gaussian, over x^2 + y^2; 0: it is uniform
  double PerMean = 1.0;    ///< 1 over the mean of exp()
};
}

#endif
