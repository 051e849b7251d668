// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTriangles.h"

#include "Multiversion.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr int LaneCount = 8;
using Lane = double[LaneCount];

struct Three
{
  double x, y, z;
};

AVIANLIDAR_ALWAYS_INLINE Three less(const Three& a, const Three& b)
{
  return { a.x - b.x, a.y - b.y, a.z - b.z };
}

AVIANLIDAR_ALWAYS_INLINE double dot(const Three& a, const Three& b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

AVIANLIDAR_ALWAYS_INLINE double least(double a, double b)
{
  return a < b ? a : b;
}

AVIANLIDAR_ALWAYS_INLINE double most(double a, double b)
{
  return a > b ? a : b;
}

AVIANLIDAR_ALWAYS_INLINE double largest(const Three& a)
{
  return most(std::fabs(a.x), most(std::fabs(a.y), std::fabs(a.z)));
}

/// edgeVector(): the bits change their signs alone where the corners change places.
AVIANLIDAR_ALWAYS_INLINE Three edgeOf(const Three& a, const Three& b)
{
  const Three d = less(a, b);
  const Three s{ a.x + b.x, a.y + b.y, a.z + b.z };
  return { d.y * s.z - d.z * s.y, d.z * s.x - d.x * s.z, d.x * s.y - d.y * s.x };
}

/// As in planeOf().
AVIANLIDAR_ALWAYS_INLINE double differenceOf(double a, double b, double c, double d)
{
  const double cd = c * d;
  const double error = std::fma(-c, d, cd);
  return std::fma(a, b, -cd) + error;
}

/// The beam's plane.
struct Plane
{
  Three e1, e2, axis; ///< e1 and e2 times tan(theta0.5)
};

/// A side in the beam's plane.
struct Side
{
  double x, y, z;
  double crosses; ///< 1: it meets the octagon
  double outside; ///< 1: the octagon lies outside
};

AVIANLIDAR_ALWAYS_INLINE Side sideOf(const Three& edge, double sign, const Plane& plane)
{
  const double x = sign * dot(edge, plane.e1);
  const double y = sign * dot(edge, plane.e2);
  const double z = sign * dot(edge, plane.axis);
  const double slope = std::sqrt(x * x + y * y);
  const double reach = slope > 0.0 ? OutRadius * slope : -1.0;
  const double crosses = std::fabs(z) <= reach ? 1.0 : 0.0;
  const double outside = z > 0.0 ? 0.0 : 1.0 - crosses;
  const double divisor = crosses > 0.0 ? slope : 1.0;
  return { x / divisor, y / divisor, z / divisor, crosses, outside };
}

/// 1 if the centre of the disc is not outside, else 0.
AVIANLIDAR_ALWAYS_INLINE double holdsCentre(const Side& side)
{
  const double inside = side.z >= 0.0 ? 1.0 : 0.0;
  return side.crosses > 0.0 ? inside : 1.0;
}

/// The part of a side in the disc, from the middle of its chord.
struct Chord
{
  double from, to;
};

/// Cut the chord of a side by another side.
AVIANLIDAR_ALWAYS_INLINE Chord cut(const Chord& chord, const Side& side, const Side& other)
{
  const double value = -side.z * (other.x * side.x + other.y * side.y) + other.z;
  const double slope = other.y * side.x - other.x * side.y;
  const double at = -value / (slope == 0.0 ? 1.0 : slope);
  const double from = slope > 0.0 ? most(chord.from, at) : chord.from;
  const double end = slope < 0.0 ? least(chord.to, at) : chord.to;
  const double beside = value < 0.0 ? chord.from : end; // of a parallel side
  const double to = slope == 0.0 ? beside : end;
  return { other.crosses > 0.0 ? from : chord.from, other.crosses > 0.0 ? to : chord.to };
}

/// 1 if the triangle's side `one` has a part in the disc, else 0. No truth values: they keep the
/// compiler from using lanes.
AVIANLIDAR_ALWAYS_INLINE double hasPart(const Side& one, const Side& two, const Side& three)
{
  const double square = 1.0 - one.z * one.z;
  const double half = std::sqrt(most(0.0, square));
  const Chord chord = cut(cut({ -half, half }, one, two), one, three);
  return chord.from < chord.to ? one.crosses : 0.0;
}

AVIANLIDAR_MULTIVERSION void setUpLanes(const Plane& plane, double tangent2, const double* corners,
  double* lines, double* crosses, double* inverse, double* bounds)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
#pragma omp simd
  for (int i = 0; i < LaneCount; ++i)
  {
    const Three a{ corners[i], corners[LaneCount + i], corners[2 * LaneCount + i] };
    const Three b{ corners[3 * LaneCount + i], corners[4 * LaneCount + i],
      corners[5 * LaneCount + i] };
    const Three c{ corners[6 * LaneCount + i], corners[7 * LaneCount + i],
      corners[8 * LaneCount + i] };
    // The plane, as in planeOf().
    const Three ab = less(b, a);
    const Three ac = less(c, a);
    const Three bc = less(c, b);
    const Three n{ differenceOf(ab.y, ac.z, ab.z, ac.y), differenceOf(ab.z, ac.x, ab.x, ac.z),
      differenceOf(ab.x, ac.y, ab.y, ac.x) };
    const double longest2 = most(dot(ab, ab), most(dot(ac, ac), dot(bc, bc)));
    const double height = largest(n) <= 4.0 * RoundOffDouble * longest2 ? 0.0 : dot(n, a);
    const Three e0 = edgeOf(a, b);
    const double determinant = dot(c, e0);
    const double sign = determinant > 0.0 ? 1.0 : -1.0;
    const Side s0 = sideOf(e0, sign, plane);
    const Side s1 = sideOf(edgeOf(b, c), sign, plane);
    const Side s2 = sideOf(edgeOf(c, a), sign, plane);
    const double faces = determinant == 0.0 ? 0.0 : height;
    const double seen = (s0.outside + s1.outside) + s2.outside > 0.0 ? 0.0 : faces;
    const double enters = holdsCentre(s0) * holdsCentre(s1) * holdsCentre(s2) +
      hasPart(s0, s1, s2) + hasPart(s1, s2, s0) + hasPart(s2, s0, s1);
    const double perHeight = 1.0 / (height == 0.0 ? 1.0 : height);
    const double wx = dot(n, plane.e1) * perHeight;
    const double wy = dot(n, plane.e2) * perHeight;
    const double wz = dot(n, plane.axis) * perHeight;
    const double za = dot(a, plane.axis);
    const double zb = dot(b, plane.axis);
    const double zc = dot(c, plane.axis);
    const double nearest = least(za, least(zb, zc));
    const double farthest2 = most(dot(a, a), most(dot(b, b), dot(c, c)));
    const double inOctagon = wz + OutRadius * std::sqrt(wx * wx + wy * wy);
    const double nearestInverse = nearest > 0.0 ? 1.0 / nearest : infinity;
    const double depths = za * zb * zc * tangent2;
    lines[i] = s0.x;
    lines[LaneCount + i] = s0.y;
    lines[2 * LaneCount + i] = s0.z;
    lines[3 * LaneCount + i] = s1.x;
    lines[4 * LaneCount + i] = s1.y;
    lines[5 * LaneCount + i] = s1.z;
    lines[6 * LaneCount + i] = s2.x;
    lines[7 * LaneCount + i] = s2.y;
    lines[8 * LaneCount + i] = s2.z;
    crosses[i] = s0.crosses;
    crosses[LaneCount + i] = s1.crosses;
    crosses[2 * LaneCount + i] = s2.crosses;
    inverse[i] = wx;
    inverse[LaneCount + i] = wy;
    inverse[2 * LaneCount + i] = wz;
    bounds[i] = least(inOctagon, nearestInverse);
    bounds[LaneCount + i] = 1.0 / std::sqrt(farthest2);
    bounds[2 * LaneCount + i] = std::fabs(height) / std::sqrt(dot(n, n));
    bounds[3 * LaneCount + i] = nearest > 0.0 ? 0.5 * std::fabs(determinant) / depths : infinity;
    bounds[4 * LaneCount + i] = seen == 0.0 ? 0.0 : enters;
  }
}
}

void BeamTriangles::begin(const BeamFrame& frame)
{
  this->Frame = frame;
  this->Triangles.begin(*this->Mesh, frame.origin);
  this->Waiting.clear();
  this->Surfaces.clear();
  this->Crosses.clear();
}

std::size_t BeamTriangles::add(const std::uint32_t* triangles, std::size_t count)
{
  this->Waiting.insert(this->Waiting.end(), triangles, triangles + count);
  std::size_t done = 0;
  for (; done + LaneCount <= this->Waiting.size(); done += LaneCount)
  {
    this->setUp(this->Waiting.data() + done, LaneCount);
  }
  this->Waiting.erase(this->Waiting.begin(), this->Waiting.begin() + done);
  return this->Surfaces.size();
}

std::size_t BeamTriangles::finish()
{
  this->setUp(this->Waiting.data(), this->Waiting.size());
  this->Waiting.clear();
  return this->Surfaces.size();
}

/// Set up at most LaneCount triangles, and keep those that enter.
void BeamTriangles::setUp(const std::uint32_t* triangles, std::size_t count)
{
  if (count == 0)
  {
    return;
  }
  Lane corners[9], lines[9], crosses[3], inverse[3], bounds[5];
  for (std::size_t i = 0; i < LaneCount; ++i)
  {
    const Corners t = cornersFrom(*this->Mesh, triangles[i < count ? i : 0], this->Frame.origin);
    const Vec3* const all[] = { &t.a, &t.b, &t.c };
    for (int k = 0; k < 3; ++k)
    {
      corners[3 * k][i] = all[k]->x;
      corners[3 * k + 1][i] = all[k]->y;
      corners[3 * k + 2][i] = all[k]->z;
    }
  }
  const auto three = [](const Vec3& v) { return Three{ v.x, v.y, v.z }; };
  const BeamFrame& frame = this->Frame;
  const Plane plane{ three(frame.tanHalf * frame.e1), three(frame.tanHalf * frame.e2),
    three(frame.axis) };
  setUpLanes(
    plane, frame.tanHalf * frame.tanHalf, corners[0], lines[0], crosses[0], inverse[0], bounds[0]);
  for (std::size_t i = 0; i < count; ++i)
  {
    if (bounds[4][i] == 0.0)
    {
      continue;
    }
    this->Surfaces.emplace_back();
    BeamSurface& s = this->Surfaces.back();
    s.triangle = triangles[i];
    s.other = NoTriangle;
    s.number = static_cast<std::uint32_t>(this->Crosses.size());
    std::uint8_t bits = 0;
    for (int k = 0; k < 3; ++k)
    {
      s.lines[k] = { lines[3 * k][i], lines[3 * k + 1][i], lines[3 * k + 2][i] };
      bits |= crosses[k][i] > 0.0 ? 1u << k : 0u;
    }
    this->Crosses.push_back(bits);
    s.inverse = { inverse[0][i], inverse[1][i], inverse[2][i] };
    s.mostInverse = bounds[0][i];
    s.leastInverse = bounds[1][i];
    s.height = bounds[2][i];
    s.area = bounds[3][i];
  }
}

const std::vector<BeamSurface>& BeamTriangles::sort()
{
  std::vector<BeamSurface>& all = this->Surfaces;
  std::vector<std::pair<double, std::uint32_t>>& order = this->Order;
  order.clear();
  for (std::uint32_t i = 0; i < all.size(); ++i)
  {
    order.emplace_back(all[i].triangle, i);
  }
  std::sort(order.begin(), order.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    BeamSurface& s = all[order[i].second];
    const bool joined = i + 1 < order.size() && order[i + 1].first == order[i].first + 1.0 &&
      this->join(s, all[order[i + 1].second]);
    for (int k = 0; k < 3 && !joined; ++k)
    {
      if ((this->Crosses[s.number] >> k & 1u) != 0u)
      {
        s.lines[s.count++] = s.lines[k];
      }
    }
    order[kept++] = { -s.mostInverse, order[i].second };
    i += joined ? 1 : 0;
  }
  order.resize(kept);
  std::sort(order.begin(), order.end(),
    [&](const auto& a, const auto& b)
    {
      return a.first < b.first ||
        (a.first == b.first && all[a.second].triangle < all[b.second].triangle);
    });
  this->Ordered.clear();
  for (const auto& [inverse, number] : order)
  {
    this->Ordered.push_back(all[number]);
  }
  all.swap(this->Ordered);
  return all;
}

/// Join two triangles if they have a side and a plane in common, and together are convex.
/// @param two with the number after that of `one` @return true if they were joined
bool BeamTriangles::join(BeamSurface& one, const BeamSurface& two)
{
  constexpr double apart = 1e-6;
  const double size =
    std::fabs(one.inverse.x) + std::fabs(one.inverse.y) + std::fabs(one.inverse.z);
  if (std::fabs(one.inverse.x - two.inverse.x) + std::fabs(one.inverse.y - two.inverse.y) +
      std::fabs(one.inverse.z - two.inverse.z) >
    apart * size)
  {
    return false; // not in one plane, whatever the rounding
  }
  const ExactTriangle first = this->Triangles[one.triangle];
  const ExactTriangle second = this->Triangles[two.triangle];
  const Vec3* const p[] = { &first.corners.a, &first.corners.b, &first.corners.c };
  const Vec3* const q[] = { &second.corners.a, &second.corners.b, &second.corners.c };
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      const Vec3& a = *p[i];
      const Vec3& b = *p[(i + 1) % 3];
      const Vec3& c = *q[j];
      const Vec3& d = *q[(j + 1) % 3];
      if (!(a == d && b == c) && !(a == c && b == d))
      {
        continue;
      }
      const Vec3& farOne = *p[(i + 2) % 3];
      const Vec3& farTwo = *q[(j + 2) % 3];
      const Vec3& n = first.plane.normal;
      // In scene coordinates far from their origin corners are rounded, and a scene that was moved
      // there is to be seen as before.
      constexpr double flat = 1e-13;
      constexpr double rounding = 1e-15;
      const double aside = std::sqrt(glm::dot(n, n)) *
        (flat * std::sqrt(std::max(first.plane.longestSquared, second.plane.longestSquared)) +
          rounding * (safeLength(this->Frame.origin) + safeLength(farTwo)));
      const auto inside = [](const ExactTriangle& t, int side, const Vec3& v)
      { return (t.plane.height > 0.0) == (glm::dot(t.plane.sides[side].e, v) > 0.0); };
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      if (!(std::fabs(glm::dot(n, farTwo) - first.plane.height) <= aside) ||
        inside(first, i, farTwo) || !inside(first, i1, farTwo) || !inside(first, i2, farTwo) ||
        !inside(second, j1, farOne) || !inside(second, j2, farOne))
      {
        return false;
      }
      const std::uint8_t ofOne = this->Crosses[one.number];
      const std::uint8_t ofTwo = this->Crosses[two.number];
      const BeamSurface own = one;
      one.diagonal = (ofOne >> i & 1u) != 0u ? own.lines[i] : PlaneLine{ 0.0, 0.0, 1.0 };
      for (const int side : { i1, i2 })
      {
        if ((ofOne >> side & 1u) != 0u)
        {
          one.lines[one.count++] = own.lines[side];
        }
      }
      for (const int side : { j1, j2 })
      {
        if ((ofTwo >> side & 1u) != 0u)
        {
          one.lines[one.count++] = two.lines[side];
        }
      }
      one.other = two.triangle;
      one.area += two.area;
      one.mostInverse = std::max(one.mostInverse, two.mostInverse);
      one.leastInverse = std::min(one.leastInverse, two.leastInverse);
      return true;
    }
  }
  return false;
}
}
