// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Air.h
 * @brief The air of a scene: clear air, haze, fog, rain, snow and foliage, described by extinction
 * and backscatter.
 *
 * Air consists of a list of media and the attenuation coefficient of the clear air between the
 * media. A medium with the extinction mu and the extinction-to-backscatter ratio S has the
 * backscatter mu/S per metre and steradian. A medium fills the scene or a volume (MediumVolume.h).
 * BeamAir.h follows the air along a beam.
 *
 * Fog has so many droplets that their number does not matter. Raindrops are few, so their number in
 * a range unit varies. The diameters D of raindrops are exponentially distributed, N(D) = N0
 * exp(-Lambda D), with N0 = 8000/(m3 mm), Lambda = 4.1 R^-0.21/mm and the rain rate R in mm/h. Each
 * drop removes the light on twice its area from the beam. Half of this light is diffracted into an
 * angle of about lambda/D, with the wavelength lambda. Most of the diffracted light remains in the
 * field of view of a lidar and is not lost (keptInView()). Light also comes straight back from the
 * front and from the rear of a drop. Water absorbs the light from the rear (DropLight). The number
 * of leaves in a range unit varies, too. All leaves are Lambertian and of one size, with random
 * orientations. All drops, and the share of the leaves that the wind moves, are drawn anew in each
 * scan.
 *
 * Coefficients are in 1/m everywhere. The paper's coefficients 0.088 and 0.035 have no unit and are
 * read as 1/km.
 *
 * Source: paper, Sec. 2.3, Eq. 9; for haze P. W. Kruse et al., Elements of Infrared Technology
 * (1962), with the exponents of I. I. Kim et al., Proc. SPIE 4214 (2001); for rain J. S. Marshall
 * and W. McK. Palmer, The Distribution of Raindrops with Size, Journal of Meteorology 5, 1948, and
 * geometric optics; for diffraction M. Born and E. Wolf, Principles of Optics, Sec. 8.5.2 (Airy's
 * pattern); for light from the rear of drops a fit to Mie's theory (Filters/Media/media.json).
 * Differs: the paper's air only attenuates.
 * Valid: single scattering, except for diffracted light that remains in view. A transmission that
 * underflows is 0.
 * Test: TestAir.cxx.
 */
#ifndef avianlidar_Air_h
#define avianlidar_Air_h

#include "MediumVolume.h"
#include "Sensor.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace avianlidar
{
/// Transmission of `length` metres of air: exp(-mu l) (paper, Eq. 9), 0 where exp(-mu l)
/// underflows. @param attenuation coefficient mu, 1/m, >= 0 @param length length l of the whole
/// way, m, >= 0 (2 r for a direct echo)
inline double transmission(double attenuation, double length)
{
  // Air without attenuation transmits all light, also over an infinite length (0 * infinity is
  // NaN).
  return attenuation > 0.0 ? std::exp(-attenuation * length) : 1.0;
}

/// Visibility of clear air, m, at which data sheets are assumed to give their ranges.
constexpr double ClearVisibility = 23e3;

/// Attenuation coefficient of haze, 1/m. @param visibility visibility at 550 nm, m, above 0
/// @param wavelength wavelength of the light, m
double attenuationOfVisibility(double visibility, double wavelength);

/// Light that drops send straight back, as a sum of terms. A drop of the diameter D and the
/// cross-section A has the differential cross-section A/(4 pi) efficiency exp(-loss D) of each
/// term.
struct DropLight
{
  struct Term
  {
    double efficiency; ///< backscatter efficiency of small drops
    double loss;       ///< 1/m; in Medium, per mean diameter
  };
  std::array<Term, 3> terms;

  /// Drops of which none absorbs light. @param ratio twice the drops' areas divided by their
  /// backscatter, sr
  DropLight(double ratio)
    : terms{ { { 8.0 * Pi / ratio, 0.0 } } }
  {
  }

  /// Drops of a liquid. Their fronts reflect light by Fresnel's law. @param index refractive index
  /// @param absorption absorption coefficient, 1/m @param rear terms of the light that crosses the
  /// drop, with `loss` as the length of the way inside, in diameters
  DropLight(double index, double absorption, const std::array<Term, 2>& rear);

  /// Sum over the terms for a drop. @param diameter in the inverse unit of the losses
  double efficiencyOf(double diameter) const
  {
    double sum = 0.0;
    for (const Term& term : this->terms)
    {
      sum += term.loss > 0.0 ? term.efficiency * std::exp(-term.loss * diameter) : term.efficiency;
    }
    return sum;
  }
};

/// Optical properties of a medium.
struct Medium
{
  /// mu, extinction coefficient without diffracted light that remains in view, 1/m, 0 to 1e30.
  double extinction = 0.0;
  double backscatterRatio = 1.0; ///< S, ratio of extinction to backscatter, sr, 1e-3 to 1e9
  double drops = 0.0; ///< number density of drops or leaves, 1/m^3, 0 to 1e12; 0: too many to count
  /// Mean square of a drop's energy divided by the squared mean of this energy: SquareOfDrops or
  /// SquareOfLeaves.
  double squareOfDrops = 6.0;
  double renewed = 1.0;   ///< share of the drops that are drawn anew in each scan, 0 to 1
  bool isFollowed = true; ///< true if a threshold may follow the medium's light; false for trees
  int objectId = -2;      ///< object id of the medium's echoes; ObjectOfAir for air
  /// True if drops are leaves. Light comes back through the gap through which it went out, if its
  /// ways out and back are less than the width of a leaf apart (BeamAir.h). If `drops` is 0, light
  /// always comes back through the gap through which it went out.
  bool sharesGaps = false;
  /// Light of drops by diameter, for diameters in mean diameters, scaled so that a drop's mean
  /// energy is 1.
  DropLight light{ 8.0 * Pi };

  /// Backscatter coefficient mu/S, 1/(m sr).
  double backscatter() const { return this->extinction / this->backscatterRatio; }
};

/// Ratio E[D^4]/E[D^2]^2 of exponentially distributed diameters D, for drops that absorb no light.
constexpr double SquareOfDrops = 6.0;

/// Ratio E[cos^4]/E[cos^2]^2 of Lambertian leaves with random orientations.
constexpr double SquareOfLeaves = 1.8;

/// A medium and its volume. By default the medium fills the scene.
struct PlacedMedium
{
  Medium medium;
  MediumVolume volume;

  bool fillsScene() const { return this->volume.shape == MediumShape::Everywhere; }
};

/// Attenuation coefficient, 1/m, of the clear air together with all media that fill the scene.
/// @param clear attenuation coefficient of the clear air, 1/m
double attenuationOf(double clear, const std::vector<PlacedMedium>& media);

struct Air
{
  double clear = 0.0;              ///< attenuation coefficient of the clear air, 1/m
  std::vector<PlacedMedium> media; ///< media, with extinctions that exclude the clear air
};

/// True if at least one medium does not fill the scene.
bool haveVolumes(const std::vector<PlacedMedium>& media);

/// Field of view of a lidar, for light that drops diffract by a small angle.
struct LidarView
{
  double wavelength = 905e-9; ///< wavelength of the light, m, above 0
  double halfAngle = 0.0;     ///< half angle of the field of view, rad; 0: diffracted light is lost
  double across = 0.0;        ///< half angle across `halfAngle`, rad; 0: a round field of view
  bool isRectangle = false;   ///< outline of a field of view that is not round

  bool operator==(const LidarView& other) const
  {
    return this->wavelength == other.wavelength && this->halfAngle == other.halfAngle &&
      this->across == other.across && this->isRectangle == other.isRectangle;
  }
};

/// Field of view of a sensor, which is the sensor's beam.
LidarView viewOf(const Sensor& sensor);

/// Share of the diffracted light that remains in view on the way to a target and back. If light is
/// diffracted after 1 - u of the way, its shift at the target, as seen from the lidar, is u times
/// the angle of diffraction. So the share in view is the mean over u of the energy of Airy's
/// pattern within the field of view divided by u, weighted with the areas of the drops. The error
/// of the share is below 6e-4. @param slope Lambda of exponentially distributed diameters, 1/m
double keptInView(const LidarView& view, double slope);

/// Rain. @param rate rain rate, mm/h, above 0 @param perVolume N0, 1/(m^3 mm) @param fall Lambda at
/// 1 mm/h, 1/mm
Medium rainOf(double rate, const DropLight& light, const LidarView& view, double perVolume = 8000.0,
  double fall = 4.1);

/// Largest rain rate, mm/h. The law of Marshall and Palmer comes from rates up to 23 mm/h.
constexpr double MaximumRainRate = 500.0;

/// Error that names the bad value and the expected range, or an empty text.
std::string checkMedium(const Medium& medium);
}

#endif
