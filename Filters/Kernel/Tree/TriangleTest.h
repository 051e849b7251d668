// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TriangleTest.h
 * @brief Tests whether a ray hits a triangle, and finds the range of the hit, for every traversal.
 *
 * - Corners are moved to the apex in double precision. The edge vector of a side is E = (a - b) x
 *   (a + b) = 2 a x b. Exchanging a and b changes the sign of E and no other bit, as long as no
 *   product is fused with a sum (compile with -ffp-contract=off). Triangles that share an edge
 *   therefore have the same E for the edge, except for its sign. Unlike a x b, the product E is
 *   accurate for small triangles far away.
 * - In the beam's own plane the edge function of the ray (x, y) is ex x + ey y + ez with ex =
 *   tan(theta0.5) e1 . E, ey = tan(theta0.5) e2 . E, ez = axis . E. The edge function is linear in
 *   E, so exchanging a and b still changes only its sign.
 * - An edge function is accepted down to -(4 u_d |e|_1 + (8 + 14 tan(theta0.5)) u_d spread), with
 *   u_d the unit round-off of double and spread >= |E|_1 the sum of the magnitudes of the products
 *   in E. The two terms bound the rounding of the evaluation and of E. A ray aimed at an edge or
 *   vertex of a closed surface is therefore always accepted by one of its triangles.
 * - A triangle seen exactly edge-on (n . a = 0, with n the normal) has no solid angle and is not
 *   hit. A triangle thinner than 4 u_d of its longest side is not hit either. Both sides of a
 *   triangle can be hit.
 * - The range along the unit direction d is n . a / n . d. The normal n, the cross product of two
 *   sides, has no cancellation error (Kahan's difference of products), so the relative error of the
 *   range is a few u_d / cos(incidence angle). The range is clamped to the ranges of the triangle's
 *   corners along the ray. Where the triangle is seen nearly edge-on, the range is clamped to the
 *   ranges of the part beside the ray.
 * - If a ray passes inside by more than rounding, the range of the plane is taken without clamping.
 *   Every edge function must then be at least 64 u_d L R, with L the longest side and R the
 *   distance of the farthest corner, and |n . d| / |n| at least 2^-30, far above rounding. The hit
 *   then lies on the triangle, for three reasons. First, |n| is within 3 u_d of the cross product
 *   of the rounded sides: to first order, the computed plane is the plane of a triangle whose
 *   corners lie within sqrt(3) u_d L of the given corners. Second, the rounding of n, n . a, n . d
 *   and the quotient moves the hit off this plane by at most 13 u_d R, which is 13 u_d R /
 *   cos(incidence angle) along the ray. Third, the ray passes every side at a distance of 16.5 u_d
 *   R or more, because an edge function is twice this distance times the side's projected length,
 *   with an error of at most 28 u_d L R. A hit that moves along the ray therefore stays above the
 *   triangle.
 *
 * Source: paper, Sec. 3.3, Eq. 15-18.
 * Differs: Eq. 16 says that d lies in the tetrahedron OABC if alpha, beta, gamma >= 0. Up to a
 * common factor alpha, beta and gamma are the edge functions d . (p_B x p_C), d . (p_C x p_A), d .
 * (p_A x p_B), which are computed here. Eq. 16 itself divides by the determinant of each triangle
 * and misses rays where triangles meet.
 * Valid: coordinates that are 0 or from 1e-30 to 1e30 m. The distances of an accepted ray and of
 * its hit from the triangle are at most HitMargin times the triangle's farthest coordinate from the
 * apex (plus HitMarginBeam tan(theta0.5) times the distance for rays of a beam).
 * Test: TestTriangleTest.cxx, TestWatertight.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_TriangleTest_h
#define avianlidar_TriangleTest_h

#include "BeamFrame.h"
#include "Multiversion.h"
#include "TriangleMesh.h"

#include <cstdint>
#include <cstring>

namespace avianlidar
{
constexpr double RoundOffDouble = 1.0 / 9007199254740992.0; // 2^-53
constexpr double RoundOffSingle = 1.0 / 16777216.0;         // 2^-24

/// Margins of a hit (see Valid above). Every test of a volume widens volume, ray or cone by these
/// margins.
constexpr double HitMargin = 1.0 / 549755813888.0; // 2^-39
constexpr double HitMarginBeam = 1.0 / 512.0;

/// Corners of a triangle relative to the ray's origin, m.
struct Corners
{
  Vec3 a, b, c;
};

inline Corners cornersFrom(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& apex)
{
  return { mesh.corner(triangle, 0) - apex, mesh.corner(triangle, 1) - apex,
    mesh.corner(triangle, 2) - apex };
}

/// Edge vector of the side a-b, 2 a x b, and its spread (see above), m2.
struct EdgeVector
{
  Vec3 e;
  double spread;
};

inline EdgeVector edgeVector(const Vec3& a, const Vec3& b)
{
  const Vec3 d = a - b;
  const Vec3 s = a + b;
  const Vec3 plus(d.y * s.z, d.z * s.x, d.x * s.y);
  const Vec3 minus(d.z * s.y, d.x * s.z, d.y * s.x);
  const Vec3 size = glm::abs(plus) + glm::abs(minus);
  return { plus - minus, size.x + size.y + size.z };
}

/// Plane of a triangle, for ranges. The plane is computed only for triangles that a ray hits.
struct TrianglePlane
{
  Vec3 normal;           ///< normal whose length is twice the area, m2
  double height;         ///< normal . a, m3; 0 if edge-on or degenerate
  double longestSquared; ///< square of the longest side, m2
  double leastSlope;     ///< least |normal . d|, m2, at which the plane's range is accurate
  double leastEdge;      ///< least edge function of a ray well inside the triangle, m2
  EdgeVector sides[3];   ///< edge vectors of ab, bc, ca
};
TrianglePlane planeOf(const Corners& corners);

/// Plane of a triangle that takes its owner's plane but keeps its own sides.
TrianglePlane planeOf(const Corners& corners, const TrianglePlane& owner);

/// a b - c d with an error of at most 1.5 units in the last place (Kahan; Jeannerod, Louvet and
/// Muller, Math. Comp. 82, 2013). Unlike contraction by the compiler, std::fma gives equal bits on
/// every machine.
AVIANLIDAR_ALWAYS_INLINE double differenceOfProducts(double a, double b, double c, double d)
{
  const double cd = c * d;
  const double error = std::fma(-c, d, cd);
  return std::fma(a, b, -cd) + error;
}

/// TrianglePlane::normal; 0 if the triangle is thinner than rounding.
AVIANLIDAR_ALWAYS_INLINE Vec3 normalOf(const Corners& t)
{
  const Vec3 u = t.b - t.a;
  const Vec3 v = t.c - t.a;
  const Vec3 w = t.c - t.b;
  const Vec3 n(differenceOfProducts(u.y, v.z, u.z, v.y), differenceOfProducts(u.z, v.x, u.x, v.z),
    differenceOfProducts(u.x, v.y, u.y, v.x));
  const double longest2 = std::max(glm::dot(u, u), std::max(glm::dot(v, v), glm::dot(w, w)));
  const double largest = std::max(std::fabs(n.x), std::max(std::fabs(n.y), std::fabs(n.z)));
  return largest <= 4.0 * RoundOffDouble * longest2 ? Vec3(0.0) : n;
}

constexpr double NoRange = -1.0;

/// Range of the plane along the unit direction d, m, and its kind. Kind 0 means no hit. Kind 1
/// means that the range is the range of the triangle. Kind 2 means that the triangle is a sliver
/// along d, and rangeOnSliver() must decide. rangeOnPlane() has no branches, for loops over lanes.
struct PlaneRange
{
  double range;
  int kind;
};

/// Property of a triangle that holds for all rays of a group, so that no ray needs a test of the
/// property.
enum class PlaneView
{
  Any,
  WellShaped, ///< no projected angle of the triangle is small along any ray
  Inside      ///< every ray passes inside, and the triangle is a sliver along every ray
};

constexpr double WellShaped = 1.0 / 32.0; ///< least |slope| / (longest side)^2
constexpr double EdgeNoise =
  64.0 * RoundOffDouble; ///< least edge function inside / (longest side x farthest corner)

template <PlaneView View = PlaneView::Any>
AVIANLIDAR_ALWAYS_INLINE PlaneRange rangeOnPlane(
  const Corners& t, const TrianglePlane& p, double dx, double dy, double dz)
{
  const auto along = [dx, dy, dz](const Vec3& v) { return (v.x * dx + v.y * dy) + v.z * dz; };
  const double slope = along(p.normal);
  // |slope| is twice the projected area.
  const double size = std::fabs(slope);
  const bool faces = p.height * slope > 0.0;
  const double range = p.height / slope;
  if constexpr (View == PlaneView::Inside)
  {
    return { range, static_cast<int>(faces) * (2 - static_cast<int>(range > 0.0)) };
  }
  const double za = along(t.a);
  const double zb = along(t.b);
  const double zc = along(t.c);
  const double lower = za < zb ? (za < zc ? za : zc) : (zb < zc ? zb : zc);
  const double upper = za > zb ? (za > zc ? za : zc) : (zb > zc ? zb : zc);
  const double raised = range < lower ? lower : range;
  const double clamped = raised > upper ? upper : raised;
  if constexpr (View == PlaneView::WellShaped)
  {
    return { clamped, static_cast<int>(faces & (clamped > 0.0)) };
  }
  const bool well = size >= WellShaped * p.longestSquared;
  const double sign = p.height > 0.0 ? 1.0 : -1.0;
  bool inside = sign * along(p.sides[0].e) >= p.leastEdge;
  inside &= sign * along(p.sides[1].e) >= p.leastEdge;
  inside &= sign * along(p.sides[2].e) >= p.leastEdge;
  inside &= size >= p.leastSlope;
  const double result = well ? clamped : range;
  const bool stands = (well | inside) & (result > 0.0);
  const int kind = 2 * static_cast<int>(!well & !stands) + static_cast<int>(stands);
  return { result, static_cast<int>(faces) * kind };
}

/// PlaneView of all rays of a cone, with a margin for rounding. @param sine,cosine sine and cosine
/// of the half-angle
PlaneView viewOfCone(const TrianglePlane& plane, const Vec3& axis, double sine, double cosine);

/// Range of a ray on a sliver, m: the plane's range, clamped to the part of the triangle beside the
/// ray. NoRange if there is no such part. @param angularMargin as for rangeOf()
double rangeOnSliver(const Corners& t, const Vec3& d, double planeRange, double angularMargin);

/// Range, m, of a ray along the unit direction `d` whose edge functions were accepted. NoRange if
/// the triangle is edge-on or behind the ray's origin, or if the ray passes beside the end of a
/// needle.
/// @param angularMargin half-width of the ray, rad: beamRayMargin() for rays of a beam, 0 for other
/// rays
double rangeOf(
  const Corners& corners, const TrianglePlane& plane, const Vec3& d, double angularMargin);

inline double beamRayMargin(const BeamFrame& frame)
{
  return 32.0 * RoundOffSingle * frame.tanHalf;
}

/// 2^-k for a magnitude in [2^k, 2^(k+1)); 1 for zero.
AVIANLIDAR_ALWAYS_INLINE double inversePowerOfTwo(double magnitude)
{
  std::uint64_t bits;
  std::memcpy(&bits, &magnitude, sizeof bits);
  const std::uint64_t exponent = (bits >> 52) & 0x7ffu;
  if (exponent == 0 || exponent >= 0x7fdu)
  {
    return 1.0;
  }
  bits = (0x7feu - exponent) << 52;
  double power;
  std::memcpy(&power, &bits, sizeof power);
  return power;
}

/// Unit vector, without overflow or underflow. Scaling by a power of two changes no bit of the
/// result.
Vec3 unitDirection(const Vec3& direction);

/// unitDirection() for loops over lanes.
AVIANLIDAR_ALWAYS_INLINE void unitDirectionOf(
  double x, double y, double z, double& dx, double& dy, double& dz)
{
  const double ax = std::fabs(x);
  const double ay = std::fabs(y);
  const double az = std::fabs(z);
  const double ayz = ay > az ? ay : az;
  const double scale = inversePowerOfTwo(ax > ayz ? ax : ayz);
  const double sx = x * scale;
  const double sy = y * scale;
  const double sz = z * scale;
  const double inverse = 1.0 / std::sqrt((sx * sx + sy * sy) + sz * sz);
  dx = sx * inverse;
  dy = sy * inverse;
  dz = sz * inverse;
}

/// Edge function of a side in the beam's plane, positive inside the triangle.
struct BeamEdge
{
  double x, y, z, tolerance;
  /// Edge function plus its tolerance; not negative if the ray is accepted.
  double slack(double rayX, double rayY) const
  {
    return ((this->x * rayX + this->y * rayY) + this->z) + this->tolerance;
  }
};

/// Turns edge vectors into edge functions in the beam's plane.
struct BeamPlaneMap
{
  Vec3 e1, e2, axis; ///< axes of the beam, e1 and e2 times tan(theta0.5)
  double spreadFactor;

  explicit BeamPlaneMap(const BeamFrame& frame)
    : e1(frame.tanHalf * frame.e1)
    , e2(frame.tanHalf * frame.e2)
    , axis(frame.axis)
    , spreadFactor((8.0 + 14.0 * frame.tanHalf) * RoundOffDouble)
  {
  }

  BeamEdge edge(const EdgeVector& v, double sign) const
  {
    const Vec3 e(glm::dot(v.e, this->e1), glm::dot(v.e, this->e2), glm::dot(v.e, this->axis));
    const double size = std::fabs(e.x) + std::fabs(e.y) + std::fabs(e.z);
    return { sign * e.x, sign * e.y, sign * e.z,
      4.0 * RoundOffDouble * size + this->spreadFactor * v.spread };
  }
};

/// The three edge functions of a triangle for one beam.
struct BeamTriangle
{
  BeamEdge edges[3] = {};

  /// @return false if the triangle is seen edge-on, so that no ray hits it
  bool set(const BeamPlaneMap& map, const Corners& t)
  {
    const EdgeVector sides[3] = { edgeVector(t.a, t.b), edgeVector(t.b, t.c),
      edgeVector(t.c, t.a) };
    return this->set(map, t, sides);
  }

  /// Set the edge functions from given edge vectors of the sides (TrianglePlane).
  bool set(const BeamPlaneMap& map, const Corners& t, const EdgeVector* sides)
  {
    const double determinant = glm::dot(t.c, sides[0].e);
    if (determinant == 0.0)
    {
      return false;
    }
    const double sign = determinant > 0.0 ? 1.0 : -1.0;
    for (int i = 0; i < 3; ++i)
    {
      this->edges[i] = map.edge(sides[i], sign);
    }
    return true;
  }

  bool accepts(double x, double y) const
  {
    return this->edges[0].slack(x, y) >= 0.0 && this->edges[1].slack(x, y) >= 0.0 &&
      this->edges[2].slack(x, y) >= 0.0;
  }
};

/// BeamTriangle::set() and accepts() for one ray, stopping at the first edge that rejects the ray.
inline bool beamRayAccepted(const BeamPlaneMap& map, const Corners& t, double x, double y)
{
  const EdgeVector ab = edgeVector(t.a, t.b);
  const double determinant = glm::dot(t.c, ab.e);
  if (determinant == 0.0)
  {
    return false;
  }
  const double sign = determinant > 0.0 ? 1.0 : -1.0;
  return map.edge(ab, sign).slack(x, y) >= 0.0 &&
    map.edge(edgeVector(t.b, t.c), sign).slack(x, y) >= 0.0 &&
    map.edge(edgeVector(t.c, t.a), sign).slack(x, y) >= 0.0;
}

/// True if the triangle accepts a ray from any point along the unit direction `d`. @param t corners
/// relative to the ray's origin
inline bool rayAccepted(const Corners& t, const Vec3& d)
{
  const EdgeVector ab = edgeVector(t.a, t.b);
  const double determinant = glm::dot(t.c, ab.e);
  if (determinant == 0.0)
  {
    return false;
  }
  const double sign = determinant > 0.0 ? 1.0 : -1.0;
  const auto inside = [&](const EdgeVector& v)
  { return sign * glm::dot(v.e, d) + 12.0 * RoundOffDouble * v.spread >= 0.0; };
  return inside(ab) && inside(edgeVector(t.b, t.c)) && inside(edgeVector(t.c, t.a));
}
}

#endif
