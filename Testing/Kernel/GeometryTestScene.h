// SPDX-License-Identifier: BSD-3-Clause
// Scenes and an oracle for the tests of the kernel's geometry. The oracle shares no code with the
// kernel: Moeller and Trumbore's test, in long double, triangle after triangle.
#ifndef avianlidar_GeometryTestScene_h
#define avianlidar_GeometryTestScene_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "OneBeamTracer.h"
#include "TriangleMesh.h"
#include "VolumeTree.h"

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

namespace geometrytest
{
using avianlidar::BeamFrame;
using avianlidar::BeamRays;
using avianlidar::BoundingVolumeType;
using avianlidar::CollisionTree;
using avianlidar::Hit;
using avianlidar::SplitRule;
using avianlidar::TreeOptions;
using avianlidar::TriangleMesh;
using avianlidar::Vec3;

using avianlidar::Pi;

class Numbers
{
public:
  explicit Numbers(std::uint64_t seed)
    : Engine(seed)
  {
  }
  /// Uniform in [0, 1).
  double operator()() { return static_cast<double>(this->Engine() >> 11) * 0x1p-53; }
  double operator()(double lower, double upper) { return lower + (upper - lower) * (*this)(); }
  double logUniform(double lower, double upper)
  {
    return lower * std::pow(upper / lower, (*this)());
  }
  std::size_t index(std::size_t count) { return static_cast<std::size_t>(this->Engine() % count); }
  Vec3 inCube(double half)
  {
    const double x = (*this)(-half, half);
    const double y = (*this)(-half, half);
    return { x, y, (*this)(-half, half) };
  }
  Vec3 direction()
  {
    const double z = (*this)(-1.0, 1.0);
    const double phi = (*this)(0.0, 2.0 * Pi);
    const double r = std::sqrt(1.0 - z * z);
    return { r * std::cos(phi), r * std::sin(phi), z };
  }
  /// Uniform in the unit disc.
  std::pair<double, double> inDisc()
  {
    const double r = std::sqrt((*this)());
    const double phi = (*this)(0.0, 2.0 * Pi);
    return { r * std::cos(phi), r * std::sin(phi) };
  }

private:
  std::mt19937_64 Engine;
};

inline void addTriangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c)
{
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), { a, b, c });
  mesh.triangles.push_back({ first, first + 1, first + 2 });
}

/// Closed sphere-like surface about the origin: an octahedron refined `levels` times, points moved
/// to radius(direction).
template <class Radius>
TriangleMesh closedSurface(int levels, Radius&& radius)
{
  TriangleMesh mesh;
  mesh.points = { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { 0, 0, -1 } };
  mesh.triangles = { { 0, 2, 4 }, { 2, 1, 4 }, { 1, 3, 4 }, { 3, 0, 4 }, { 2, 0, 5 }, { 1, 2, 5 },
    { 3, 1, 5 }, { 0, 3, 5 } };
  for (int level = 0; level < levels; ++level)
  {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto between = [&](std::uint32_t a, std::uint32_t b)
    {
      const auto key = std::minmax(a, b);
      const auto found = middle.find(key);
      if (found != middle.end())
      {
        return found->second;
      }
      const auto number = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(glm::normalize(mesh.points[a] + mesh.points[b]));
      middle[key] = number;
      return number;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& t : mesh.triangles)
    {
      const std::uint32_t ab = between(t[0], t[1]);
      const std::uint32_t bc = between(t[1], t[2]);
      const std::uint32_t ca = between(t[2], t[0]);
      finer.push_back({ t[0], ab, ca });
      finer.push_back({ ab, t[1], bc });
      finer.push_back({ ca, bc, t[2] });
      finer.push_back({ ab, bc, ca });
    }
    mesh.triangles = finer;
  }
  for (Vec3& p : mesh.points)
  {
    p *= radius(p);
  }
  return mesh;
}

struct Vec3L
{
  long double x, y, z;
};
inline Vec3L operator-(const Vec3L& a, const Vec3L& b)
{
  return { a.x - b.x, a.y - b.y, a.z - b.z };
}
inline Vec3L operator+(const Vec3L& a, const Vec3L& b)
{
  return { a.x + b.x, a.y + b.y, a.z + b.z };
}
inline Vec3L operator*(long double s, const Vec3L& a)
{
  return { s * a.x, s * a.y, s * a.z };
}
inline long double dot(const Vec3L& a, const Vec3L& b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3L cross(const Vec3L& a, const Vec3L& b)
{
  return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
inline Vec3L wide(const Vec3& v)
{
  return { v.x, v.y, v.z };
}
inline Vec3L unit(const Vec3L& v)
{
  return (1.0L / std::sqrt(dot(v, v))) * v;
}

/// What the oracle knows of a ray and one triangle.
struct PairResult
{
  bool hit = false;
  long double range = 0.0L;
  long double cosine = 0.0L; ///< |cos| of the incidence angle
  /// Angle between the ray and the triangle's boundary, rad, and the range there.
  long double edgeAngle = 10.0L;
  long double edgeRange = 0.0L;
  long double size = 0.0L; ///< largest distance of a corner
};

/// The widest floating-point type at hand: a needle takes 1e9 times the relative precision of its
/// range.
#if defined(__SIZEOF_FLOAT128__)
using Widest = __float128;
#else
using Widest = long double;
#endif

/// Range on the plane of a, b, c (relative to the ray's origin) along d.
inline long double planeRange(const Vec3L& a, const Vec3L& b, const Vec3L& c, const Vec3L& d)
{
  const Widest ux = Widest(b.x) - a.x;
  const Widest uy = Widest(b.y) - a.y;
  const Widest uz = Widest(b.z) - a.z;
  const Widest vx = Widest(c.x) - a.x;
  const Widest vy = Widest(c.y) - a.y;
  const Widest vz = Widest(c.z) - a.z;
  const Widest nx = uy * vz - uz * vy;
  const Widest ny = uz * vx - ux * vz;
  const Widest nz = ux * vy - uy * vx;
  return static_cast<long double>(
    (nx * a.x + ny * a.y + nz * a.z) / (nx * d.x + ny * d.y + nz * d.z));
}

inline void nearBoundary(Vec3L p, Vec3L q, const Vec3L& d, PairResult& result)
{
  if (dot(p, d) > dot(q, d))
  {
    std::swap(p, q);
  }
  const long double zp = dot(p, d);
  const long double zq = dot(q, d);
  if (!(zq > 0.0L))
  {
    return;
  }
  // In the plane across the ray at unit range the side is straight: from q to p, or where p lies
  // behind, on and on.
  const Vec3L p2 = p - zp * d;
  const Vec3L q2 = q - zq * d;
  const bool ahead = zp > 0.0L;
  const Vec3L from = (1.0L / zq) * q2;
  const Vec3L along = ahead ? (1.0L / zp) * p2 - from : (1.0L / (zq * zq)) * (zq * p2 - zp * q2);
  const long double squared = dot(along, along);
  const long double furthest = ahead ? 1.0L : std::numeric_limits<long double>::infinity();
  const long double t =
    squared > 0.0L ? std::fmin(furthest, std::fmax(0.0L, -dot(from, along) / squared)) : 0.0L;
  const Vec3L nearest = from + t * along;
  const long double angle = std::sqrt(dot(nearest, nearest));
  if (angle < result.edgeAngle)
  {
    result.edgeAngle = angle;
    const long double z =
      ahead ? 1.0L / ((1.0L - t) / zq + t / zp) : zq * zq / (zq + t * (zq - zp));
    result.edgeRange = ahead && squared < 1e-20L ? zp : z;
  }
}

/// @param d unit direction
inline PairResult testPair(
  const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin, const Vec3L& d)
{
  const Vec3L o = wide(origin);
  const Vec3L a = wide(mesh.corner(triangle, 0)) - o;
  const Vec3L b = wide(mesh.corner(triangle, 1)) - o;
  const Vec3L c = wide(mesh.corner(triangle, 2)) - o;
  PairResult result;
  const Vec3L ab = b - a;
  const Vec3L ac = c - a;
  const Vec3L h = cross(d, ac);
  const long double det = dot(ab, h);
  const Vec3L n = cross(ab, ac);
  const long double area = std::sqrt(dot(n, n));
  if (area > 0.0L && det != 0.0L && dot(n, a) != 0.0L)
  {
    const Vec3L s = -1.0L * a;
    const Vec3L q = cross(s, ab);
    const long double u = dot(s, h) / det;
    const long double v = dot(d, q) / det;
    result.range = dot(ac, q) / det;
    result.hit = u >= 0.0L && v >= 0.0L && u + v <= 1.0L && result.range > 0.0L;
    result.cosine = std::fabs(dot(n, d)) / area;
    if (result.hit)
    {
      result.range = planeRange(a, b, c, d);
    }
  }
  nearBoundary(a, b, d, result);
  nearBoundary(b, c, d, result);
  nearBoundary(c, a, d, result);
  result.size = std::sqrt(std::fmax(dot(a, a), std::fmax(dot(b, b), dot(c, c))));
  return result;
}

struct OracleHit
{
  std::uint32_t triangle = avianlidar::NoTriangle;
  long double range = INFINITY;
  long double cosine = 1.0L;
  bool nearEdge = false; ///< an edge of a triangle is near the ray, at or before the hit
};

/// Nearest hit by brute force. `tolerance` (rad) is what counts as near an edge.
inline OracleHit bruteForce(
  const TriangleMesh& mesh, const Vec3& origin, const Vec3L& d, long double tolerance)
{
  OracleHit best;
  long double nearestEdge = INFINITY;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const PairResult pair = testPair(mesh, t, origin, d);
    if (pair.hit && pair.range < best.range)
    {
      best.triangle = t;
      best.range = pair.range;
      best.cosine = pair.cosine;
    }
    // Corners are rounded when they are moved to the apex: the second term.
    const long double z = pair.edgeRange;
    if (z > 0.0L && pair.edgeAngle <= tolerance + 16.0L * 0x1p-53L * pair.size / z)
    {
      nearestEdge = std::fmin(nearestEdge, z);
    }
  }
  best.nearEdge = std::isfinite(nearestEdge) && nearestEdge <= best.range * (1.0L + 1e-6L);
  return best;
}

inline Vec3L rayDirection(const BeamFrame& frame, double x, double y)
{
  const long double tan = frame.tanHalf;
  return unit(wide(frame.axis) +
    tan *
      (static_cast<long double>(x) * wide(frame.e1) +
        static_cast<long double>(y) * wide(frame.e2)));
}

inline BeamRays raysInDisc(Numbers& random, std::size_t count)
{
  BeamRays rays;
  rays.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    std::tie(rays.x[i], rays.y[i]) = random.inDisc();
  }
  return rays;
}

/// Neighbouring beams: a window of rows and columns about `middle`, `step` rad apart.
inline std::vector<BeamFrame> window(
  const Vec3& apex, const Vec3& middle, int columns, int rows, double step, double halfBeamwidth)
{
  const BeamFrame about = avianlidar::makeBeamFrame(apex, middle, 0.5);
  std::vector<BeamFrame> frames;
  for (int c = 0; c < columns; ++c)
  {
    for (int r = 0; r < rows; ++r)
    {
      const double u = step * (c - 0.5 * (columns - 1));
      const double v = step * (r - 0.5 * (rows - 1));
      frames.push_back(
        avianlidar::makeBeamFrame(apex, about.axis + u * about.e1 + v * about.e2, halfBeamwidth));
    }
  }
  return frames;
}

/// Triangles of about `size` in a cube of half width `half`.
inline TriangleMesh randomTriangles(Numbers& random, std::size_t count, double half, double size)
{
  TriangleMesh mesh;
  for (std::size_t i = 0; i < count; ++i)
  {
    const Vec3 center = random.inCube(half);
    const Vec3 a = center + random.inCube(size);
    const Vec3 b = center + random.inCube(size);
    addTriangle(mesh, a, b, center + random.inCube(size));
  }
  return mesh;
}

/// True if a volume of a tree holds a point.
inline bool contains(const avianlidar::OBB& v, const Vec3& p)
{
  return glm::all(glm::lessThanEqual(glm::abs(v.along(p - v.center)), v.half));
}
inline bool contains(const avianlidar::BoundingSphere& v, const Vec3& p)
{
  return v.radius >= 0.0 && glm::length(p - v.center) <= v.radius;
}

/// Same triangle, same bits of the range.
inline bool sameBits(const Hit& a, const Hit& b)
{
  return a.triangle == b.triangle && std::memcmp(&a.range, &b.range, sizeof a.range) == 0;
}

/// Every split rule and volume, with these sizes of leaves.
inline std::vector<TreeOptions> allTreeOptions(std::initializer_list<int> leafSizes)
{
  std::vector<TreeOptions> all;
  for (int rule = 0; rule < 4; ++rule)
  {
    for (int volume = 0; volume < 3; ++volume)
    {
      for (const int leafSize : leafSizes)
      {
        all.push_back(
          { static_cast<SplitRule>(rule), static_cast<BoundingVolumeType>(volume), leafSize });
      }
    }
  }
  return all;
}

/// Every split rule, volume, two sizes of leaves, and boxes in double precision.
inline std::vector<std::shared_ptr<const CollisionTree>> allTrees(
  const std::shared_ptr<const TriangleMesh>& mesh)
{
  std::vector<TreeOptions> all = allTreeOptions({ 1, 4 });
  all.insert(all.begin(), { SplitRule::SurfaceAreaHeuristic, BoundingVolumeType::BinaryAABB, 4 });
  std::vector<std::shared_ptr<const CollisionTree>> trees;
  for (const TreeOptions& options : all)
  {
    trees.push_back(buildVolumeTree(mesh, options));
  }
  return trees;
}
}

#endif
