// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Reflectance.h
 * @brief Share of a ray's energy that a surface sends into a given direction, by four models.
 *
 * All models keep the paper's radiometry: f has no 1/pi and no solid angle, and its specular lobe
 * peaks at ks. Let delta be the angle between the outgoing direction and the mirror direction of
 * the incident direction (monostatic: delta = 2 theta_i, with theta_i the angle of incidence).
 * Cosines are cut off at 0 before they are raised to a power.
 *
 * - LambertBlinnPhong: f_d = kd cos theta_i, f_s = ks cos^kp delta, and f_s = 0 for cos delta <= 0,
 *   also at kp = 0.
 * - Phong: f_d = kd cos theta_i, f_s = ks cos^kp delta cos theta_i.
 * - Microfacet: with h the half vector, theta_h its angle to the normal, theta_d its angle to
 *   either direction, and s = (1 - cos theta_d)^5: f_d = kd (1 - s) cos theta_i, f_s = (ks + kd s)
 *   [a^2/(a^2 cos^2 theta_h + sin^2 theta_h)]^2 G, a^2 = 1/(2 kp + 1) (a Blinn exponent of 4 kp in
 *   a^2 = 2/(exponent + 2)), G = 2 ci co/(co A(ci) + ci A(co)), ci = cos theta_i, co = cos theta_o,
 *   A(c) = sqrt(a^2 + (1 - a^2) c^2). The Fresnel term tends to kd + ks, the whole reflectance of
 *   the material, and reduces the diffuse component by as much as it adds to the lobe.
 * - OrenNayar: f_d = kd cos theta_i (A + B max(0, cos dphi) sin alpha tan beta), alpha the larger
 *   and beta the smaller of theta_i and the outgoing angle theta_o, dphi the angle between the two
 *   directions around the normal, A = 1 - s^2/(2 s^2 + 0.66), B = 0.45 s^2/(s^2 + 0.09), s the
 *   roughness; f_s as LambertBlinnPhong. Straight back, f_d = kd (A cos theta_i + B sin^2 theta_i):
 *   at grazing incidence a rough surface returns kd B, and a smooth surface returns no light.
 *
 * Each model is a type with inline functions of plain doubles, without branches. Single values and
 * loops over lanes use the same functions.
 *
 * Source: LambertBlinnPhong: paper, Sec. 2.2, Eq. 4-8; its lobe is Phong's (CACM 18(6),
 * 1975). Phong: the modified, reciprocal model of Lafortune and Willems (report CW197, K.U.
 * Leuven, 1994). Microfacet: Cook and Torrance (ACM TOG 1(1), 1982) with the distribution and the
 * height-correlated masking of Trowbridge-Reitz/GGX (Walter et al., EGSR 2007; Heitz, JCGT 3(2),
 * 2014) and Schlick's Fresnel term (1994). OrenNayar: Oren and Nayar, Generalization of Lambert's
 * reflectance model, SIGGRAPH '94, the qualitative model (their Eq. 30).
 * Differs: LambertBlinnPhong is in three dimensions. Taken literally, the paper's max{0, cos^kp}
 * has a false glint at grazing incidence for even kp. Phong is scaled to the paper's peak.
 * Microfacet leaves out the factor 1/(4 cos theta_o) of the distribution, as Eq. 7 does. OrenNayar
 * leaves out light that facets send to each other, as Eq. 30 of the source does.
 * Valid: kp from 0 to 1e6; roughness up to pi/2 (Oren and Nayar measured surfaces of up to 40
 * degrees). In every model 0 <= f_d <= kd, f_s >= 0 and f_d + f_s <= kd + ks.
 * Test: TestReflectance.cxx.
 */
#ifndef avianlidar_Reflectance_h
#define avianlidar_Reflectance_h

#include "LaneMath.h"
#include "Vector.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

namespace avianlidar
{
/// Coefficients of a surface. The defaults are the paper's wall (Table 1).
struct Material
{
  double kd = 0.146; ///< diffuse coefficient, >= 0
  double ks = 0.054; ///< specular coefficient, >= 0; kd + ks <= 1
  double kp = 112.0; ///< glossiness coefficient, in [0, 1e6]
  /// Standard deviation of facet slopes, rad, in [0, pi/2]; used only by OrenNayar.
  double roughness = 0.0;

  /// Largest share of a ray's energy that the surface returns.
  AVIANLIDAR_ALWAYS_INLINE double albedo() const { return this->kd + this->ks; }
  bool isGlossy() const { return this->ks > 0.0; }
  bool isMatt() const { return this->kd > 0.0; }
  bool operator==(const Material& other) const
  {
    return this->kd == other.kd && this->ks == other.ks && this->kp == other.kp &&
      this->roughness == other.roughness;
  }
  bool operator!=(const Material& other) const { return !(*this == other); }
};

/// Description of a coefficient whose lower limit is 0, for all code except the models of
/// reflectance.
struct MaterialCoefficient
{
  const char* name; ///< name of the cell array, and key in scene files
  const char* unit; ///< unit; "1": a pure number
  double Material::*member;
  double most;          ///< upper limit of the coefficient
  bool isShare;         ///< true for a share of the energy; the sum of all shares is at most 1
  const char* expected; ///< expected range, in words
  /// True if a scene file must give the coefficient, for a material with the preceding
  /// coefficients.
  bool (*isNeeded)(const Material&);
  bool isOptional; ///< true if surfaces without the cell array have the default of Material
};

/// All coefficients, in the order in which messages name them.
inline constexpr MaterialCoefficient MaterialCoefficients[] = {
  { "kd", "1", &Material::kd, 1.0, true, "at least 0", [](const Material&) { return true; },
    false },
  { "ks", "1", &Material::ks, 1.0, true, "at least 0", [](const Material&) { return false; },
    false },
  { "kp", "1", &Material::kp, 1e6, false, "from 0 to 1e6",
    [](const Material& material) { return material.isGlossy(); }, false },
  // The limit is above pi/2 rounded to single precision.
  { "roughness", "rad", &Material::roughness, 0.5 * Pi + 1e-7, false, "from 0 to pi/2 rad",
    [](const Material&) { return false; }, true },
};

/// Materials of samples, one array per coefficient, for loops over lanes.
class MaterialLanes
{
public:
  void resize(std::size_t count)
  {
    for (std::vector<double>& lane : this->Lanes)
    {
      lane.resize(count);
    }
  }
  void fill(std::size_t begin, std::size_t end, const Material& m)
  {
    for (std::size_t k = 0; k < std::size(this->Lanes); ++k)
    {
      std::fill(this->Lanes[k].begin() + begin, this->Lanes[k].begin() + end,
        m.*MaterialCoefficients[k].member);
    }
  }
  struct View
  {
    const double *kd, *ks, *kp, *roughness;
    AVIANLIDAR_ALWAYS_INLINE Material operator[](std::size_t i) const
    {
      return { this->kd[i], this->ks[i], this->kp[i], this->roughness[i] };
    }
  };
  View view() const
  {
    return { this->Lanes[0].data(), this->Lanes[1].data(), this->Lanes[2].data(),
      this->Lanes[3].data() };
  }
  Material operator[](std::size_t i) const { return this->view()[i]; }

private:
  std::vector<double> Lanes[std::size(MaterialCoefficients)];
};

/// @return empty if the material is usable, else a sentence that names the value and what was
/// expected. A sum kd + ks that exceeds 1 by less than 1e-12 counts as a rounded 1.
std::string checkMaterial(const Material& material);

/// Names of the coefficients whose cell arrays a surface must have together or not at all: "kd, ks,
/// kp".
std::string namesOfCoefficients();

/// Names and values of the coefficients: "kd 0.146, ks 0.054, kp 112, roughness 0".
std::string textOf(const Material& material);

enum class ReflectanceModel
{
  LambertBlinnPhong = 0,
  Phong = 1,
  Microfacet = 2,
  OrenNayar = 3
};

/// Angles at one reflection. Negative cosines are kept.
struct ReflectionGeometry
{
  double cosIncidence = 1.0;  ///< cosine between the reversed incident direction and the normal
  double cosOutgoing = 1.0;   ///< cosine between the outgoing direction and the normal
  double cosLobe = 1.0;       ///< cos delta
  double sin2Lobe = 0.0;      ///< sin^2 delta, accurate for small delta
  double sin2Half = 0.0;      ///< sin^2 theta_h
  double cosDifference = 1.0; ///< cos theta_d
  double roughTerm = 0.0;     ///< max(0, cos dphi) sin alpha tan beta (OrenNayar)
};

/// ReflectionGeometry::roughTerm. @param cosBetween cosine of the angle between the two directions,
/// which both point away from the surface
AVIANLIDAR_ALWAYS_INLINE double roughTermOf(
  double cosIncidence, double cosOutgoing, double cosBetween)
{
  const double sines = lanes::larger(cosBetween - cosIncidence * cosOutgoing, 0.0);
  return sines / lanes::larger(lanes::larger(cosIncidence, cosOutgoing), 1e-300);
}

/// @param incident unit vector towards the surface @param outgoing unit vector away from the
/// surface @param normal unit vector on the side of the incident ray's origin
ReflectionGeometry reflectionGeometry(
  const Vec3& incident, const Vec3& outgoing, const Vec3& normal);

/// Geometry of a reflection back to the ray's origin: outgoing = -incident, delta = 2 theta_i. The
/// relative error of f is below 1e-9 at kp = 1e6.
AVIANLIDAR_ALWAYS_INLINE ReflectionGeometry monostaticGeometry(double cosIncidence)
{
  const double sineSquared = lanes::larger((1.0 - cosIncidence) * (1.0 + cosIncidence), 0.0);
  const double sin2Lobe = 4.0 * sineSquared * cosIncidence * cosIncidence;
  return { cosIncidence, cosIncidence, cosIncidence * cosIncidence - sineSquared,
    lanes::smaller(sin2Lobe, 1.0), lanes::smaller(sineSquared, 1.0), 1.0,
    sineSquared / lanes::larger(cosIncidence, 1e-300) };
}

/// Geometry of a reflection into the mirror direction of the incident ray: delta = 0.
AVIANLIDAR_ALWAYS_INLINE ReflectionGeometry mirrorGeometry(double cosIncidence)
{
  return { cosIncidence, cosIncidence, 1.0, 0.0, 0.0, cosIncidence, 0.0 };
}

/// Mirror direction of the incident ray; a unit vector if both arguments are unit vectors.
Vec3 mirrorDirection(const Vec3& incident, const Vec3& normal);

/// The two components of f_sur (paper, Eq. 5).
struct Reflectance
{
  double diffuse = 0.0;  ///< f_d
  double specular = 0.0; ///< f_s
  AVIANLIDAR_ALWAYS_INLINE double total() const { return this->diffuse + this->specular; }
};

/// cos^exponent of the angle whose cosine and squared sine are given: 0 for cosine <= 0, also at
/// exponent 0.
AVIANLIDAR_ALWAYS_INLINE double lobe(double cosine, double sineSquared, double exponent)
{
  // Where the angle is small, ln cos^2 is taken from the sine.
  const bool small = cosine > 0.7;
  const bool lit = cosine > 0.0;
  const double square = lit ? cosine * cosine : 1.0;
  const double fromSine = 1.0 - sineSquared;
  const double y = small ? fromSine : square;
  const double correction = small ? (1.0 - fromSine) - sineSquared : 0.0;
  const double value = lanes::exp(0.5 * exponent * lanes::logOf(y, correction));
  return lit ? value : 0.0;
}

/// @name The models.
/// of() gives f_d and f_s. bound() gives upper bounds of f_d and f_s for all outgoing directions at
/// an angle of incidence. unlikeLambert() gives the ratio f_d/(kd cos theta_i) to a Lambertian
/// surface.
/// @{
struct LambertBlinnPhong
{
  AVIANLIDAR_ALWAYS_INLINE static Reflectance of(Material m, ReflectionGeometry g)
  {
    return { m.kd * lanes::unit(g.cosIncidence), m.ks * lobe(g.cosLobe, g.sin2Lobe, m.kp) };
  }
  AVIANLIDAR_ALWAYS_INLINE static Reflectance bound(Material m, double cosIncidence)
  {
    return { m.kd * lanes::unit(cosIncidence), m.ks };
  }
  AVIANLIDAR_ALWAYS_INLINE static double unlikeLambert(Material, ReflectionGeometry) { return 1.0; }
};

struct Phong
{
  AVIANLIDAR_ALWAYS_INLINE static Reflectance of(Material m, ReflectionGeometry g)
  {
    const double c = lanes::unit(g.cosIncidence);
    return { m.kd * c, m.ks * lobe(g.cosLobe, g.sin2Lobe, m.kp) * c };
  }
  AVIANLIDAR_ALWAYS_INLINE static Reflectance bound(Material m, double cosIncidence)
  {
    const double c = lanes::unit(cosIncidence);
    return { m.kd * c, m.ks * c };
  }
  AVIANLIDAR_ALWAYS_INLINE static double unlikeLambert(Material, ReflectionGeometry) { return 1.0; }
};

struct Microfacet
{
  /// Schlick's factor s: 0 at theta_d = 0, 1 at theta_d = pi/2.
  AVIANLIDAR_ALWAYS_INLINE static double riseOf(ReflectionGeometry g)
  {
    const double fall = 1.0 - lanes::unit(g.cosDifference);
    return (fall * fall) * (fall * fall) * fall;
  }
  AVIANLIDAR_ALWAYS_INLINE static Reflectance of(Material m, ReflectionGeometry g)
  {
    const double rise = riseOf(g);
    const double ci = g.cosIncidence;
    const double co = g.cosOutgoing;
    const double a2 = 1.0 / (2.0 * m.kp + 1.0);
    const double spread = a2 / (a2 * (1.0 - g.sin2Half) + g.sin2Half);
    const double ai = std::sqrt(a2 + (1.0 - a2) * ci * ci);
    const double ao = std::sqrt(a2 + (1.0 - a2) * co * co);
    const bool lit = (ci > 0.0) & (co > 0.0);
    const double masking = lanes::smaller(2.0 * ci * co / (lit ? co * ai + ci * ao : 1.0), 1.0);
    return { m.kd * lanes::unit(ci) * (1.0 - rise),
      lit ? (m.ks + m.kd * rise) * (spread * spread * masking) : 0.0 };
  }
  AVIANLIDAR_ALWAYS_INLINE static Reflectance bound(Material m, double cosIncidence)
  {
    return { m.kd * lanes::unit(cosIncidence), m.kd + m.ks };
  }
  AVIANLIDAR_ALWAYS_INLINE static double unlikeLambert(Material, ReflectionGeometry g)
  {
    return 1.0 - riseOf(g);
  }
};

struct OrenNayar
{
  /// Coefficients A and B of the model.
  struct Shares
  {
    double even;
    double rough;
  };
  AVIANLIDAR_ALWAYS_INLINE static Shares sharesOf(Material m)
  {
    const double s2 = m.roughness * m.roughness;
    return { 1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09) };
  }
  AVIANLIDAR_ALWAYS_INLINE static double unlikeLambert(Material m, ReflectionGeometry g)
  {
    const Shares by = sharesOf(m);
    return by.even + by.rough * g.roughTerm;
  }
  AVIANLIDAR_ALWAYS_INLINE static Reflectance of(Material m, ReflectionGeometry g)
  {
    const double c = lanes::unit(g.cosIncidence);
    return { m.kd * lanes::smaller(c * unlikeLambert(m, g), 1.0),
      LambertBlinnPhong::of(m, g).specular };
  }
  AVIANLIDAR_ALWAYS_INLINE static Reflectance bound(Material m, double cosIncidence)
  {
    // cos theta_i sin alpha tan beta is at most sin theta_i.
    const Shares by = sharesOf(m);
    const double c = lanes::unit(cosIncidence);
    return { m.kd * lanes::smaller(c * by.even + by.rough * std::sqrt(1.0 - c * c), 1.0), m.ks };
  }
};
/// @}

/// Call `f` with a value of the type that implements `model`. @return its result
template <class F>
AVIANLIDAR_ALWAYS_INLINE auto withModel(ReflectanceModel model, F f)
{
  switch (model)
  {
    case ReflectanceModel::Phong:
      return f(Phong());
    case ReflectanceModel::Microfacet:
      return f(Microfacet());
    case ReflectanceModel::OrenNayar:
      return f(OrenNayar());
    case ReflectanceModel::LambertBlinnPhong:
      break;
  }
  return f(LambertBlinnPhong());
}

/// f_d and f_s of `material` (which must have passed checkMaterial).
Reflectance reflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry);

/// f_s of `material` (which must have passed checkMaterial).
inline double specularReflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry)
{
  return reflectance(model, material, geometry).specular;
}

/// Upper bounds of f_d and of f_s for all outgoing directions at an angle of incidence.
Reflectance reflectanceBound(ReflectanceModel model, const Material& material, double cosIncidence);

/// Largest f_d and largest f_s straight back at cosines of incidence of at most `mostCosine`.
Reflectance mostStraightBack(ReflectanceModel model, const Material& material, double mostCosine);

/**
 * Share of a ray's energy that a receiver of aperture `aperture` (m2) at distance `distance` (m)
 * collects: f_d A/(pi r^2) and f_s (kp + 1) A/(2 pi r^2), both scaled by one factor so that their
 * total does not exceed 1. Aperture 0 leaves f unchanged, as in the paper. At distance 0 an
 * aperture collects a total of 1.
 */
AVIANLIDAR_ALWAYS_INLINE Reflectance throughAperture(
  Reflectance f, Material material, double aperture, double distance)
{
  const double perSteradian = aperture / (Pi * distance * distance);
  const double specular = 0.5 * (material.kp + 1.0) * f.specular;
  // Dividing by the sum first avoids overflow of the product at distances near 0.
  const double gathered = f.diffuse + specular;
  const double total = lanes::smaller(gathered * perSteradian, 1.0);
  const bool any = gathered > 0.0;
  const double scale = any ? total : 0.0;
  const double whole = any ? gathered : 1.0;
  const bool gathers = aperture > 0.0;
  return { gathers ? f.diffuse / whole * scale : f.diffuse,
    gathers ? specular / whole * scale : f.specular };
}

/// Upper bound, 1/sr, of the share of energy that reaches an aperture of A m2 at a distance of r m
/// from a surface, divided by A/r2. The bound is the gain of the whole albedo on the lobe's axis or
/// of a diffuse surface, whichever is larger.
double apertureGain(const Material& material);

/// Squared incidence angle, rad2, at which the lobe straight back has fallen to 1/e; 0 without a
/// lobe.
double lobeWidth2(const Material& material);
}

#endif
