// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTriangles.h"

#include "KeySort.h"
#include "Multiversion.h"

#include <algorithm>
#include <cstring>

// This file is compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "BeamTriangles.cxx"
#include <hwy/foreach_target.h>

#include "RayLanes.h"

#ifndef avianlidar_BeamTriangles_lanes
#define avianlidar_BeamTriangles_lanes
namespace avianlidar
{
namespace
{
constexpr int LaneCount = 8;

/// Entries of BeamTriangles::Joints: not computed yet, and not a quadrilateral.
constexpr std::uint8_t Unknown = 255;
constexpr std::uint8_t Apart = 9;

struct EightTriangles
{
  double corners[9][LaneCount]; ///< corners a, b, c relative to the apex, m
  double normal[3][LaneCount];  ///< TrianglePlane::normal
  double onPlane[3][LaneCount]; ///< corner a of the triangle that owns the plane, m
  double lines[9][LaneCount];   ///< sides ab, bc, ca; slope 1, positive inside
  double inverse[3][LaneCount]; ///< 1/z on the plane, 1/m
  double mostInverse[LaneCount], leastInverse[LaneCount], height[LaneCount], area[LaneCount];
  double mostOfPlane[LaneCount]; ///< upper bound of 1/z of the plane in the octagon, 1/m
  std::uint64_t crosses[3];      ///< bits of the triangles whose side k meets the octagon
  std::uint64_t enters;          ///< bits of the triangles that enter the disc
  std::uint64_t inside;          ///< bits of the triangles that lie inside the disc
};

struct PlaneAxes
{
  Vec3 e1, e2, axis; ///< axes; e1 and e2 are multiplied by tan(theta0.5)
  double tangent2;
  double perFlatness2; ///< 1/BeamFrame::flatness2
};
}
}
#endif

HWY_BEFORE_NAMESPACE();
namespace avianlidar::HWY_NAMESPACE
{
namespace
{
using EightTag = hn::CappedTag<double, LaneCount>;
using Eight = hn::Vec<EightTag>;
using EightMask = hn::Mask<EightTag>;
constexpr int EightLanes = static_cast<int>(hn::MaxLanes(EightTag()));

HWY_INLINE Eight all(double value)
{
  return hn::Set(EightTag(), value);
}

struct Three
{
  Eight x, y, z;
};

HWY_INLINE Three load(const double (*values)[LaneCount], int first)
{
  const EightTag lanes;
  return { hn::LoadU(lanes, values[0] + first), hn::LoadU(lanes, values[1] + first),
    hn::LoadU(lanes, values[2] + first) };
}

HWY_INLINE void store(Eight value, double* values, int first)
{
  hn::StoreU(value, EightTag(), values + first);
}

HWY_INLINE Eight dot(const Three& a, const Three& b)
{
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Eight dot(const Three& a, const Vec3& b)
{
  return hn::Add(hn::Add(hn::Mul(a.x, all(b.x)), hn::Mul(a.y, all(b.y))), hn::Mul(a.z, all(b.z)));
}

/// edgeVector() in lanes: exchanging the corners changes nothing but signs, bit for bit.
HWY_INLINE Three edgeOf(const Three& a, const Three& b)
{
  const Three d{ hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z) };
  const Three s{ hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z) };
  return { hn::Sub(hn::Mul(d.y, s.z), hn::Mul(d.z, s.y)),
    hn::Sub(hn::Mul(d.z, s.x), hn::Mul(d.x, s.z)), hn::Sub(hn::Mul(d.x, s.y), hn::Mul(d.y, s.x)) };
}

/// A side in the beam's plane.
struct Side
{
  Eight x, y, z;
  EightMask crosses; ///< true where the side meets the octagon
  EightMask outside; ///< true where the octagon lies outside of the side
};

HWY_INLINE Side sideOf(const Three& edge, Eight sign, const PlaneAxes& plane)
{
  const EightTag lanes;
  const Eight x = hn::Mul(sign, dot(edge, plane.e1));
  const Eight y = hn::Mul(sign, dot(edge, plane.e2));
  const Eight z = hn::Mul(sign, dot(edge, plane.axis));
  const Eight slope = hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y)));
  const EightMask crosses =
    hn::And(hn::Gt(slope, hn::Zero(lanes)), hn::Le(hn::Abs(z), hn::Mul(all(OutRadius), slope)));
  const Eight perSlope = hn::Div(all(1.0), hn::IfThenElse(crosses, slope, all(1.0)));
  return { hn::Mul(x, perSlope), hn::Mul(y, perSlope), hn::Mul(z, perSlope), crosses,
    hn::Not(hn::Or(crosses, hn::Gt(z, hn::Zero(lanes)))) };
}

/// Edge function of a side along the chord that another side cuts from the disc.
struct AlongChord
{
  Eight middle, slope; ///< value at the middle of the chord, and slope
  Eight most;          ///< largest value on the chord
};

HWY_INLINE AlongChord alongChord(const Side& side, const Side& other, Eight half)
{
  const Eight middle =
    hn::Sub(other.z, hn::Mul(side.z, hn::Add(hn::Mul(other.x, side.x), hn::Mul(other.y, side.y))));
  const Eight slope =
    hn::IfThenElseZero(other.crosses, hn::Sub(hn::Mul(other.y, side.x), hn::Mul(other.x, side.y)));
  const Eight value = hn::IfThenElse(other.crosses, middle, all(1.0));
  return { value, slope, hn::Add(value, hn::Mul(half, hn::Abs(slope))) };
}

/// True where a part of the triangle's side `one` lies in the disc.
HWY_INLINE EightMask hasPart(const Side& one, const Side& two, const Side& three)
{
  const Eight zero = hn::Zero(EightTag());
  const Eight half = hn::Sqrt(hn::Max(zero, hn::Sub(all(1.0), hn::Mul(one.z, one.z))));
  const AlongChord a = alongChord(one, two, half);
  const AlongChord b = alongChord(one, three, half);
  // If a and b fall in opposite directions, both are positive between their zeros or nowhere.
  const Eight between =
    hn::Add(hn::Mul(a.middle, hn::Abs(b.slope)), hn::Mul(b.middle, hn::Abs(a.slope)));
  const EightMask both = hn::Or(hn::Gt(between, zero), hn::Ge(hn::Mul(a.slope, b.slope), zero));
  return hn::And(hn::And(one.crosses, hn::Gt(half, zero)),
    hn::And(both, hn::And(hn::Gt(a.most, zero), hn::Gt(b.most, zero))));
}

/// True where a corner lies in the disc. @param z distance of the corner along the axis, m
HWY_INLINE EightMask isInDisc(const Three& corner, Eight z, const PlaneAxes& plane)
{
  const Eight x = dot(corner, plane.e1);
  const Eight y = hn::Mul(dot(corner, plane.e2), all(plane.perFlatness2));
  const Eight reach = hn::Mul(all(plane.tangent2), z);
  return hn::Le(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(reach, reach));
}

HWY_INLINE EightMask holdsCentre(const Side& side)
{
  return hn::Or(hn::Not(side.crosses), hn::Ge(side.z, hn::Zero(EightTag())));
}

void setUpLanes(const PlaneAxes& plane, EightTriangles& t)
{
  const EightTag lanes;
  const Eight zero = hn::Zero(lanes);
  t.crosses[0] = t.crosses[1] = t.crosses[2] = t.enters = t.inside = 0;
  for (int i = 0; i < LaneCount; i += EightLanes)
  {
    const Three a = load(t.corners, i);
    const Three b = load(t.corners + 3, i);
    const Three c = load(t.corners + 6, i);
    const Three n = load(t.normal, i);
    const Eight height = dot(n, load(t.onPlane, i));
    const Three e0 = edgeOf(a, b);
    const Eight determinant = dot(c, e0);
    const Eight sign = hn::IfThenElse(hn::Gt(determinant, zero), all(1.0), all(-1.0));
    const Side sides[3] = { sideOf(e0, sign, plane), sideOf(edgeOf(b, c), sign, plane),
      sideOf(edgeOf(c, a), sign, plane) };
    const EightMask unseen = hn::Or(hn::Or(hn::Eq(determinant, zero), hn::Eq(height, zero)),
      hn::Or(sides[0].outside, hn::Or(sides[1].outside, sides[2].outside)));
    const EightMask centre =
      hn::And(holdsCentre(sides[0]), hn::And(holdsCentre(sides[1]), holdsCentre(sides[2])));
    const EightMask part = hn::Or(hasPart(sides[0], sides[1], sides[2]),
      hn::Or(hasPart(sides[1], sides[2], sides[0]), hasPart(sides[2], sides[0], sides[1])));
    t.enters |= bitsOf(lanes, hn::AndNot(unseen, hn::Or(centre, part))) << i;
    for (int k = 0; k < 3; ++k)
    {
      store(sides[k].x, t.lines[3 * k], i);
      store(sides[k].y, t.lines[3 * k + 1], i);
      store(sides[k].z, t.lines[3 * k + 2], i);
      t.crosses[k] |= bitsOf(lanes, sides[k].crosses) << i;
    }
    const Eight perHeight = hn::Div(all(1.0), height);
    const Eight wx = hn::Mul(dot(n, plane.e1), perHeight);
    const Eight wy = hn::Mul(dot(n, plane.e2), perHeight);
    const Eight wz = hn::Mul(dot(n, plane.axis), perHeight);
    store(wx, t.inverse[0], i);
    store(wy, t.inverse[1], i);
    store(wz, t.inverse[2], i);
    const Eight za = dot(a, plane.axis);
    const Eight zb = dot(b, plane.axis);
    const Eight zc = dot(c, plane.axis);
    const Eight nearest = hn::Min(za, hn::Min(zb, zc));
    const EightMask before = hn::Gt(nearest, zero);
    const EightMask inside =
      hn::And(isInDisc(a, za, plane), hn::And(isInDisc(b, zb, plane), isInDisc(c, zc, plane)));
    t.inside |= bitsOf(lanes, hn::And(before, inside)) << i;
    const Eight inOctagon =
      hn::Add(wz, hn::Mul(all(OutRadius), hn::Sqrt(hn::Add(hn::Mul(wx, wx), hn::Mul(wy, wy)))));
    store(inOctagon, t.mostOfPlane, i);
    store(hn::IfThenElse(before, hn::Min(inOctagon, hn::Div(all(1.0), nearest)), inOctagon),
      t.mostInverse, i);
    const Eight farthest2 = hn::Max(dot(a, a), hn::Max(dot(b, b), dot(c, c)));
    store(hn::Div(all(1.0), hn::Sqrt(farthest2)), t.leastInverse, i);
    store(hn::Div(hn::Abs(height), hn::Sqrt(dot(n, n))), t.height, i);
    const double flatness = std::sqrt(1.0 / plane.perFlatness2);
    const Eight depths = hn::Mul(hn::Mul(za, zb), hn::Mul(zc, all(plane.tangent2 * flatness)));
    const Eight area = hn::Div(hn::Mul(all(0.25), hn::Abs(determinant)), depths);
    store(area, t.area, i);
  }
}
}
}
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace avianlidar
{
HWY_EXPORT(setUpLanes);

void BeamTriangles::begin(const BeamFrame& frame)
{
  this->Frame = frame;
  this->Joints.resize(this->Scene.tree().mesh->size(), Unknown);
  this->Waiting.clear();
  this->Count = 0;
  this->Nearest.clear();
  this->Keys.clear();
}

void BeamTriangles::add(const std::uint32_t* triangles, std::size_t count)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    __builtin_prefetch(&this->Scene.corner(triangles[i], 0));
  }
  this->Waiting.insert(this->Waiting.end(), triangles, triangles + count);
  std::size_t done = 0;
  for (; done + LaneCount <= this->Waiting.size() && this->Count <= this->Most; done += LaneCount)
  {
    this->setUp(this->Waiting.data() + done, LaneCount);
  }
  this->Waiting.erase(this->Waiting.begin(), this->Waiting.begin() + done);
}

std::size_t BeamTriangles::finish()
{
  if (this->Count <= this->Most)
  {
    this->setUp(this->Waiting.data(), this->Waiting.size());
    this->Waiting.clear();
  }
  return this->Count;
}

void BeamTriangles::appendNumbers(std::vector<std::uint32_t>& numbers) const
{
  for (std::size_t k = 0; k < this->Count; ++k)
  {
    numbers.push_back(this->Surfaces[k].triangle);
  }
  numbers.insert(numbers.end(), this->Waiting.begin(), this->Waiting.end());
}

namespace
{
/// TrianglePlane::normal of eight triangles. The function is compiled for every instruction set, so
/// that std::fma() is an instruction and not a call.
AVIANLIDAR_MULTIVERSION void findNormals(const Corners* planes, EightTriangles& t)
{
  for (int i = 0; i < LaneCount; ++i)
  {
    const Vec3 n = normalOf(planes[i]);
    t.normal[0][i] = n.x;
    t.normal[1][i] = n.y;
    t.normal[2][i] = n.z;
  }
}
}

/// Set up at most LaneCount triangles, and keep the triangles that enter the disc.
void BeamTriangles::setUp(const std::uint32_t* triangles, std::size_t count)
{
  if (count == 0)
  {
    return;
  }
  EightTriangles t;
  Corners planes[LaneCount];
  for (std::size_t i = 0; i < LaneCount; ++i)
  {
    const std::uint32_t number = triangles[i < count ? i : 0];
    const std::uint32_t owner = this->Scene.planeOwner(number);
    const Corners c = this->cornersOf(number);
    planes[i] = owner == number ? c : this->cornersOf(owner);
    t.onPlane[0][i] = planes[i].a.x;
    t.onPlane[1][i] = planes[i].a.y;
    t.onPlane[2][i] = planes[i].a.z;
    const Vec3* const all[] = { &c.a, &c.b, &c.c };
    for (int k = 0; k < 3; ++k)
    {
      t.corners[3 * k][i] = all[k]->x;
      t.corners[3 * k + 1][i] = all[k]->y;
      t.corners[3 * k + 2][i] = all[k]->z;
    }
  }
  findNormals(planes, t);
  const BeamFrame& frame = this->Frame;
  HWY_DYNAMIC_DISPATCH(setUpLanes)
  ({ frame.tanHalf * frame.e1, frame.tanHalf * frame.e2, frame.axis, frame.tanHalf * frame.tanHalf,
     1.0 / frame.flatness2 },
    t);
  if (this->Surfaces.size() < this->Count + LaneCount)
  {
    this->Surfaces.resize(2 * this->Count + LaneCount);
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    if ((t.enters >> i & 1u) == 0u)
    {
      continue;
    }
    this->Keys.push_back(keyAbove(triangles[i], this->Count));
    BeamSurface& s = this->Surfaces[this->Count++];
    s.count = 0;
    s.triangle = triangles[i];
    s.other = NoTriangle;
    s.diagonal = { 0.0, 0.0, 1.0 };
    s.crosses = 0;
    for (int k = 0; k < 3; ++k)
    {
      s.lines[k] = { t.lines[3 * k][i], t.lines[3 * k + 1][i], t.lines[3 * k + 2][i] };
      s.crosses |= static_cast<std::uint32_t>(t.crosses[k] >> i & 1u) << k;
    }
    s.inverse = { t.inverse[0][i], t.inverse[1][i], t.inverse[2][i] };
    s.mostInverse = t.mostInverse[i];
    s.sortInverse = this->Scene.coincides(triangles[i]) ? t.mostOfPlane[i] : s.mostInverse;
    s.leastInverse = t.leastInverse[i];
    s.height = t.height[i];
    s.area = (t.inside >> i & 1u) != 0u ? t.area[i] : AreaUnknown;
  }
}

namespace
{
double largestOf(const Vec3& v)
{
  return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
}

/// Key that sorts positive numbers, the largest first.
std::uint32_t nearestFirst(double inverse)
{
  const auto single = static_cast<float>(inverse);
  std::uint32_t bits;
  std::memcpy(&bits, &single, sizeof bits);
  return ~bits;
}
}

const std::vector<const BeamSurface*>& BeamTriangles::sort()
{
  this->finish();
  std::vector<BeamSurface>& all = this->Surfaces;
  std::vector<std::uint64_t>& keys = this->Keys;
  const std::size_t count = this->Count;
  sortKeys(keys);
  this->ByTriangle.clear();
  for (std::size_t i = 0; i < count; ++i)
  {
    BeamSurface& s = all[numberOf(keys[i])];
    const bool joined = i + 1 < count && keyOf(keys[i + 1]) == keyOf(keys[i]) + 1 &&
      this->join(s, all[numberOf(keys[i + 1])]);
    for (int k = 0; k < 3 && !joined; ++k)
    {
      if ((s.crosses >> k & 1u) != 0u)
      {
        s.lines[s.count++] = s.lines[k];
      }
    }
    this->ByTriangle.push_back(numberOf(keys[i]));
    i += joined ? 1 : 0;
  }
  keys.clear();
  for (const std::uint32_t number : this->ByTriangle)
  {
    keys.push_back(keyAbove(nearestFirst(all[number].sortInverse), keys.size()));
  }
  sortKeys(keys);
  this->Nearest.clear();
  for (const std::uint64_t key : keys)
  {
    this->Nearest.push_back(&all[this->ByTriangle[numberOf(key)]]);
  }
  return this->Nearest;
}

/// Find whether a triangle and the next triangle form a convex quadrilateral in one plane.
/// @return Apart, or three times the number of the common side in the first triangle plus the
/// number of this side in the second triangle
std::uint8_t BeamTriangles::findJoint(std::uint32_t triangle) const
{
  const Corners one = this->Scene.cornersFrom(triangle, Vec3(0.0));
  const Corners two = this->Scene.cornersFrom(triangle + 1, Vec3(0.0));
  const Vec3* const p[] = { &one.a, &one.b, &one.c };
  const Vec3* const q[] = { &two.a, &two.b, &two.c };
  bool same[3][3];
  for (int k = 0; k < 9; ++k)
  {
    same[k / 3][k % 3] = *p[k / 3] == *q[k % 3];
  }
  for (int k = 0; k < 9; ++k)
  {
    const int i = k / 3;
    const int j = k % 3;
    const int i2 = (i + 1) % 3;
    const int j2 = (j + 1) % 3;
    if (!(same[i][j2] && same[i2][j]) && !(same[i][j] && same[i2][j2]))
    {
      continue;
    }
    const Vec3& a = *p[i];
    const Vec3& b = *p[i2];
    const Vec3 side = b - a;
    const Vec3 own = *p[(i + 2) % 3] - a;
    const Vec3 other = *q[(j + 2) % 3] - a;
    const Vec3 n = glm::cross(side, own);
    // A scene that is moved far from the origin must give the same result in spite of rounding.
    constexpr double flat = 1e-13;
    constexpr double rounding = 1e-15;
    const double longest2 =
      std::max(glm::dot(side, side), std::max(glm::dot(own, own), glm::dot(other, other)));
    const double aside = flat * std::sqrt(longest2) +
      rounding * (largestOf(a) + largestOf(*p[(i + 2) % 3]) + largestOf(*q[(j + 2) % 3]));
    // True if the quadrilateral is convex at an end of its diagonal.
    const auto isConvexAt = [&](const Vec3& end, const Vec3& along)
    {
      return glm::dot(n, glm::cross(*q[(j + 2) % 3] - end, *p[(i + 2) % 3] - end)) *
        glm::dot(n, glm::cross(along, *p[(i + 2) % 3] - end)) >
        0.0;
    };
    const bool joins = std::fabs(glm::dot(n, other)) <= aside * std::sqrt(glm::dot(n, n)) &&
      glm::dot(n, glm::cross(side, other)) < 0.0 && isConvexAt(a, side) && isConvexAt(b, -side);
    return joins ? static_cast<std::uint8_t>(k) : Apart;
  }
  return Apart;
}

/// findJoint(), cached for triangles that do not move.
std::uint8_t BeamTriangles::jointAfter(std::uint32_t triangle)
{
  if (triangle >= this->Joints.size() || this->Scene.isMoved(triangle + 1))
  {
    return this->findJoint(triangle);
  }
  std::uint8_t& joint = this->Joints[triangle];
  joint = joint == Unknown ? this->findJoint(triangle) : joint;
  return joint;
}

/// Join two triangles with consecutive numbers to one surface, if they form a quadrilateral.
bool BeamTriangles::join(BeamSurface& one, const BeamSurface& two)
{
  const std::uint8_t joint = this->jointAfter(one.triangle);
  const bool coincide = this->Scene.coincides(one.triangle) || this->Scene.coincides(two.triangle);
  if (joint == Apart ||
    (coincide && this->Scene.planeOwner(one.triangle) != this->Scene.planeOwner(two.triangle)))
  {
    return false;
  }
  const int sideOne = joint / 3;
  const int sideTwo = joint % 3;
  const PlaneLine own[] = { one.lines[0], one.lines[1], one.lines[2] };
  const auto crosses = [](const BeamSurface& s, int side)
  { return (s.crosses >> side & 1u) != 0u; };
  one.diagonal = crosses(one, sideOne) ? own[sideOne] : PlaneLine{ 0.0, 0.0, 1.0 };
  for (int k = 1; k <= 2; ++k)
  {
    if (crosses(one, (sideOne + k) % 3))
    {
      one.lines[one.count++] = own[(sideOne + k) % 3];
    }
  }
  for (int k = 1; k <= 2; ++k)
  {
    if (crosses(two, (sideTwo + k) % 3))
    {
      one.lines[one.count++] = two.lines[(sideTwo + k) % 3];
    }
  }
  one.other = two.triangle;
  one.area = one.area < 0.0 || two.area < 0.0 ? AreaUnknown : one.area + two.area;
  one.mostInverse = std::max(one.mostInverse, two.mostInverse);
  one.sortInverse = std::max(one.sortInverse, two.sortInverse);
  one.leastInverse = std::min(one.leastInverse, two.leastInverse);
  return true;
}
}
#endif
