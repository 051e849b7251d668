// SPDX-License-Identifier: BSD-3-Clause
#include "Bird.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace avianlidar
{
namespace
{
constexpr double BodyShare = 0.65;
constexpr double WingShare = 0.85;
constexpr double Flapping = 35.0 * Pi / 180.0;
constexpr double Gliding = 5.0 * Pi / 180.0;
constexpr double Attack = 6.0 * Pi / 180.0;
constexpr double Thickness = 0.001;

// Sides around the body's axis and steps along the axis. There are few of them, so that a beam on a
// bird is integrated.
constexpr std::uint32_t Around = 8;
constexpr std::uint32_t Along = 4;

TriangleMesh roundBody(double radius, double half)
{
  const double angle = 2.0 * Pi / Around;
  TriangleMesh mesh;
  mesh.points.emplace_back(0.0, half, 0.0);
  for (std::uint32_t ring = 1; ring < Along; ++ring)
  {
    const double latitude = Pi * ring / Along;
    for (std::uint32_t k = 0; k < Around; ++k)
    {
      const double r = radius * std::sin(latitude);
      mesh.points.emplace_back(
        r * std::cos(angle * k), half * std::cos(latitude), r * std::sin(angle * k));
    }
  }
  mesh.points.emplace_back(0.0, -half, 0.0);
  const auto at = [](std::uint32_t ring, std::uint32_t k)
  { return 1 + (ring - 1) * Around + k % Around; };
  const auto last = static_cast<std::uint32_t>(mesh.points.size() - 1);
  for (std::uint32_t k = 0; k < Around; ++k)
  {
    mesh.triangles.push_back({ 0, at(1, k + 1), at(1, k) });
    for (std::uint32_t ring = 1; ring + 1 < Along; ++ring)
    {
      mesh.triangles.push_back({ at(ring, k), at(ring, k + 1), at(ring + 1, k + 1) });
      mesh.triangles.push_back({ at(ring, k), at(ring + 1, k + 1), at(ring + 1, k) });
    }
    mesh.triangles.push_back({ last, at(Along - 1, k), at(Along - 1, k + 1) });
  }
  return mesh;
}

/// The effective area of a convex body with a centre is half a quadratic form of the direction: the
/// integral of n n^T over its surface. The members are values of the form along the axis and across
/// it.
struct Shown
{
  double along;
  double across;
};

Shown shownBy(const TriangleMesh& mesh)
{
  Shown sum{ 0.0, 0.0 };
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Vec3 n = 0.5 *
      glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    const double area = glm::length(n);
    sum.along += n.y * n.y / area;
    sum.across += 0.5 * (n.x * n.x + n.z * n.z) / area;
  }
  return sum;
}

/// The values for an ellipsoid of revolution, by the midpoint rule. @param b radius
/// @param a half the ellipsoid's length
Shown shownByEllipsoid(double b, double a)
{
  constexpr int steps = 2000;
  Shown sum{ 0.0, 0.0 };
  for (int i = 0; i < steps; ++i)
  {
    const double u = Pi * (i + 0.5) / steps;
    const double s = std::sin(u);
    const double c = std::cos(u);
    const double root = std::sqrt(a * a * s * s + b * b * c * c);
    sum.along += 2.0 * Pi * b * b * b * c * c * s / root;
    sum.across += Pi * a * a * b * s * s * s / root;
  }
  sum.along *= Pi / steps;
  sum.across *= Pi / steps;
  return sum;
}

/// A polyhedron with the effective area of the ellipsoid from every direction.
TriangleMesh body(const BirdShape& shape)
{
  const double b = 0.5 * shape.bodyDiameter;
  const double a = 0.5 * shape.bodyLength;
  const Shown wanted = shownByEllipsoid(b, a);
  double radius = b;
  double half = a;
  for (int step = 0; step < 40; ++step)
  {
    // The value along the axis grows with the squared radius. The value across the axis grows with
    // radius times length.
    const Shown now = shownBy(roundBody(radius, half));
    const double wider = std::sqrt(wanted.along / now.along);
    half *= wanted.across / now.across / wider;
    radius *= wider;
  }
  return roundBody(radius, half);
}

TriangleMesh wing(const BirdShape& shape, double side, double angle)
{
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
  {
    const double along = (corner & 1) ? shape.wingLength : 0.0;
    const double forward = (corner & 2) ? 0.5 * shape.wingChord : -0.5 * shape.wingChord;
    const double up = (corner & 4) ? 0.5 * shape.wingThickness : -0.5 * shape.wingThickness;
    // The leading edge rises by the angle of attack, then the tip by the angle of the wing.
    const double y = forward * std::cos(Attack) - up * std::sin(Attack);
    const double z = forward * std::sin(Attack) + up * std::cos(Attack);
    mesh.points.emplace_back(
      side * (0.5 * shape.bodyDiameter + along * std::cos(angle) - z * std::sin(angle)), y,
      along * std::sin(angle) + z * std::cos(angle));
  }
  // Corners of the six sides of a box. Bits 1, 2 and 4 of a corner's number are its x, y and z.
  const std::array<std::array<std::uint32_t, 4>, 6> sides = { { { 0, 4, 6, 2 }, { 1, 3, 7, 5 },
    { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } } };
  for (const auto& s : sides)
  {
    for (const auto& t : { std::array<std::uint32_t, 3>{ s[0], s[1], s[2] },
           std::array<std::uint32_t, 3>{ s[0], s[2], s[3] } })
    {
      mesh.triangles.push_back(side > 0.0 ? t : std::array<std::uint32_t, 3>{ t[0], t[2], t[1] });
    }
  }
  return mesh;
}

}

BirdShape::BirdShape(const BirdSpecies& species)
  : bodyDiameter(0.0)
  , bodyLength(BodyShare * species.length)
  , wingLength(0.0)
  , wingChord(0.0)
  , wingThickness(0.0)
{
  const double frontal = species.passerine ? 0.0129 * std::pow(species.mass, 0.614)
                                           : 0.00813 * std::pow(species.mass, 0.666);
  this->bodyDiameter = std::sqrt(4.0 * frontal / Pi);
  this->wingLength = 0.5 * (species.span - this->bodyDiameter);
  this->wingChord = 0.5 * WingShare * species.wingArea / this->wingLength;
  this->wingThickness = Thickness * this->wingChord;
}

BirdShape BirdShape::scaled(double factor) const
{
  BirdShape shape = *this;
  for (double* length : { &shape.bodyDiameter, &shape.bodyLength, &shape.wingLength,
         &shape.wingChord, &shape.wingThickness })
  {
    *length *= factor;
  }
  return shape;
}

double wingAngle(double phase, bool gliding)
{
  return gliding ? Gliding : Flapping * std::sin(2.0 * Pi * phase);
}

double wingbeatFrequency(const BirdSpecies& s)
{
  constexpr double gravity = 9.81;
  constexpr double air = 1.225; // density of air at sea level, kg/m^3
  return std::pow(s.mass, 3.0 / 8.0) * std::sqrt(gravity) * std::pow(s.span, -23.0 / 24.0) *
    std::pow(s.wingArea, -1.0 / 3.0) * std::pow(air, -3.0 / 8.0);
}

TriangleMesh birdPart(const BirdShape& shape, BirdPart part, double angle)
{
  return part == BirdPart::Body ? body(shape)
                                : wing(shape, part == BirdPart::LeftWing ? -1.0 : 1.0, angle);
}

TriangleMesh wholeBird(const BirdShape& shape, double angle)
{
  TriangleMesh all;
  for (const BirdPart part : { BirdPart::Body, BirdPart::LeftWing, BirdPart::RightWing })
  {
    const TriangleMesh mesh = birdPart(shape, part, angle);
    const auto first = static_cast<std::uint32_t>(all.points.size());
    all.points.insert(all.points.end(), mesh.points.begin(), mesh.points.end());
    for (const auto& t : mesh.triangles)
    {
      all.triangles.push_back({ first + t[0], first + t[1], first + t[2] });
    }
  }
  return all;
}

std::size_t findSpecies(const std::vector<BirdSpecies>& all, const std::string& name)
{
  const auto found = std::find_if(
    all.begin(), all.end(), [&](const BirdSpecies& species) { return species.name == name; });
  if (found == all.end())
  {
    std::string known;
    for (const BirdSpecies& species : all)
    {
      known += (known.empty() ? "" : ", ") + species.name;
    }
    throw std::runtime_error("is '" + name + "', expected one of " + known);
  }
  return static_cast<std::size_t>(found - all.begin());
}
}
