// SPDX-License-Identifier: BSD-3-Clause
#include "CoincidentFaces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>

namespace avianlidar
{
namespace
{
/// Overlaps of a smaller part of the smaller triangle are those of neighbours by rounding.
constexpr double LeastOverlap = 1e-6;

/// Tilt, rad, that single precision may add to a pair of normals.
constexpr float TiltOfRounding = 1e-6f;

/// A triangle as the search needs it.
struct Face
{
  float normal[3];
  float tilt;           ///< rad, by which rounding may turn it
  float tolerance;      ///< toleranceOf(), rounded up
  std::uint32_t number; ///< triangle number
};

/// Twice the area, along the normal.
Vec3 areaOf(const Corners& t)
{
  return glm::cross(t.b - t.a, t.c - t.a);
}

double longestSideOf(const Corners& t)
{
  const Vec3 ab = t.b - t.a;
  const Vec3 bc = t.c - t.b;
  const Vec3 ca = t.a - t.c;
  return std::sqrt(std::max(glm::dot(ab, ab), std::max(glm::dot(bc, bc), glm::dot(ca, ca))));
}

/// Relative to its first corner.
Corners cornersOf(const TriangleMesh& mesh, std::uint32_t triangle)
{
  return cornersFrom(mesh, triangle, mesh.corner(triangle, 0));
}

/// Whether a number has the digits of single precision alone. By its bits, as GCC 12 leaves out
/// roundings to single precision and back where it vectorises them.
bool isSingle(double x)
{
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return (bits & 0x1fffffffu) == 0;
}

/// Most that rounding moves a corner of the triangle off its plane, m. @param normal unit
double toleranceOf(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& normal)
{
  constexpr double ofDouble = 32.0 * RoundOffDouble;
  constexpr double ofSingle = 4.0 * RoundOffSingle;
  constexpr double most = 5e-4;
  Vec3 largest(0.0);
  bool allSingle = true;
  for (int c = 0; c < 3; ++c)
  {
    const Vec3& p = mesh.corner(triangle, c);
    for (int axis = 0; axis < 3; ++axis)
    {
      allSingle = allSingle && isSingle(p[axis]);
      largest[axis] = std::max(largest[axis], std::fabs(p[axis]));
    }
  }
  return ofDouble * std::max(largest.x, std::max(largest.y, largest.z)) +
    (allSingle ? std::min(most, ofSingle * glm::dot(glm::abs(normal), largest)) : 0.0);
}

Face faceOf(const TriangleMesh& mesh, std::uint32_t triangle)
{
  Face face = {};
  face.number = triangle;
  const Corners t = cornersOf(mesh, triangle);
  const Vec3 area = areaOf(t);
  const double size = glm::length(area);
  if (size > 0.0)
  {
    const Vec3 n = area / size;
    const double tolerance = toleranceOf(mesh, triangle, n);
    const double longest = longestSideOf(t);
    constexpr float up = 1.0f + 1e-6f;
    for (int axis = 0; axis < 3; ++axis)
    {
      face.normal[axis] = static_cast<float>(n[axis]);
    }
    face.tilt =
      up * static_cast<float>((2.0 * tolerance + 8.0 * RoundOffDouble * longest) * longest / size);
    face.tolerance = up * static_cast<float>(tolerance);
  }
  return face;
}

/// True if a side of the first triangle separates them, seen along one axis.
bool isSeparated(const double (&one)[3][2], const double (&two)[3][2])
{
  for (int k = 0; k < 3; ++k)
  {
    const double* const a = one[k];
    const double* const b = one[(k + 1) % 3];
    const double x = b[0] - a[0];
    const double y = b[1] - a[1];
    const auto side = [&](const double* p) { return x * (p[1] - a[1]) - y * (p[0] - a[0]); };
    const double sign = side(one[(k + 2) % 3]) > 0.0 ? 1.0 : -1.0;
    if (sign * side(two[0]) <= 0.0 && sign * side(two[1]) <= 0.0 && sign * side(two[2]) <= 0.0)
    {
      return true;
    }
  }
  return false;
}

/// The same of either. @param along the axis
bool isSeparated(const Corners& one, const Corners& two, int along)
{
  const int u = (along + 1) % 3;
  const int v = (along + 2) % 3;
  const double a[3][2] = { { one.a[u], one.a[v] }, { one.b[u], one.b[v] }, { one.c[u], one.c[v] } };
  const double b[3][2] = { { two.a[u], two.a[v] }, { two.b[u], two.b[v] }, { two.c[u], two.c[v] } };
  return isSeparated(a, b) || isSeparated(b, a);
}

/// True if two triangles overlap, and are nowhere in their overlap farther apart than `tolerance`.
bool coincide(const Corners& one, const Corners& two, double tolerance)
{
  const Vec3 area = areaOf(one);
  const double size = glm::length(area);
  const Vec3 n = area / size;
  const auto height = [&](const Vec3& p) { return glm::dot(n, p - one.a); };
  Vec3 ring[6] = { two.a, two.b, two.c };
  int count = 3;
  const Vec3* const corners[] = { &one.a, &one.b, &one.c };
  for (int k = 0; k < 3; ++k)
  {
    const Vec3& from = *corners[k];
    const Vec3 inwards = glm::cross(n, *corners[(k + 1) % 3] - from);
    double side[6];
    Vec3 whole[6];
    for (int i = 0; i < count; ++i)
    {
      whole[i] = ring[i];
      side[i] = glm::dot(inwards, ring[i] - from);
    }
    const int before = count;
    count = 0;
    for (int i = 0; i < before; ++i)
    {
      const int j = i + 1 == before ? 0 : i + 1;
      if (side[i] >= 0.0)
      {
        ring[count++] = whole[i];
      }
      if (side[i] * side[j] < 0.0)
      {
        ring[count++] = whole[i] + side[i] / (side[i] - side[j]) * (whole[j] - whole[i]);
      }
    }
    if (count < 3)
    {
      return false;
    }
  }
  Vec3 overlap(0.0);
  double farthest = 0.0;
  for (int i = 0; i < count; ++i)
  {
    overlap += glm::cross(ring[i] - ring[0], ring[i + 1 == count ? 0 : i + 1] - ring[0]);
    farthest = std::max(farthest, std::fabs(height(ring[i])));
  }
  const double least = std::min(size, glm::length(areaOf(two)));
  const double edge = 8.0 * tolerance * std::min(longestSideOf(one), longestSideOf(two));
  return farthest <= tolerance &&
    std::fabs(glm::dot(n, overlap)) > std::max(LeastOverlap * least, edge);
}

/// A box of the wide tree.
struct Part
{
  float centre[3], half[3];
  std::uint32_t first, count; ///< as of WideNode
  bool isLeaf() const { return this->count > 0; }
  bool operator==(const Part& other) const
  {
    return this->first == other.first && this->count == other.count;
  }
};
using PartPair = std::pair<Part, Part>;

class Search
{
public:
  Search(const CollisionTree& tree, ParallelTeam& team)
    : Tree(tree)
    , Mesh(*tree.mesh)
    , Team(team)
    , Faces(tree.order.size())
    , Parents(new std::atomic<std::uint32_t>[tree.mesh->size()])
  {
  }

  /// Set what the tree holds of coincident faces. @return false if stopped
  bool run(const KeepGoing& keepGoing, CollisionTree& tree)
  {
    constexpr std::size_t block = 1024;
    std::atomic<float> widest{ 0.0f };
    this->Team.loop(this->Faces.size(), block,
      [&](std::size_t begin, std::size_t end, int)
      {
        float most = 0.0f;
        for (std::size_t k = begin; k < end; ++k)
        {
          this->Faces[k] = faceOf(this->Mesh, this->Tree.order[k]);
          this->Parents[k] = static_cast<std::uint32_t>(k);
          most = std::max(most, this->Faces[k].tolerance);
        }
        float known = widest;
        while (known < most && !widest.compare_exchange_weak(known, most))
        {
        }
      });
    this->Slack = 2.0f * widest + WideRounding * static_cast<float>(this->Tree.wide.extent);
    std::vector<PartPair> pairs = this->firstPairs();
    const bool finished = this->Team.loop(
      pairs.size(), 1,
      [&](std::size_t begin, std::size_t end, int)
      {
        std::vector<PartPair> stack(pairs.begin() + begin, pairs.begin() + end);
        while (!stack.empty())
        {
          const PartPair pair = stack.back();
          stack.pop_back();
          this->visit(pair, stack);
        }
      },
      keepGoing);
    if (finished && this->Found)
    {
      tree.planeOwners = this->owners();
      tree.planeDepth = 2.0 * widest;
    }
    return finished;
  }

private:
  /// Enough pairs of boxes to keep many threads busy.
  std::vector<PartPair> firstPairs()
  {
    constexpr std::size_t enough = 2048;
    const Part root{ {}, {}, 0, 0 };
    std::vector<PartPair> pairs{ { root, root } };
    for (bool opened = true; opened && pairs.size() < enough;)
    {
      opened = false;
      std::vector<PartPair> next;
      for (const PartPair& pair : pairs)
      {
        const bool opens = !pair.first.isLeaf() || !pair.second.isLeaf();
        opens ? this->visit(pair, next) : next.push_back(pair);
        opened = opened || opens;
      }
      pairs = std::move(next);
    }
    return pairs;
  }

  static Part childOf(const WideNode& node, int lane)
  {
    return { { node.x[lane], node.y[lane], node.z[lane] },
      { node.halfX[lane], node.halfY[lane], node.halfZ[lane] }, node.first[lane],
      node.count[lane] };
  }

  /// Children of a node whose boxes meet that of a part, a bit for each.
  std::uint32_t childrenMet(const WideNode& node, const Part& part) const
  {
    const float slack = this->Slack;
    std::uint32_t met[WideNode::Width];
#pragma omp simd
    for (int i = 0; i < WideNode::Width; ++i)
    {
      const float x = std::fabs(node.x[i] - part.centre[0]) - (node.halfX[i] + part.half[0]);
      const float y = std::fabs(node.y[i] - part.centre[1]) - (node.halfY[i] + part.half[1]);
      const float z = std::fabs(node.z[i] - part.centre[2]) - (node.halfZ[i] + part.half[2]);
      const float apart = x > y ? (x > z ? x : z) : (y > z ? y : z);
      met[i] = (!(apart > slack) & (node.first[i] != NoChild)) ? 1u : 0u;
    }
    std::uint32_t bits = 0;
    for (int i = 0; i < WideNode::Width; ++i)
    {
      bits |= met[i] << i;
    }
    return bits;
  }

  void visit(const PartPair& pair, std::vector<PartPair>& more)
  {
    const Part& one = pair.first;
    const Part& two = pair.second;
    if (one.isLeaf() && two.isLeaf())
    {
      this->compare(one, two);
      return;
    }
    const bool opensOne = !one.isLeaf();
    const WideNode& node = this->Tree.wide.nodes[opensOne ? one.first : two.first];
    const auto add = [&](std::uint32_t lanes, const Part& part)
    {
      for (; lanes != 0; lanes &= lanes - 1)
      {
        more.emplace_back(childOf(node, __builtin_ctz(lanes)), part);
      }
    };
    if (!(one == two))
    {
      const Part other = opensOne ? two : one;
      add(this->childrenMet(node, other), other);
      return;
    }
    for (int i = 0; i < WideNode::Width; ++i)
    {
      if (node.first[i] != NoChild)
      {
        const Part child = childOf(node, i);
        add(this->childrenMet(node, child) >> i << i, child); // each pair once
      }
    }
  }

  void compare(const Part& one, const Part& two)
  {
    for (std::uint32_t i = 0; i < one.count; ++i)
    {
      for (std::uint32_t j = one == two ? i + 1 : 0; j < two.count; ++j)
      {
        this->compare(one.first + i, two.first + j);
      }
    }
  }

  Corners cornersAt(std::uint32_t place, const Vec3& apex) const
  {
    const auto& corners = this->Tree.leafTriangles[place].corners;
    const std::vector<Vec3>& points = this->Mesh.points;
    return { points[corners[0]] - apex, points[corners[1]] - apex, points[corners[2]] - apex };
  }

  /// Compare two triangles, by their places in the tree's order.
  void compare(std::uint32_t one, std::uint32_t two)
  {
    const Face& a = this->Faces[one];
    const Face& b = this->Faces[two];
    const float x = a.normal[1] * b.normal[2] - a.normal[2] * b.normal[1];
    const float y = a.normal[2] * b.normal[0] - a.normal[0] * b.normal[2];
    const float z = a.normal[0] * b.normal[1] - a.normal[1] * b.normal[0];
    const float cosine =
      a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1] + a.normal[2] * b.normal[2];
    const float tilt = a.tilt + b.tilt + TiltOfRounding;
    if (!(x * x + y * y + z * z <= tilt * tilt) || !(std::fabs(cosine) > 0.5f))
    {
      return;
    }
    const bool inOrder = a.number < b.number; // so that nothing depends on the tree
    const std::uint32_t lower = inOrder ? one : two;
    const Vec3& apex = this->Mesh.points[this->Tree.leafTriangles[lower].corners[0]];
    const Corners first = this->cornersAt(lower, apex);
    const Corners second = this->cornersAt(inOrder ? two : one, apex);
    const double tolerance = static_cast<double>(a.tolerance) + static_cast<double>(b.tolerance);
    const Vec3 n(a.normal[0], a.normal[1], a.normal[2]);
    const Vec3 size = glm::abs(n);
    const int along = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const double level = tolerance + tilt * glm::dot(glm::abs(second.a), Vec3(1.0));
    if (!(std::fabs(glm::dot(n, second.a)) > level) && !isSeparated(first, second, along) &&
      this->rootOf(a.number) != this->rootOf(b.number) && coincide(first, second, tolerance))
    {
      this->unite(a.number, b.number);
      this->Found = true;
    }
  }

  std::uint32_t rootOf(std::uint32_t triangle)
  {
    while (true)
    {
      const std::uint32_t parent = this->Parents[triangle].load(std::memory_order_relaxed);
      if (parent == triangle)
      {
        return triangle;
      }
      const std::uint32_t next = this->Parents[parent].load(std::memory_order_relaxed);
      this->Parents[triangle].store(next, std::memory_order_relaxed); // shortens the way
      triangle = next;
    }
  }

  /// The root of a set is its lowest number, whatever the order of the pairs.
  void unite(std::uint32_t one, std::uint32_t two)
  {
    while (true)
    {
      one = this->rootOf(one);
      two = this->rootOf(two);
      if (one == two)
      {
        return;
      }
      std::uint32_t higher = std::max(one, two);
      if (this->Parents[higher].compare_exchange_strong(higher, std::min(one, two)))
      {
        return;
      }
    }
  }

  double leastAltitudeOf(std::uint32_t triangle) const
  {
    const Corners t = cornersOf(this->Mesh, triangle);
    return glm::length(areaOf(t)) / longestSideOf(t);
  }

  /// True if rounding explains how far a triangle lies from the plane of another.
  bool fits(std::uint32_t triangle, std::uint32_t owner) const
  {
    const Corners plane = cornersOf(this->Mesh, owner);
    const Corners t = cornersFrom(this->Mesh, triangle, this->Mesh.corner(owner, 0));
    const Vec3 area = areaOf(plane);
    const Vec3 n = area / glm::length(area);
    const double least = this->leastAltitudeOf(owner);
    const double own = faceOf(this->Mesh, triangle).tolerance;
    const double ofPlane = faceOf(this->Mesh, owner).tolerance;
    for (const Vec3* corner : { &t.a, &t.b, &t.c })
    {
      const double reach = 1.0 + 4.0 * glm::length(*corner) / least;
      if (!(std::fabs(glm::dot(n, *corner)) <= own + ofPlane * reach))
      {
        return false;
      }
    }
    return true;
  }

  std::vector<std::uint32_t> owners()
  {
    const auto size = static_cast<std::uint32_t>(this->Faces.size());
    std::vector<std::uint32_t> owners(size, NoTriangle); // of the roots of sets of several
    for (std::uint32_t t = 0; t < size; ++t)
    {
      const std::uint32_t root = this->rootOf(t);
      std::uint32_t& owner = owners[root];
      if (root != t)
      {
        owner = owner == NoTriangle ? root : owner;
        constexpr double clearly = 1.001; // copies have the plane of the first
        owner = this->leastAltitudeOf(t) > clearly * this->leastAltitudeOf(owner) ? t : owner;
      }
    }
    std::vector<std::uint32_t> result(size, NoTriangle);
    for (std::uint32_t t = 0; t < size; ++t)
    {
      const std::uint32_t owner = owners[this->rootOf(t)];
      result[t] = owner != NoTriangle && this->fits(t, owner) ? owner : NoTriangle;
    }
    return result;
  }

  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  ParallelTeam& Team;
  std::vector<Face> Faces;
  std::unique_ptr<std::atomic<std::uint32_t>[]>
    Parents;          ///< sets of triangles that coincide, as a forest
  float Slack = 0.0f; ///< m, most that boxes may lie apart
  std::atomic<bool> Found{ false };
};
}

bool findPlaneOwners(CollisionTree& tree, ParallelTeam& team, const KeepGoing& keepGoing)
{
  return Search(tree, team).run(keepGoing, tree);
}
}
