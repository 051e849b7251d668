// SPDX-License-Identifier: BSD-3-Clause
#include "Reflectance.h"

#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace avianlidar
{
static_assert(sizeof(Material) == std::size(MaterialCoefficients) * sizeof(double),
  "all coefficients are in the table, and materials can be hashed as bytes");

namespace
{
/// "kd + ks"
std::string nameOfAlbedo()
{
  std::string name;
  for (const MaterialCoefficient& coefficient : MaterialCoefficients)
  {
    if (coefficient.isShare)
    {
      name += (name.empty() ? "" : " + ") + std::string(coefficient.name);
    }
  }
  return name;
}
}

std::string checkMaterial(const Material& m)
{
  for (const MaterialCoefficient& coefficient : MaterialCoefficients)
  {
    const double value = m.*coefficient.member;
    if (!std::isfinite(value) || value < 0.0 || (value > coefficient.most && !coefficient.isShare))
    {
      return valueError(coefficient.name, value, coefficient.expected);
    }
  }
  constexpr double roundedOne = 1.0 + 1e-12;
  return m.albedo() > roundedOne ? valueError(nameOfAlbedo().c_str(), m.albedo(), "at most 1")
                                 : std::string();
}

std::string namesOfCoefficients()
{
  std::string names;
  for (const MaterialCoefficient& coefficient : MaterialCoefficients)
  {
    names +=
      coefficient.isOptional ? "" : (names.empty() ? "" : ", ") + std::string(coefficient.name);
  }
  return names;
}

std::string textOf(const Material& material)
{
  std::ostringstream text;
  const char* separator = "";
  for (const MaterialCoefficient& coefficient : MaterialCoefficients)
  {
    text << separator << coefficient.name << ' ' << material.*coefficient.member;
    separator = ", ";
  }
  return text.str();
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
  // Cross products are used because 1 - cos^2 loses half the digits of small angles, and kp
  // multiplies the error.
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
    // Straight through, any half vector is valid, and the difference angle is 90 degrees.
    g.sin2Half = 0.0;
    g.cosDifference = 0.0;
  }
  g.roughTerm = roughTermOf(g.cosIncidence, g.cosOutgoing, -glm::dot(incident, outgoing));
  return g;
}

Reflectance reflectance(
  ReflectanceModel model, const Material& material, const ReflectionGeometry& geometry)
{
  return withModel(model, [&](auto m) { return m.of(material, geometry); });
}

Reflectance reflectanceBound(ReflectanceModel model, const Material& material, double cosIncidence)
{
  return withModel(model, [&](auto m) { return m.bound(material, cosIncidence); });
}

Reflectance mostStraightBack(ReflectanceModel model, const Material& material, double mostCosine)
{
  Reflectance most = reflectance(model, material, monostaticGeometry(mostCosine));
  if (model == ReflectanceModel::OrenNayar)
  {
    // A rough surface is brightest at the angle where A c + B (1 - c^2) is largest.
    const OrenNayar::Shares by = OrenNayar::sharesOf(material);
    if (by.even < 2.0 * by.rough * mostCosine)
    {
      const double brightest = 0.5 * by.even / by.rough;
      most.diffuse = reflectance(model, material, monostaticGeometry(brightest)).diffuse;
    }
  }
  return most;
}

double apertureGain(const Material& material)
{
  return material.albedo() * std::max(1.0, 0.5 * (material.kp + 1.0)) / Pi;
}

double lobeWidth2(const Material& material)
{
  // cos^kp(2 b) is about exp(-2 kp b^2). a^2 of Microfacet is 1/(2 kp + 1).
  return material.ks > 0.0 ? 1.0 / (2.0 * material.kp + 1.0) : 0.0;
}
}
