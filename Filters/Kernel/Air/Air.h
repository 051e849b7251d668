// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Air.h
 * @brief The air of a scene: clear air, haze, fog, rain, snow and foliage, by extinction and
 * backscatter.
 *
 * Air is a list of media, and the attenuation coefficient of the clear air between them. A medium
 * weakens light by its extinction mu, and sends back mu/S of it per metre and steradian, S its
 * extinction-to-backscatter ratio. It fills the scene, or a volume (MediumVolume.h). Along a beam
 * BeamAir.h follows it.
 *
 * Droplets of fog are so many that their number does not matter. Drops of rain are few: their
 * diameters are exponential, N(D) = N0 exp(-Lambda D), N0 = 8000/(m3 mm), Lambda = 4.1 R^-0.21/mm,
 * R the rain rate in mm/h, and each takes twice its area from the beam. Half of that is diffracted
 * into about lambda/D, and most of it stays in the view of a lidar (keptInView()): it is not lost.
 * Leaves of a tree are few, too, and of one size, Lambertian, facing all ways. Drops are others in
 * each scan, leaves as far as the wind moves them.
 *
 * Coefficients are in 1/m everywhere (the paper's 0.088 and 0.035 have no unit; here they are read
 * as 1/km).
 *
 * Source: paper, Sec. 2.3, Eq. 9; of a visibility: P. W. Kruse et al., Elements of Infrared
 * Technology (1962), with the exponents of I. I. Kim et al., Proc. SPIE 4214 (2001); J. S. Marshall
 * and W. McK. Palmer, The Distribution of Raindrops with Size, Journal of Meteorology 5, 1948;
 * geometric optics; of the diffracted light M. Born and E. Wolf, Principles of Optics, Sec. 8.5.2
 * (Airy's pattern).
 * Differs: the paper's air only attenuates.
 * Valid: single scattering, besides light that is diffracted and stays in view. Where a
 * transmission underflows it is 0.
 * Test: TestAir.cxx.
 */
#ifndef avianlidar_Air_h
#define avianlidar_Air_h

#include "MediumVolume.h"
#include "Sensor.h"

#include <cmath>
#include <string>
#include <vector>

namespace avianlidar
{
/// Share of the energy that is left after `length` metres of air: exp(-mu l) (paper, Eq. 9).
/// @param attenuation 1/m, >= 0 @param length m, >= 0, the whole way (a direct echo travels 2 r). 0
/// where it underflows.
inline double transmission(double attenuation, double length)
{
  // 0 * infinity is no length of air at all.
  return attenuation > 0.0 ? std::exp(-attenuation * length) : 1.0;
}

/// Visibility of clear air, m, for which makers' ranges are taken to hold (assumed).
constexpr double ClearVisibility = 23e3;

/// Attenuation coefficient of haze, 1/m. @param visibility at 550 nm, m, above 0
/// @param wavelength m
double attenuationOfVisibility(double visibility, double wavelength);

struct Medium
{
  double extinction = 0.0;       ///< mu, 1/m, 0 to 1e30: light that the lidar loses
  double backscatterRatio = 1.0; ///< S, sr, 1e-3 to 1e9: of that extinction
  double drops = 0.0;            ///< or leaves, 1/m^3; 0: beyond number
  /// Mean square of a drop's energy over the square of its mean: SquareOfDrops, or SquareOfLeaves.
  double squareOfDrops = 6.0;
  double renewed = 1.0;   ///< share of the drops that are others in the next scan, 0 to 1
  bool isFollowed = true; ///< by a threshold that follows the air; trees are not
  int objectId = -2;      ///< label of its echoes; ObjectOfAir for air
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

/// A medium, and where it is. Without a volume of its own it fills the scene.
struct PlacedMedium
{
  Medium medium;
  MediumVolume volume;

  bool fillsScene() const { return this->volume.shape == MediumShape::Everywhere; }
};

/// Attenuation coefficient, 1/m, of clear air and of all media that fill the scene. @param clear
/// 1/m
double attenuationOf(double clear, const std::vector<PlacedMedium>& media);

struct Air
{
  double clear = 0.0;              ///< attenuation coefficient of the clear air, 1/m
  std::vector<PlacedMedium> media; ///< the clear air's extinction is not in theirs
};

/// Whether some media do not fill the scene.
bool haveVolumes(const std::vector<PlacedMedium>& media);

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

/// The view of a sensor. A beam that is not round has the half angle of a round one of its solid
/// angle.
LidarView viewOf(const Sensor& sensor);

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
