// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Reflectance.h
 * @brief Share of a ray's energy that a surface sends into a given direction (paper, Sec. 2.2, Eq.
 * 4-8).
 *
 * All models keep the paper's radiometry: f has no 1/pi and no solid angle, and its specular lobe
 * peaks at ks. With delta the angle between the outgoing direction and the mirror direction of the
 * incident one (monostatic: delta = 2 theta_i), cosines cut off at 0 before they are raised to a
 * power:
 *
 * - LambertBlinnPhong (paper, Eq. 5-8, in three dimensions): f_d = kd cos theta_i, f_s = ks cos^kp
 * delta, and f_s = 0 for cos delta <= 0, also at kp = 0. The paper's max{0, cos^kp} taken literally
 * has a false glint at grazing incidence for even kp. The lobe of Phong (CACM 18(6), 1975) is the
 * same.
 * - Phong: the modified, reciprocal Phong model of Lafortune and Willems (report CW197, K.U.
 * Leuven, 1994), scaled to the same peak: f_d = kd cos theta_i, f_s = ks cos^kp delta cos theta_i.
 * - Microfacet: Cook and Torrance (ACM TOG 1(1), 1982) with the distribution and the
 * height-correlated masking of Trowbridge-Reitz/GGX (Walter et al., EGSR 2007; Heitz, JCGT 3(2),
 * 2014) and Schlick's Fresnel term (1994). With h the half vector, theta_h its angle to the normal,
 * theta_d its angle to either direction, and s = (1 - cos theta_d)^5: f_d = kd (1 - s) cos theta_i,
 * f_s = (ks + kd s) [a^2/(a^2 cos^2 theta_h + sin^2 theta_h)]^2 G, a^2 = 1/(2 kp + 1) (a Blinn
 * exponent of 4 kp in a^2 = 2/(exponent + 2)), G = 2 ci co/(co A(ci) + ci A(co)), A(c) = sqrt(a^2 +
 * (1 - a^2) c^2). The Fresnel term tends to kd + ks, the whole reflectance of the material, and
 * takes from the diffuse component what it gives to the lobe. The factor 1/(4 cos theta_o) of the
 * distribution is left out as Eq. 7 leaves it out.
 *
 * In every model 0 <= f_d <= kd, f_s >= 0 and f_d + f_s <= kd + ks. Stable for kp from 0 to 1e6.
 */
#ifndef avianlidar_Reflectance_h
#define avianlidar_Reflectance_h

#include "LaneMath.h"
#include "Vector.h"

#include <string>

namespace avianlidar
{
/// Coefficients of a surface; the defaults are the paper's wall (Table 1).
struct Material
{
  double kd = 0.146; ///< diffuse, >= 0
  double ks = 0.054; ///< specular, >= 0, kd + ks <= 1
  double kp = 112.0; ///< glossiness, in [0, 1e6]
};

constexpr double MaximumGlossiness = 1e6;

/// Empty if the material is usable; otherwise a sentence that names the value and what was
/// expected. A sum kd + ks that exceeds 1 by less than 1e-12 passes: it is a rounded 1.
std::string checkMaterial(const Material& material);

enum class ReflectanceModel
{
  LambertBlinnPhong = 0,
  Phong = 1,
  Microfacet = 2
};

/// The angles at one reflection; cosines are not cut off.
struct ReflectionGeometry
{
  double cosIncidence = 1.0;  ///< between the reversed incident direction and the normal
  double cosOutgoing = 1.0;   ///< between the outgoing direction and the normal
  double cosLobe = 1.0;       ///< cos delta
  double sin2Lobe = 0.0;      ///< sin^2 delta, accurate for small delta
  double sin2Half = 0.0;      ///< sin^2 theta_h
  double cosDifference = 1.0; ///< cos theta_d
};

/// @param incident unit, travelling towards the surface @param outgoing unit, away from it
/// @param normal unit, on the side of the incident ray's origin
ReflectionGeometry reflectionGeometry(
  const Vec3& incident, const Vec3& outgoing, const Vec3& normal);

/// Back to where the ray came from: outgoing = -incident, delta = 2 theta_i.
ReflectionGeometry monostaticGeometry(const Vec3& incident, const Vec3& normal);

/// The same from the cosine alone; relative error of f below 1e-9 at kp = 1e6.
ReflectionGeometry monostaticGeometry(double cosIncidence);

/// Into the mirror direction of the incident ray: delta = 0.
ReflectionGeometry mirrorGeometry(double cosIncidence);

/// The two components of f_sur (paper, Eq. 5).
struct Reflectance
{
  double diffuse = 0.0;  ///< f_d
  double specular = 0.0; ///< f_s
  double total() const { return this->diffuse + this->specular; }
};

/// Mirror direction of the incident ray, unit for unit arguments.
Vec3 mirrorDirection(const Vec3& incident, const Vec3& normal);

/// f_d and f_s of `material` (which must have passed checkMaterial).
Reflectance reflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry);

/// f_d alone.
double diffuseReflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry);

/// f_s alone.
double specularReflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry);

/// The largest f_d and f_s over all outgoing directions at this incidence (upper bounds; each on
/// its own).
Reflectance reflectanceBound(ReflectanceModel model, const Material& material, double cosIncidence);

/// cos^exponent of the angle whose cosine and squared sine are given: 0 for cosine <= 0, also at
/// exponent 0.
double lobe(double cosine, double sineSquared, double exponent);

namespace lanes
{
/// avianlidar::lobe() for a loop over lanes; the same but for last bits.
AVIANLIDAR_ALWAYS_INLINE double lobe(double cosine, double sineSquared, double exponent)
{
  // ln cos^2: where the angle is small, from its sine.
  const bool small = cosine > 0.7;
  const bool lit = cosine > 0.0;
  const double square = lit ? cosine * cosine : 1.0;
  const double fromSine = 1.0 - sineSquared;
  const double y = small ? fromSine : square;
  const double correction = small ? (1.0 - fromSine) - sineSquared : 0.0;
  const double value = exp(0.5 * exponent * logOf(y, correction));
  return lit ? value : 0.0;
}
}

/**
 * f as taken up by a receiver of aperture `aperture` (m^2) at distance `distance` (m): f_d A/(pi
 * r^2) and f_s (kp + 1) A/(2 pi r^2), both scaled by one factor so that their total does not
 * exceed 1. Aperture 0 is the paper's radiometry: f unchanged. Distance 0 with an aperture: the
 * cap.
 */
Reflectance throughAperture(const Reflectance& f, double kp, double aperture, double distance);
}

#endif
