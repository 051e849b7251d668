// SPDX-License-Identifier: BSD-3-Clause
#include "Reflectance.h"

#include "Complaint.h"

#include "Sensor.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace avianlidar
{
namespace
{

double square(double v)
{
  return v * v;
}

/// Rise of Schlick's Fresnel term from normal (0) to grazing (1) difference angle.
double fresnelRise(double cosDifference)
{
  const double c = 1.0 - std::clamp(cosDifference, 0.0, 1.0);
  return square(square(c)) * c;
}

/// Trowbridge-Reitz distribution over its peak, times the masking.
double microfacetLobe(const ReflectionGeometry& g, double exponent)
{
  const double ci = g.cosIncidence;
  const double co = g.cosOutgoing;
  if (ci <= 0.0 || co <= 0.0)
  {
    return 0.0;
  }
  const double a2 = 1.0 / (2.0 * exponent + 1.0);
  const double distribution = square(a2 / (a2 * (1.0 - g.sin2Half) + g.sin2Half));
  const double ai = std::sqrt(a2 + (1.0 - a2) * ci * ci);
  const double ao = std::sqrt(a2 + (1.0 - a2) * co * co);
  return distribution * std::min(1.0, 2.0 * ci * co / (co * ai + ci * ao));
}
}

std::string checkMaterial(const Material& m)
{
  constexpr double roundedOne = 1.0 + 1e-12;
  if (!std::isfinite(m.kd) || m.kd < 0.0)
  {
    return complaint("kd", m.kd, "at least 0");
  }
  if (!std::isfinite(m.ks) || m.ks < 0.0)
  {
    return complaint("ks", m.ks, "at least 0");
  }
  if (m.kd + m.ks > roundedOne)
  {
    return complaint("kd + ks", m.kd + m.ks, "at most 1");
  }
  if (!std::isfinite(m.kp) || m.kp < 0.0 || m.kp > MaximumGlossiness)
  {
    return complaint("kp", m.kp, "from 0 to 1e6");
  }
  return {};
}

Vec3 mirrorDirection(const Vec3& incident, const Vec3& normal)
{
  return incident - 2.0 * glm::dot(incident, normal) * normal;
}

ReflectionGeometry reflectionGeometry(
  const Vec3& incident, const Vec3& outgoing, const Vec3& normal)
{
  ReflectionGeometry g;
  g.cosIncidence = -glm::dot(incident, normal);
  g.cosOutgoing = glm::dot(outgoing, normal);
  // Small angles from cross products: 1 - cos^2 would lose half the digits, and kp multiplies the
  // error.
  const Vec3 mirror = mirrorDirection(incident, normal);
  const Vec3 off = glm::cross(mirror, outgoing);
  g.cosLobe = glm::dot(mirror, outgoing);
  g.sin2Lobe = std::min(1.0, glm::dot(off, off));
  const Vec3 half = outgoing - incident;
  const double length2 = glm::dot(half, half);
  if (length2 > 0.0)
  {
    const Vec3 tilt = glm::cross(half, normal);
    g.sin2Half = std::min(1.0, glm::dot(tilt, tilt) / length2);
    g.cosDifference = 0.5 * std::sqrt(length2);
  }
  else
  {
    // Straight through: every half vector is as good, and the difference angle is 90 degrees.
    g.sin2Half = 0.0;
    g.cosDifference = 0.0;
  }
  return g;
}

namespace
{
ReflectionGeometry monostatic(double cosine, double sineSquared)
{
  ReflectionGeometry g;
  g.cosIncidence = cosine;
  g.cosOutgoing = cosine;
  g.cosLobe = cosine * cosine - sineSquared;
  g.sin2Lobe = std::min(1.0, 4.0 * sineSquared * cosine * cosine);
  g.sin2Half = std::min(1.0, sineSquared);
  g.cosDifference = 1.0;
  return g;
}
}

ReflectionGeometry monostaticGeometry(const Vec3& incident, const Vec3& normal)
{
  const Vec3 off = glm::cross(incident, normal);
  return monostatic(-glm::dot(incident, normal), glm::dot(off, off));
}

ReflectionGeometry monostaticGeometry(double cosIncidence)
{
  return monostatic(cosIncidence, std::max(0.0, (1.0 - cosIncidence) * (1.0 + cosIncidence)));
}

ReflectionGeometry mirrorGeometry(double cosIncidence)
{
  ReflectionGeometry g;
  g.cosIncidence = cosIncidence;
  g.cosOutgoing = cosIncidence;
  g.cosDifference = cosIncidence;
  return g;
}

double lobe(double cosine, double sineSquared, double exponent)
{
  if (!(cosine > 0.0))
  {
    return 0.0;
  }
  if (cosine > 0.7)
  {
    return std::exp(0.5 * exponent * std::log1p(-sineSquared));
  }
  return std::pow(cosine, exponent);
}

double diffuseReflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry)
{
  const double lambert = material.kd * std::clamp(geometry.cosIncidence, 0.0, 1.0);
  return model == ReflectanceModel::Microfacet
    ? lambert * (1.0 - fresnelRise(geometry.cosDifference))
    : lambert;
}

double specularReflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry)
{
  switch (model)
  {
    case ReflectanceModel::Phong:
      return material.ks * lobe(geometry.cosLobe, geometry.sin2Lobe, material.kp) *
        std::clamp(geometry.cosIncidence, 0.0, 1.0);
    case ReflectanceModel::Microfacet:
      return (material.ks + material.kd * fresnelRise(geometry.cosDifference)) *
        microfacetLobe(geometry, material.kp);
    case ReflectanceModel::LambertBlinnPhong:
      break;
  }
  return material.ks * lobe(geometry.cosLobe, geometry.sin2Lobe, material.kp);
}

Reflectance reflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry)
{
  return { diffuseReflectance(model, material, geometry),
    specularReflectance(model, material, geometry) };
}

Reflectance reflectanceBound(ReflectanceModel model, const Material& material, double cosIncidence)
{
  const double c = std::clamp(cosIncidence, 0.0, 1.0);
  Reflectance bound{ material.kd * c, material.ks };
  if (model == ReflectanceModel::Phong)
  {
    bound.specular = material.ks * c;
  }
  else if (model == ReflectanceModel::Microfacet)
  {
    bound.specular = material.ks + material.kd;
  }
  return bound;
}

Reflectance throughAperture(const Reflectance& f, double kp, double aperture, double distance)
{
  if (!(aperture > 0.0) || !(f.total() > 0.0))
  {
    return f;
  }
  const double perSteradian = aperture / (Pi * distance * distance);
  const double specularGain = 0.5 * (kp + 1.0);
  // Divided by their own sum first: the product may overflow where the distance is all but 0.
  const double gathered = f.diffuse + specularGain * f.specular;
  const double total = std::min(1.0, gathered * perSteradian);
  return { f.diffuse / gathered * total, specularGain * f.specular / gathered * total };
}
}
