// SPDX-License-Identifier: BSD-3-Clause
#include "PathSpace.h"

#include "Reflectance.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace avianlidar
{
namespace
{
/// With fewer paths of a kind, a descent for each is as cheap.
constexpr std::size_t FewPaths = 3;

/// Rounding of the height of a point above a plane, over the farthest coordinate involved.
constexpr double HeightNoise = 64.0 * RoundOffDouble;

const Occupants TooMany{ Occupants::Most + 1, {} };

/// A search that looks at more triangles is given up: in a dense scene, or for a space as long as
/// the ground seen at grazing angle, descents for single paths are cheaper.
constexpr int MostLookedAt = 64;

/// The part of a cone that lies in a box, against eight boxes of the folded tree.
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
      const bool meets = (std::fabs(node.x[i] - b.x) <= node.halfX[i] + b.halfX) &
        (std::fabs(node.y[i] - b.y) <= node.halfY[i] + b.halfY) &
        (std::fabs(node.z[i] - b.z) <= node.halfZ[i] + b.halfZ);
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

/// Looks for triangles in spaces of one beam; the visitor of its own descents.
class PathSpace::Search
{
public:
  Search(const CollisionTree& tree, const BeamFrame& frame, const PrimaryHits& hits,
    const HitGeometry& geometry, TraversalStack& stack)
    : Tree(tree)
    , Frame(frame)
    , Farthest(hits.farthest)
    , Geometry(geometry)
    , Stack(stack)
    , Folded(!tree.wide.nodes.empty() && this->Cone.set(tree.wide, BeamVolumeTest(frame)))
  {
  }

  /// Look once for all triangles that reach into any of the spaces that in() is asked for next, all
  /// inside the box (relative to the apex), instead of once for each.
  void gather(const AABB& box)
  {
    this->Gathered = false;
    if (!isFinite(box.lower) || !isFinite(box.upper))
    {
      return;
    }
    this->setBox(box);
    this->Near.clear();
    this->Near.reserve(MostLookedAt);
    this->Gathering = true;
    this->descend();
    this->Gathering = false;
    this->Gathered = this->LookedAt <= MostLookedAt;
  }

  /// Triangles that reach into the box (relative to the apex) and before all of the floors.
  Occupants in(const AABB& box, const Floor* floors, int count)
  {
    if (!isFinite(box.lower) || !isFinite(box.upper))
    {
      return TooMany;
    }
    this->setBox(box);
    this->Floors = floors;
    this->Count = count;
    this->Result = {};
    if (this->Gathered)
    {
      for (const Candidate& candidate : this->Near)
      {
        if (this->reachesInto(candidate) && !this->add(candidate.triangle))
        {
          break;
        }
      }
    }
    else
    {
      this->descend();
    }
    std::sort(this->Result.triangles,
      this->Result.triangles + std::min(this->Result.count, Occupants::Most));
    return this->Result;
  }

  double limit() const { return std::numeric_limits<double>::infinity(); }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    this->LookedAt += static_cast<int>(count);
    if (this->LookedAt > MostLookedAt)
    {
      this->Result = TooMany;
      return false;
    }
    for (std::uint32_t i = 0; i < count; ++i)
    {
      Candidate candidate;
      if (!this->isInCone(triangles[i], candidate))
      {
        continue;
      }
      if (this->Gathering)
      {
        this->Near.push_back(candidate);
      }
      else if (this->reachesInto(candidate) && !this->add(triangles[i]))
      {
        return false;
      }
    }
    return true;
  }

private:
  /// A triangle that the cone may meet.
  struct Candidate
  {
    std::uint32_t triangle;
    Corners corners; ///< relative to the apex
    Vec3 lower;
    Vec3 upper;
    double reach; ///< m, the farthest coordinate involved
  };

  void setBox(const AABB& box)
  {
    const Vec3 size = glm::max(glm::abs(box.lower), glm::abs(box.upper));
    this->Center = box.center();
    this->Half = 0.5 * (box.upper - box.lower) +
      Vec3(4.0 * HitMargin * (std::max(size.x, std::max(size.y, size.z)) + this->Farthest));
  }

  void descend()
  {
    this->LookedAt = 0;
    if (this->Tree.nodes.empty())
    {
      return;
    }
    if (this->Folded)
    {
      const Vec3 center = this->Center + (this->Frame.origin - this->Tree.wide.reference);
      const Vec3 half =
        this->Half * (1.0 + double{ WideRounding }) + Vec3(2.0 * this->Cone.widening);
      const WideConeBox query{ this->Cone, static_cast<float>(center.x),
        static_cast<float>(center.y), static_cast<float>(center.z), static_cast<float>(half.x),
        static_cast<float>(half.y), static_cast<float>(half.z) };
      descendWide(this->Tree, query, *this, this->Stack);
    }
    else
    {
      const Vec3 center = this->Center + this->Frame.origin;
      const Vec3 rounding = 1e-12 * (glm::abs(center) + glm::abs(this->Frame.origin));
      const BoxProbe probe{ center, this->Half * (1.0 + 1e-12) + rounding };
      std::visit([&](const auto& volumes)
        { avianlidar::descend(this->Tree, volumes, probe, *this, this->Stack); },
        this->Tree.volumes());
    }
  }

  /// @return false if they are too many to list
  bool add(std::uint32_t triangle)
  {
    if (this->Result.count == Occupants::Most)
    {
      this->Result = TooMany;
      return false;
    }
    this->Result.triangles[this->Result.count++] = triangle;
    return true;
  }

  static bool allBelow(const Corners& t, const Vec3& normal, double height)
  {
    return glm::dot(normal, t.a) < height && glm::dot(normal, t.b) < height &&
      glm::dot(normal, t.c) < height;
  }

  /// TriangleTest.h: a hit lies off its triangle by no more than HitMargin times this.
  static double offOf(const Candidate& c) { return 4.0 * HitMargin * c.reach; }

  /// By the pyramid around the cone, in which all paths stay.
  bool isInCone(std::uint32_t triangle, Candidate& c) const
  {
    c.triangle = triangle;
    c.corners = cornersFrom(*this->Tree.mesh, triangle, this->Frame.origin);
    c.lower = glm::min(glm::min(c.corners.a, c.corners.b), c.corners.c);
    c.upper = glm::max(glm::max(c.corners.a, c.corners.b), c.corners.c);
    const Vec3 most = glm::max(glm::abs(c.lower), glm::abs(c.upper));
    c.reach = std::max(most.x, std::max(most.y, most.z)) + this->Farthest;
    const double height = -2.0 * offOf(c);
    const Vec3 wide = this->Frame.tanHalf * (1.0 + 1e-9) * this->Frame.axis;
    for (const Vec3& side : { this->Frame.e1, this->Frame.e2 })
    {
      if (allBelow(c.corners, wide + side, height) || allBelow(c.corners, wide - side, height))
      {
        return false;
      }
    }
    return true;
  }

  bool reachesInto(const Candidate& c) const
  {
    for (int f = 0; f < this->Count; ++f)
    {
      const HitGeometry::Surface& surface = this->Geometry.surfaces[this->Floors[f].surface];
      const double height = this->Floors[f].least - HeightNoise * c.reach - surface.height;
      if (c.triangle == surface.triangle || allBelow(c.corners, surface.normal, height))
      {
        return false;
      }
    }
    const double off = offOf(c);
    for (int axis = 0; axis < 3; ++axis)
    {
      if (c.lower[axis] - this->Center[axis] > this->Half[axis] + off ||
        c.upper[axis] - this->Center[axis] < -this->Half[axis] - off)
      {
        return false;
      }
    }
    const Corners& t = c.corners;
    const Vec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    const double distance = std::fabs(glm::dot(normal, t.a - this->Center));
    return distance <= glm::dot(glm::abs(normal), this->Half + Vec3(off)) * (1.0 + 1e-9);
  }

  const CollisionTree& Tree;
  const BeamFrame& Frame;
  double Farthest;
  const HitGeometry& Geometry;
  TraversalStack& Stack;
  WideCone Cone{};
  bool Folded;
  int LookedAt = 0;
  bool Gathering = false;
  bool Gathered = false; ///< `Near` is all that in() need look at
  std::vector<Candidate> Near;
  Vec3 Center{ 0.0 };
  Vec3 Half{ 0.0 };
  const Floor* Floors = nullptr;
  int Count = 0;
  Occupants Result;
};

double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction)
{
  // p . p cos^2 - (p . axis)^2 = 0 on the cone, a quadratic in the length s.
  const double cos2 = frame.cosHalf * frame.cosHalf;
  const double along = glm::dot(point, frame.axis);
  const double turn = glm::dot(direction, frame.axis);
  const double a = cos2 - turn * turn;
  const double b = cos2 * glm::dot(point, direction) - along * turn;
  const double c = std::min(0.0, cos2 * range * range - along * along);
  if (!(a > 1e-9))
  {
    return std::numeric_limits<double>::infinity(); // within the cone of directions, or nearly
  }
  const double reach = (std::sqrt(std::max(0.0, b * b - a * c)) - b) / a;
  return reach * (1.0 + 1e-6) + 1e-6 * range;
}

const std::vector<Occupants>& PathSpace::beforeSurfaces(const CollisionTree& tree,
  const BeamFrame& frame, const PrimaryHits& hits, const HitGeometry& geometry)
{
  const std::size_t surfaces = geometry.surfaces.size();
  this->Found.assign(surfaces, TooMany);
  if (hits.size() < FewPaths * surfaces)
  {
    return this->Found;
  }
  this->Boxes.assign(surfaces, AABB{});
  this->Floors.assign(surfaces, { 0, std::numeric_limits<double>::infinity() });
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    const std::uint32_t s = geometry.surface[i];
    const Vec3 direction = geometry.direction(i);
    const Vec3 mirror = mirrorDirection(direction, geometry.surfaces[s].normal);
    const Vec3 point = hits.range[i] * direction;
    this->Boxes[s].extend(point);
    this->Boxes[s].extend(point + distanceInCone(frame, point, hits.range[i], mirror) * mirror);
    // Half the height at which a path of this hit is first looked at.
    const double height = 0.5 * surfaceMargin(hits.range[i]) * hits.cosine[i];
    this->Floors[s] = { s, std::min(this->Floors[s].least, height) };
  }
  Search search(tree, frame, hits, geometry, this->Stack);
  if (surfaces > 1)
  {
    AABB all;
    for (const AABB& box : this->Boxes)
    {
      all = merge(all, box);
    }
    search.gather(all);
  }
  for (std::size_t s = 0; s < surfaces; ++s)
  {
    this->Found[s] = search.in(this->Boxes[s], &this->Floors[s], 1);
  }
  return this->Found;
}

std::uint32_t PathSpace::pairOf(std::uint32_t surface1, std::uint32_t surface2)
{
  const auto [one, two] = std::minmax(surface1, surface2);
  std::uint32_t p = 0;
  if (this->LastPair < this->Pairs.size() && this->Pairs[this->LastPair].floors[0].surface == one &&
    this->Pairs[this->LastPair].floors[1].surface == two)
  {
    return this->LastPair;
  }
  for (; p < this->Pairs.size(); ++p)
  {
    const Pair& pair = this->Pairs[p];
    if (pair.floors[0].surface == one && pair.floors[1].surface == two)
    {
      this->LastPair = p;
      return p;
    }
  }
  this->LastPair = p;
  constexpr double none = std::numeric_limits<double>::infinity();
  this->Pairs.push_back({ { { one, none }, { two, none } }, TooMany });
  return p;
}

void PathSpace::betweenSurfaces(const CollisionTree& tree, const BeamFrame& frame,
  const PrimaryHits& hits, const HitGeometry& geometry, const SecondaryLinks& links)
{
  const std::size_t surfaces = geometry.surfaces.size();
  this->Pairs.clear();
  this->PairOfLink.assign(links.size(), 0);
  if (hits.size() < FewPaths * surfaces)
  {
    this->pairOf(0, 0);
    return;
  }
  this->Boxes.assign(surfaces, AABB{});
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    this->Boxes[geometry.surface[i]].extend(hits.range[i] * geometry.direction(i));
  }
  for (std::size_t i = 0; i < links.size(); ++i)
  {
    const std::uint32_t a = geometry.surface[links.one[i]];
    const std::uint32_t b = geometry.surface[links.two[i]];
    this->PairOfLink[i] = this->pairOf(a, b);
    Floor* floors = this->Pairs[this->PairOfLink[i]].floors;
    // Half the heights at which the segment is first and last looked at.
    const double margin =
      0.5 * surfaceMargin(std::max(hits.range[links.one[i]], hits.range[links.two[i]]));
    double& atOne = floors[a < b ? 0 : 1].least;
    double& atTwo = floors[a < b ? 1 : 0].least;
    atOne = std::min(atOne, margin * links.cosOut[i]);
    atTwo = std::min(atTwo, margin * links.cosIn[i]);
  }
  Search search(tree, frame, hits, geometry, this->Stack);
  if (this->Pairs.size() > 1)
  {
    AABB all;
    for (const Pair& pair : this->Pairs)
    {
      all = merge(all, this->Boxes[pair.floors[0].surface]);
      all = merge(all, this->Boxes[pair.floors[1].surface]);
    }
    search.gather(all);
  }
  for (Pair& pair : this->Pairs)
  {
    const AABB& one = this->Boxes[pair.floors[0].surface];
    const AABB& two = this->Boxes[pair.floors[1].surface];
    pair.occupants = search.in(merge(one, two), pair.floors, 2);
  }
}
}
