// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Prisms.h
 * @brief Rotating wedge prisms (Risley prisms), which steer the beams of a lidar.
 *
 * Prisms stand one behind the other on an axis and turn about it, each at its own rate. Directions
 * repeat after the least common multiple of the periods of rotation, if there is one.
 *
 * A prism has a face perpendicular to the axis and a face inclined by the wedge angle. Light leaves
 * through the inclined face if the wedge angle is above 0, and enters through this face if the
 * wedge angle is below 0. Snell's law in vector form gives the direction d' behind a face from the
 * direction d before the face (a unit vector), the face's unit normal m along the light (d m > 0)
 * and the ratio r of the refractive index before the face to the index behind it:
 *
 *     d' = r d + (sqrt(1 - r^2 (1 - (d m)^2)) - r d m) m.
 *
 * If the root is imaginary, no light passes.
 *
 * The frame of the axis has x to the right, y along the axis and z up. At the phase 0 a prism
 * deflects light upwards. The phase grows clockwise as seen from the sensor, from up to right.
 *
 * Source: Snell's law; Marshall, Proc. SPIE 3787, 1999, for the rose curve that two thin prisms
 * draw.
 * Differs: from Brazeal et al., Sensors 21, 4722 (2021), in that all prisms stand exactly on the
 * axis and have exact angles.
 * Valid: all beams start at the sensor's position, some millimetres beside the last prism. Prisms
 * stand in air of the index 1. Phases are rounded to 1e-16 of the turns since time 0.
 * Test: TestPrisms.cxx.
 */
#ifndef avianlidar_Prisms_h
#define avianlidar_Prisms_h

#include "Vector.h"

#include <string>
#include <vector>

namespace avianlidar
{
/// Prisms in the order in which light passes them. Each vector has one value per prism.
struct PrismTrain
{
  std::vector<double> wedgeAngles;       ///< angles between the two faces, deg, -60 to 60
  std::vector<double> refractiveIndices; ///< refractive indices, 1 to 4 (germanium)
  std::vector<double> rotationRates;     ///< rotation rates, Hz, -1e6 to 1e6; above 0: clockwise
  std::vector<double> phases;            ///< phases at time 0, deg; empty: all 0
  double axisElevation = 0.0;            ///< elevation of the axis, deg, -90 to 90
  /// Rotation rate of axis and prisms about the vertical, Hz; above 0: clockwise from above.
  double axisRotationRate = 0.0;
  /// Rotation rate of lasers about the axis, Hz; below a turning mirror, minus the axis' rate.
  double laserRotationRate = 0.0;

  bool none() const { return this->wedgeAngles.empty(); }
};

/// The first bad value in words ("PrismWedgeAngles is 70, expected ..."), or an empty string. Light
/// must pass through the prisms for all combinations of the prisms' phases in steps of 30 degrees.
/// @param enters directions of the lasers at time 0, unit vectors in the frame of the axis
std::string checkPrisms(const PrismTrain& train, const std::vector<Vec3>& enters);

/// Direction of light behind the prisms, in the sensor's frame. Throws std::runtime_error if no
/// light passes. Start and time are separate, because their sum would round the time.
/// @param start start of the scan, s since time 0 @param time time since the start, s @param enters
/// direction of the laser at time 0, unit vector in the frame of the axis
Vec3 steer(const PrismTrain& train, double start, double time, const Vec3& enters);
}

#endif
