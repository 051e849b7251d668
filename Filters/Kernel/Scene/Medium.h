// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Medium.h
 * @brief Air that scatters light back: what fills it, by extinction and backscatter.
 *
 * A medium weakens light by its extinction mu, and sends back mu/S of it per metre and steradian, S
 * its extinction-to-backscatter ratio. Droplets of fog are so many that their number does not
 * matter. Drops of rain are few: their diameters are exponential, N(D) = N0 exp(-Lambda D), N0 =
 * 8000/(m3 mm), Lambda = 4.1 R^-0.21/mm, R the rain rate in mm/h, and each takes twice its area
 * from the beam. Half of that is diffracted into about lambda/D, and most of it stays in the view
 * of a lidar (keptInView()): it is not lost. Leaves of a tree are few, too, and of one size,
 * Lambertian, facing all ways. Drops are others in each scan, leaves as far as the wind moves them.
 *
 * Source: J. S. Marshall and W. McK. Palmer, The Distribution of Raindrops with Size, Journal of
 * Meteorology 5, 1948; geometric optics; of the diffracted light M. Born and E. Wolf, Principles of
 * Optics, Sec. 8.5.2 (Airy's pattern).
 * Differs: the paper's air only attenuates.
 * Valid: single scattering, besides light that is diffracted and stays in view. Where a medium is:
 * MediumVolume.h.
 * Test: TestAirEcho.cxx.
 */
#ifndef avianlidar_Medium_h
#define avianlidar_Medium_h

#include <string>

namespace avianlidar
{
struct Medium
{
  double extinction = 0.0;       ///< mu, 1/m, 0 to 1e30: light that the lidar loses
  double backscatterRatio = 1.0; ///< S, sr, 1e-3 to 1e9: of that extinction
  double drops = 0.0;            ///< or leaves, 1/m^3; 0: beyond number
  /// Mean square of a drop's energy over the square of its mean: SquareOfDrops, or SquareOfLeaves.
  double squareOfDrops = 6.0;
  double renewed = 1.0;   ///< share of the drops that are others in the next scan, 0 to 1
  bool isFollowed = true; ///< by a threshold that follows the air; trees are not
  int objectId = -2;      ///< of what it returns, ObjectOfAir for air
  /// Drops are leaves: light comes back through the gaps that let it in, as far as its two ways lie
  /// nearer to each other than a leaf is wide (BeamAir.h). Without a number of drops they always
  /// do.
  bool sharesGaps = false;

  /// mu/S, 1/(m sr).
  double backscatter() const { return this->extinction / this->backscatterRatio; }
};

/// E[D^4]/E[D^2]^2 of exponential diameters.
constexpr double SquareOfDrops = 6.0;

/// The same of Lambertian leaves that face all ways: E[cos^4]/E[cos^2]^2.
constexpr double SquareOfLeaves = 1.8;

/// What a lidar sees of light that drops turn by a small angle.
struct LidarView
{
  double wavelength = 905e-9; ///< m, above 0
  double halfAngle = 0.0;     ///< rad; at 0 no diffracted light stays in view
};

inline bool operator==(const LidarView& a, const LidarView& b)
{
  return a.wavelength == b.wavelength && a.halfAngle == b.halfAngle;
}

/// Share of the light that drops on the way to a target and back diffract which stays in view.
/// Drops at a share 1 - u of the way move it at the target by u of the angle, so it is the mean
/// over u of the energy that Airy's pattern has within halfAngle/u, weighted with the areas of the
/// drops. Within 6e-4. @param slope Lambda of exponential diameters, 1/m
double keptInView(const LidarView& view, double slope);

/// Rain of so many mm/h, above 0. @param backscatterRatio sr, of twice the area of the drops @param
/// perVolume N0, 1/(m^3 mm) @param fall Lambda at 1 mm/h, 1/mm
Medium rainOf(double rate, double backscatterRatio, const LidarView& view,
  double perVolume = 8000.0, double fall = 4.1);

/// Largest rain rate, mm/h; the law of Marshall and Palmer is from rates up to 23.
constexpr double MaximumRainRate = 500.0;

/// Empty, or a sentence that names the value and what was expected.
std::string checkMedium(const Medium& medium);
}

#endif
