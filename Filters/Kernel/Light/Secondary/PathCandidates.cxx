// SPDX-License-Identifier: BSD-3-Clause
#include "PathCandidates.h"

#include "BeamVolumeTest.h"
#include "CollisionTree.h"
#include "Multiversion.h"
#include "TriangleTest.h"
#include "WideTree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <variant>

namespace avianlidar
{
namespace
{
/// Rounding of the height of a point above a plane, over the farthest coordinate involved.
constexpr double HeightNoise = 64.0 * RoundOffDouble;

/// The part of a cone that lies in a box, against eight boxes of the wide tree.
struct WideConeBox
{
  WideCone cone;
  float x, y, z; ///< centre relative to the reference, m
  float halfX, halfY, halfZ;

  void distances(const WideNode& node, float* nearest) const
  {
    this->cone.distances(node, nearest);
    const WideConeBox& b = *this;
    for (int i = 0; i < WideNode::Width; ++i)
    {
      const float x = std::fabs(node.x[i] - b.x);
      const float y = std::fabs(node.y[i] - b.y);
      const float z = std::fabs(node.z[i] - b.z);
      const bool meets = (x <= node.halfX[i] + b.halfX) & (y <= node.halfY[i] + b.halfY) &
        (z <= node.halfZ[i] + b.halfZ);
      nearest[i] = meets ? nearest[i] : std::numeric_limits<float>::infinity();
    }
  }
};

/// A box against any volume of the binary tree, by the box around that.
struct BoxProbe
{
  Vec3 center; ///< scene coordinates, m
  Vec3 half;

  bool meets(const Vec3& c, const Vec3& h) const
  {
    const Vec3 apart = glm::abs(c - this->center);
    return apart.x <= h.x + this->half.x && apart.y <= h.y + this->half.y &&
      apart.z <= h.z + this->half.z;
  }
  bool meets(const AABB& box, double&) const
  {
    return this->meets(box.center(), 0.5 * box.upper - 0.5 * box.lower);
  }
  bool meets(const OBB& box, double&) const
  {
    return this->meets(box.center,
      box.half.x * glm::abs(box.axes[0]) + box.half.y * glm::abs(box.axes[1]) +
        box.half.z * glm::abs(box.axes[2]));
  }
  bool meets(const BoundingSphere& sphere, double&) const
  {
    return this->meets(sphere.center, Vec3(sphere.radius));
  }
};
}

/// Finds triangles near the paths of one beam; visitor of its own descent.
class PathCandidates::Search
{
public:
  Search(const CollisionTree& tree, const BeamFrame& frame, double farthest, std::size_t most,
    PathCandidates& found)
    : Tree(tree)
    , Frame(frame)
    , Farthest(farthest)
    , Most(most)
    , Found(found)
  {
  }

  /// Triangles that reach into the box (relative to the apex). @return false if it was given up
  bool in(const AABB& box, TraversalStack& stack)
  {
    this->Found.begin(this->Most);
    this->LookedAt = 0;
    if (this->Tree.nodes.empty())
    {
      return true;
    }
    const Vec3 size = glm::max(glm::abs(box.lower), glm::abs(box.upper));
    this->Center = box.center();
    this->Half = 0.5 * (box.upper - box.lower) +
      Vec3(4.0 * HitMargin * (std::max(size.x, std::max(size.y, size.z)) + this->Farthest));
    WideCone cone;
    if (!this->Tree.wide.nodes.empty() && cone.set(this->Tree.wide, BeamVolumeTest(this->Frame)))
    {
      const Vec3 center = this->Center + (this->Frame.origin - this->Tree.wide.reference);
      const Vec3 half = this->Half * (1.0 + double{ WideRounding }) + Vec3(2.0 * cone.widening);
      const WideConeBox query{ cone, static_cast<float>(center.x), static_cast<float>(center.y),
        static_cast<float>(center.z), static_cast<float>(half.x), static_cast<float>(half.y),
        static_cast<float>(half.z) };
      descendWide(this->Tree, query, *this, stack);
    }
    else
    {
      const Vec3 center = this->Center + this->Frame.origin;
      const Vec3 rounding = 1e-12 * (glm::abs(center) + glm::abs(this->Frame.origin));
      const BoxProbe probe{ center, this->Half * (1.0 + 1e-12) + rounding };
      std::visit([&](const auto& volumes)
        { avianlidar::descend(this->Tree, volumes, probe, *this, stack); },
        this->Tree.volumes());
    }
    if (this->LookedAt > this->Most)
    {
      return false;
    }
    this->Found.measure(
      this->Frame, this->Center - this->Half, this->Center + this->Half, this->Farthest);
    return true;
  }

  double limit() const { return std::numeric_limits<double>::infinity(); }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    this->LookedAt += count;
    if (this->LookedAt > this->Most)
    {
      return false;
    }
    const std::size_t first = triangles - this->Tree.order.data();
    for (std::uint32_t i = 0; i < count; ++i)
    {
      this->Found.add(triangles[i], leafCorners(this->Tree, first + i, this->Frame.origin));
    }
    return true;
  }

private:
  const CollisionTree& Tree;
  const BeamFrame& Frame;
  double Farthest;
  std::size_t Most;
  PathCandidates& Found;
  std::size_t LookedAt = 0;
  Vec3 Center{ 0.0 };
  Vec3 Half{ 0.0 };
};

void PathCandidates::begin(std::size_t most)
{
  this->Count = 0;
  // Whole blocks of lanes are read.
  const std::size_t room = most + SegmentCulling::Lanes;
  if (this->Triangles.size() >= room)
  {
    return;
  }
  this->Triangles.resize(room);
  for (std::vector<double>& v : this->CornerLanes)
  {
    v.resize(room);
  }
  for (int i = 0; i < 3; ++i)
  {
    this->Lower[i].resize(room);
    this->Upper[i].resize(room);
  }
  this->Reach.resize(room);
  this->Number.resize(room);
  this->Outside.resize(room);
}

void PathCandidates::add(std::uint32_t triangle, const Corners& t)
{
  const std::size_t n = this->Count++;
  this->Triangles[n] = triangle;
  this->Number[n] = triangle;
  for (int i = 0; i < 3; ++i)
  {
    this->CornerLanes[i][n] = t.a[i];
    this->CornerLanes[3 + i][n] = t.b[i];
    this->CornerLanes[6 + i][n] = t.c[i];
  }
}

namespace
{
/// Coordinates of the corners along one axis: their box, and how far they lie outside of another.
AVIANLIDAR_MULTIVERSION void boxesOfAll(const double* a, const double* b, const double* c,
  double boxLower, double boxUpper, double* lower, double* upper, double* reach, double* outside,
  std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double ab0 = a[i] < b[i] ? a[i] : b[i];
    const double ab1 = a[i] > b[i] ? a[i] : b[i];
    const double least = ab0 < c[i] ? ab0 : c[i];
    const double most = ab1 > c[i] ? ab1 : c[i];
    lower[i] = least;
    upper[i] = most;
    const double size = -least > most ? -least : most;
    reach[i] = size > reach[i] ? size : reach[i];
    const double before = least - boxUpper;
    const double behind = boxLower - most;
    const double off = before > behind ? before : behind;
    outside[i] = off > outside[i] ? off : outside[i];
  }
}

/// Largest distances of triangles beyond the sides of the pyramid around a cone. @param side
/// along the beam's plane @param wide tan(theta0.5) times the axis
AVIANLIDAR_MULTIVERSION void beyondPyramid(const SegmentCulling::Corners& corners, const Vec3& side,
  const Vec3& wide, double* outside, std::size_t count)
{
  const SegmentCulling::Corners t = corners;
  const Vec3 u = side;
  const Vec3 w = wide;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double a = (u.x * t.c[0][i] + u.y * t.c[1][i]) + u.z * t.c[2][i];
    const double b = (u.x * t.c[3][i] + u.y * t.c[4][i]) + u.z * t.c[5][i];
    const double c = (u.x * t.c[6][i] + u.y * t.c[7][i]) + u.z * t.c[8][i];
    const double da = (w.x * t.c[0][i] + w.y * t.c[1][i]) + w.z * t.c[2][i];
    const double db = (w.x * t.c[3][i] + w.y * t.c[4][i]) + w.z * t.c[5][i];
    const double dc = (w.x * t.c[6][i] + w.y * t.c[7][i]) + w.z * t.c[8][i];
    // Inside are |side . p| <= wide . p.
    const double leftAB = a - da < b - db ? a - da : b - db;
    const double left = leftAB < c - dc ? leftAB : c - dc;
    const double rightAB = -a - da < -b - db ? -a - da : -b - db;
    const double right = rightAB < -c - dc ? rightAB : -c - dc;
    // The normals are not longer than 2.
    const double beyond = 0.5 * (left > right ? left : right);
    outside[i] = beyond > outside[i] ? beyond : outside[i];
  }
}
}

/// Set boxes and reaches, and remove triangles outside a box or the pyramid around the cone: all
/// paths stay in both.
void PathCandidates::measure(
  const BeamFrame& frame, const Vec3& boxLower, const Vec3& boxUpper, double farthest)
{
  constexpr double inside = -std::numeric_limits<double>::infinity();
  std::fill_n(this->Reach.begin(), this->Count, 0.0);
  std::fill_n(this->Outside.begin(), this->Count, inside);
  for (int i = 0; i < 3; ++i)
  {
    boxesOfAll(this->CornerLanes[i].data(), this->CornerLanes[3 + i].data(),
      this->CornerLanes[6 + i].data(), boxLower[i], boxUpper[i], this->Lower[i].data(),
      this->Upper[i].data(), this->Reach.data(), this->Outside.data(), this->Count);
  }
  const Vec3 wide = frame.tanHalf * (1.0 + 1e-9) * frame.axis;
  beyondPyramid(this->lanes(), frame.e1, wide, this->Outside.data(), this->Count);
  beyondPyramid(this->lanes(), frame.e2, wide, this->Outside.data(), this->Count);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    const double from = this->Reach[i] + farthest;
    // TriangleTest.h: a hit lies off its triangle by no more than HitMargin times this.
    if (this->Outside[i] > 4.0 * HitMargin * from)
    {
      continue;
    }
    this->Triangles[kept] = this->Triangles[i];
    this->Number[kept] = this->Number[i];
    this->Reach[kept] = from;
    for (std::vector<double>& v : this->CornerLanes)
    {
      v[kept] = v[i];
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Lower[axis][kept] = this->Lower[axis][i];
      this->Upper[axis][kept] = this->Upper[axis][i];
    }
    ++kept;
  }
  this->Count = kept;
}

SegmentCulling::Corners PathCandidates::lanes() const
{
  SegmentCulling::Corners lanes;
  for (int i = 0; i < 9; ++i)
  {
    lanes.c[i] = this->CornerLanes[i].data();
  }
  lanes.reach = this->Reach.data();
  return lanes;
}

bool PathCandidates::find(const CollisionTree& tree, const BeamFrame& frame, double farthest,
  const AABB& box, std::size_t most, TraversalStack& stack)
{
  this->Farthest = farthest;
  return Search(tree, frame, farthest, most, *this).in(box, stack);
}

//--- out of reach ---------------------------------------------------------------------------------

namespace
{
/// Candidates in lanes.
struct CandidateLanes
{
  SegmentCulling::Corners corners;
  const double* lower[3];
  const double* upper[3];
  const double* number;
};

/// 0xff for triangles that lie wholly below a height above a plane, or outside of a box, and for
/// one.
AVIANLIDAR_MULTIVERSION void closeAll(const CandidateLanes& candidates, double own,
  const Vec3& planeNormal, double least, const Vec3& boxLower, const Vec3& boxUpper,
  std::uint8_t* closed, std::size_t count)
{
  const CandidateLanes l = candidates;
  const SegmentCulling::Corners t = l.corners;
  const Vec3 n = planeNormal;
  const Vec3 lower = boxLower;
  const Vec3 upper = boxUpper;
  std::uint64_t byteOf[8];
  for (int i = 0; i < 8; ++i)
  {
    std::uint8_t bytes[8] = {};
    bytes[i] = 0xff;
    byteOf[i] = eightOf(bytes);
  }
  for (std::size_t k = 0; k < count; k += 8)
  {
    std::uint64_t eight = 0;
#pragma omp simd reduction(| : eight)
    for (std::size_t i = 0; i < 8; ++i)
    {
      const std::size_t m = k + i;
      const double a = (n.x * t.c[0][m] + n.y * t.c[1][m]) + n.z * t.c[2][m];
      const double b = (n.x * t.c[3][m] + n.y * t.c[4][m]) + n.z * t.c[5][m];
      const double c = (n.x * t.c[6][m] + n.y * t.c[7][m]) + n.z * t.c[8][m];
      const double above = (a > b ? a : b) > c ? (a > b ? a : b) : c;
      const double x0 = l.lower[0][m] - upper.x;
      const double y0 = l.lower[1][m] - upper.y;
      const double z0 = l.lower[2][m] - upper.z;
      const double x1 = lower.x - l.upper[0][m];
      const double y1 = lower.y - l.upper[1][m];
      const double z1 = lower.z - l.upper[2][m];
      const double x = x0 > x1 ? x0 : x1;
      const double y = y0 > y1 ? y0 : y1;
      const double z = z0 > z1 ? z0 : z1;
      const double xy = x > y ? x : y;
      const double beside = xy > z ? xy : z;
      const double below = (least - HeightNoise * t.reach[m]) - above;
      const double outside = beside - 4.0 * HitMargin * t.reach[m];
      const double most = below > outside ? below : outside;
      const double clear = l.number[m] == own ? 1.0 : most;
      eight |= clear > 0.0 ? byteOf[i] : std::uint64_t{ 0 };
    }
    std::memcpy(closed + k, &eight, sizeof eight);
  }
}
}

void PathCandidates::close(
  std::uint32_t own, const Vec3& normal, double least, const AABB& box, std::uint8_t* closed) const
{
  CandidateLanes lanes;
  lanes.corners = this->lanes();
  for (int i = 0; i < 3; ++i)
  {
    lanes.lower[i] = this->Lower[i].data();
    lanes.upper[i] = this->Upper[i].data();
  }
  lanes.number = this->Number.data();
  const Vec3 margin(4.0 * HitMargin * this->Farthest);
  closeAll(lanes, own, normal, least, box.lower - margin, box.upper + margin, closed, this->Count);
  std::fill(closed + this->Count, closed + this->stride(), std::uint8_t{ 0xff });
}
}
