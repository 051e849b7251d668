// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Prisms.h
 * @brief Rotating wedge prisms (Risley prisms), which steer the beams of a lidar.
 *
 * Prisms stand one behind the other on an axis and turn about it, each at a rate of its own. Where
 * the rates have no small common multiple, directions repeat late or never.
 *
 * A prism has a face perpendicular to the axis and one that is inclined by the wedge angle. With a
 * wedge angle above 0 light leaves by the inclined face, below 0 it enters by it. A beam is
 * refracted at every face by Snell's law in vector form: of the unit vector d and the face's unit
 * normal m along the light (d m > 0) with the ratio r of the index before to the index behind,
 *
 *     d' = r d + (sqrt(1 - r^2 (1 - (d m)^2)) - r d m) m,
 *
 * and where the root is imaginary, no light passes.
 *
 * The frame is x right, y along the axis, z up. At the phase 0 a prism deflects up; the phase grows
 * clockwise as the sensor sees it, from up to right.
 *
 * Source: Snell's law; thin prisms deflect by (n - 1) times the wedge angle, so that two of them
 * draw a rose curve (Marshall, Proc. SPIE 3787, 1999).
 * Differs: from Brazeal et al., Sensors 21, 4722 (2021), in that all prisms stand exactly on the
 * axis, and none is off its angle.
 * Valid: where a beam leaves the last prism is not modelled (some millimetres beside the axis): all
 * beams start at the sensor's position. Prisms stand in air of the refractive index 1. The phase is
 * rounded to 1e-16 of the turns since time 0.
 * Test: TestPrisms.cxx.
 */
#ifndef avianlidar_Prisms_h
#define avianlidar_Prisms_h

#include "Vector.h"

#include <string>
#include <vector>

namespace avianlidar
{
/// Numbers of the prisms, in the order in which light passes them; one of each per prism, of the
/// phases also none.
struct PrismTrain
{
  std::vector<double> wedgeAngles;       ///< deg, -60 to 60
  std::vector<double> refractiveIndices; ///< 1 to 4, that of germanium
  std::vector<double> rotationRates;     ///< Hz, -1e6 to 1e6; above 0 clockwise
  std::vector<double> phases;            ///< deg, at time 0; none: all 0
  double axisElevation = 0.0;            ///< deg, -90 to 90, of the axis
  double axisRotationRate = 0.0; ///< Hz, about the vertical, clockwise from above; prisms and all

  bool none() const { return this->wedgeAngles.empty(); }
};

/// The first bad value in words ("PrismWedgeAngles is 70, expected ..."), or an empty string.
/// @param enters unit vectors of the lasers, in the frame of the axis: whether their light passes
/// is looked for at phases 30 degrees apart
std::string checkPrisms(const PrismTrain& train, const std::vector<Vec3>& enters);

/// Where light of a direction in the frame of the axis leaves, in the sensor's frame. @param start
/// of the scan, s since time 0 @param time s since the start. Throws std::runtime_error where no
/// light passes. Start and time are apart, so that times of a scan keep their digits.
Vec3 steer(const PrismTrain& train, double start, double time, const Vec3& enters);
}

#endif
