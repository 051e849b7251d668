// SPDX-License-Identifier: BSD-3-Clause
#include "ApexTriangles.h"

#include "Multiversion.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
constexpr int Batch = ApexTriangles::Batch;

/// Records of a batch, one triangle per lane.
struct alignas(64) BatchRecords
{
  float edge[3][3][Batch];
  float w[3][Batch];
  float error[Batch];
  float inside[Batch];
};

/// Factors that depend on the half-beamwidth.
struct BeamBounds
{
  double gain;   ///< 16 u G, see RayPacketTriangles.h
  double noise;  ///< K u_d
  double secant; ///< secant of the half-beamwidth, rounded up
};

AVIANLIDAR_ALWAYS_INLINE double most(double a, double b)
{
  return a > b ? a : b;
}

AVIANLIDAR_ALWAYS_INLINE double sum(double a, double b, double c)
{
  return std::fabs(a) + std::fabs(b) + std::fabs(c);
}

AVIANLIDAR_ALWAYS_INLINE void edge(double ax, double ay, double az, double bx, double by, double bz,
  double gain, double noise, double sign, float& x, float& y, float& z)
{
  const double ex = ay * bz - az * by;
  const double ey = az * bx - ax * bz;
  const double ez = ax * by - ay * bx;
  const double scale = sign / (gain * sum(ex, ey, ez) + noise);
  const double fx = ex * scale;
  const double fy = ey * scale;
  const double fz = ez * scale;
  // An edge vector of 0 decides nothing.
  const double size = sum(fx, fy, fz);
  constexpr double Largest = 1e30;
  x = static_cast<float>(size < Largest ? fx : 0.0);
  y = static_cast<float>(size < Largest ? fy : 0.0);
  z = static_cast<float>(size < Largest ? fz : 0.0);
}

AVIANLIDAR_MULTIVERSION void seeAll(const ApexCorners& t, const BeamBounds& bounds, BatchRecords& r)
{
  constexpr double U = RoundOffSingle;
  constexpr double D = RoundOffDouble;
  constexpr double Up = 1.0 + 16.0 * U;
  const double gain = bounds.gain;
  const double secant = bounds.secant;
  const double noiseFactor = bounds.noise;
#pragma omp simd
  for (int i = 0; i < Batch; ++i)
  {
    const double ax = t.corner[0][0][i], ay = t.corner[0][1][i], az = t.corner[0][2][i];
    const double bx = t.corner[1][0][i], by = t.corner[1][1][i], bz = t.corner[1][2][i];
    const double cx = t.corner[2][0][i], cy = t.corner[2][1][i], cz = t.corner[2][2][i];
    const double far = most(sum(ax, ay, az), most(sum(bx, by, bz), sum(cx, cy, cz)));
    const double ux = bx - ax, uy = by - ay, uz = bz - az;
    const double vx = cx - ax, vy = cy - ay, vz = cz - az;
    const double sx = cx - bx, sy = cy - by, sz = cz - bz;
    const double longest = most(
      ux * ux + uy * uy + uz * uz, most(vx * vx + vy * vy + vz * vz, sx * sx + sy * sy + sz * sz));
    const double nx = uy * vz - uz * vy;
    const double ny = uz * vx - ux * vz;
    const double nz = ux * vy - uy * vx;
    const double height = nx * ax + ny * ay + nz * az;
    const double inverse = 1.0 / height;
    const double wx = nx * inverse;
    const double wy = ny * inverse;
    const double wz = nz * inverse;
    const double reach = sum(wx, wy, wz) * secant;
    const double slope = 128.0 * D * std::sqrt(longest) * (far * std::fabs(inverse)) * secant;
    const double relative = slope * far + 64.0 * D * far * reach;
    const double error = Up * ((8.0 * U + 2.0 * relative) * reach + slope);
    // The result is 0 also if a value is not a number.
    const double says =
      (relative < 1e-6 ? 1.0 : 0.0) * (reach > 1e-33 ? 1.0 : 0.0) * (reach < 1e33 ? 1.0 : 0.0);
    r.w[0][i] = static_cast<float>(says > 0.0 ? wx : 0.0);
    r.w[1][i] = static_cast<float>(says > 0.0 ? wy : 0.0);
    r.w[2][i] = static_cast<float>(says > 0.0 ? wz : 0.0);
    r.error[i] = says > 0.0 ? static_cast<float>(error) : FloatInfinity;
    r.inside[i] = says > 0.0 ? 1.0f : FloatInfinity;
    const double noise = noiseFactor * (far * far);
    // The side of the plane on which the apex lies must be certain, as it gives e its sign. It does
    // not matter for triangles so thin that no ray hits them (planeOf()).
    const double side = height > 0.0 ? 1.0 : -1.0;
    const double thin = sum(nx, ny, nz) <= D * longest ? 1.0 : 0.0;
    const double sign = (slope * far < 0.5 ? 1.0 : thin) * side;
    edge(
      ax, ay, az, bx, by, bz, gain, noise, sign, r.edge[0][0][i], r.edge[0][1][i], r.edge[0][2][i]);
    edge(
      bx, by, bz, cx, cy, cz, gain, noise, sign, r.edge[1][0][i], r.edge[1][1][i], r.edge[1][2][i]);
    edge(
      cx, cy, cz, ax, ay, az, gain, noise, sign, r.edge[2][0][i], r.edge[2][1][i], r.edge[2][2][i]);
  }
}
}

void ApexTriangles::begin(const CollisionTree& tree, const BeamFrame& widest)
{
  if (this->Tree == &tree && this->Apex == widest.origin && this->Tangent >= widest.tanHalf)
  {
    return;
  }
  this->Tree = &tree;
  this->Apex = widest.origin;
  this->Tangent = widest.tanHalf;
  ApexTriangle nothing = {};
  nothing.position = NoTriangle;
  this->Table.resize(Places, nothing);
  for (const std::uint32_t number : this->Used)
  {
    this->Table[number] = nothing;
  }
  this->Used.clear();
}

/// Error of w for a triangle that takes the plane of another triangle; 0 for other triangles.
float ApexTriangles::errorOfOwner(std::uint32_t position, const float* w) const
{
  const CollisionTree& tree = *this->Tree;
  const std::uint32_t number = tree.order[position];
  const std::uint32_t owner = tree.planeOwner(number);
  if (owner == number)
  {
    return 0.0f;
  }
  const Vec3& base = tree.mesh->corner(owner, 0);
  const Vec3 normal = unitDirection(normalOf(cornersFrom(*tree.mesh, owner, base)));
  double apart = 0.0;
  for (int c = 0; c < 3; ++c)
  {
    apart = std::max(apart, std::fabs(glm::dot(normal, tree.mesh->corner(number, c) - base)));
  }
  // At a distance d from the plane a ray's hit moves by d / cos(incidence), and 1/r by d |w| / r.
  const float size = std::fabs(w[0]) + std::fabs(w[1]) + std::fabs(w[2]);
  return 4.0f * static_cast<float>(apart) * size * size;
}

void ApexTriangles::see(const std::uint32_t* positions, int count, ApexTriangle* fresh)
{
  ApexCorners& t = this->Corners;
  for (int i = 0; i < count; ++i)
  {
    const std::uint32_t triangle = this->Tree->order[positions[i]];
    for (int c = 0; c < 3; ++c)
    {
      const Vec3& p = this->Tree->mesh->corner(triangle, c);
      t.corner[c][0][i] = p.x - this->Apex.x;
      t.corner[c][1][i] = p.y - this->Apex.y;
      t.corner[c][2][i] = p.z - this->Apex.z;
    }
  }
  const double secant = std::sqrt(1.0 + this->Tangent * this->Tangent) * (1.0 + 1e-6);
  const BeamBounds bounds{ 16.0 * RoundOffSingle * (1.0 + 1e-5) *
      std::max(1.0 + 1.4143 * this->Tangent, secant),
    (128.0 * secant + 12.0 * (8.0 + 14.0 * this->Tangent)) * RoundOffDouble, secant };
  BatchRecords records;
  seeAll(t, bounds, records);
  for (int i = 0; i < count; ++i)
  {
    ApexTriangle& one = fresh[i];
    for (int e = 0; e < 3; ++e)
    {
      for (int k = 0; k < 3; ++k)
      {
        one.edge[e][k] = records.edge[e][k][i];
      }
      one.w[e] = records.w[e][i];
    }
    one.error = records.error[i] + this->errorOfOwner(positions[i], one.w);
    one.inside = records.inside[i];
    one.number = this->Tree->order[positions[i]];
    one.position = positions[i];
  }
}
}
