// SPDX-License-Identifier: BSD-3-Clause
#include "CoincidentFaces.h"

#include "Traversal.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

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
  float tilt;      ///< rad, by which rounding may turn it
  float tolerance; ///< toleranceOf(), rounded up
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

/// True if a side of the first triangle separates them, seen along its normal.
bool isBeside(const Corners& one, const Corners& two)
{
  const Vec3 n = areaOf(one);
  const auto separates = [&](const Vec3& from, const Vec3& to)
  {
    const Vec3 inwards = glm::cross(n, to - from);
    const auto isOut = [&](const Vec3& p) { return glm::dot(inwards, p - from) <= 0.0; };
    return isOut(two.a) && isOut(two.b) && isOut(two.c);
  };
  return separates(one.a, one.b) || separates(one.b, one.c) || separates(one.c, one.a);
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

/// Children of a node that lie no farther than `slack` from a child of another, one bit each.
AVIANLIDAR_MULTIVERSION std::uint32_t childrenNear(
  const WideNode& node, const WideNode& other, int lane, float slack)
{
  std::uint32_t near[WideNode::Width];
#pragma omp simd
  for (int i = 0; i < WideNode::Width; ++i)
  {
    const float x = std::fabs(node.x[i] - other.x[lane]) - (node.halfX[i] + other.halfX[lane]);
    const float y = std::fabs(node.y[i] - other.y[lane]) - (node.halfY[i] + other.halfY[lane]);
    const float z = std::fabs(node.z[i] - other.z[lane]) - (node.halfZ[i] + other.halfZ[lane]);
    const float apart = x > y ? (x > z ? x : z) : (y > z ? y : z);
    near[i] = (!(apart > slack) & (node.first[i] != NoChild)) ? 1u : 0u;
  }
  std::uint32_t bits = 0;
  for (int i = 0; i < WideNode::Width; ++i)
  {
    bits |= near[i] << i;
  }
  return bits;
}

/// Sets of triangles that coincide, which several threads unite. The root of a set is its lowest
/// number, whatever the order of the pairs.
class Forest
{
public:
  explicit Forest(std::size_t size)
    : Parents(size)
  {
    for (std::size_t i = 0; i < size; ++i)
    {
      this->Parents[i] = static_cast<std::uint32_t>(i);
    }
  }

  std::uint32_t rootOf(std::uint32_t triangle)
  {
    for (std::uint32_t parent = this->Parents[triangle]; parent != triangle;
         parent = this->Parents[triangle])
    {
      this->Parents[triangle] = this->Parents[parent].load(); // shortens the way
      triangle = parent;
    }
    return triangle;
  }

  void unite(std::uint32_t one, std::uint32_t two)
  {
    for (one = this->rootOf(one), two = this->rootOf(two); one != two;
         one = this->rootOf(one), two = this->rootOf(two))
    {
      std::uint32_t higher = std::max(one, two);
      this->Parents[higher].compare_exchange_strong(higher, std::min(one, two));
    }
  }

private:
  std::vector<std::atomic<std::uint32_t>> Parents;
};

/// Descends the tree with the box of one node, and compares the triangles of its leaves with those
/// of the leaves that it meets.
class LeafSearch : public WidePolicy
{
public:
  LeafSearch(const CollisionTree& tree, const std::vector<Face>& faces, float slack, Forest& sets)
    : Tree(tree)
    , Faces(faces)
    , Slack(slack)
    , Sets(sets)
  {
  }

  /// @param parent of the node @param lane of the parent
  void run(const WideNode& parent, int lane)
  {
    this->Parent = &parent;
    this->Lane = lane;
    this->Own = &this->Tree.wide.nodes[parent.first[lane]];
    this->First = NoChild;
    for (int i = 0; i < WideNode::Width; ++i)
    {
      this->First =
        this->Own->count[i] > 0 ? std::min(this->First, this->Own->first[i]) : this->First;
    }
    if (this->First != NoChild)
    {
      descendWide(this->Tree.wide, DescentStart(), *this, this->Stack);
    }
  }

  double limit() const { return 0.0; }

  template <class Push>
  void open(const WideNode& node, std::uint64_t, Push push)
  {
    for (std::uint32_t near = childrenNear(node, *this->Parent, this->Lane, this->Slack); near != 0;
         near &= near - 1)
    {
      push(static_cast<std::uint32_t>(__builtin_ctz(near)), 0, 0.0f);
    }
  }

  /// Each pair once.
  bool end(const DescentEntry& other)
  {
    if (other.node < this->First)
    {
      return true;
    }
    const WideNode& node = this->Tree.wide.nodes[other.parent];
    for (std::uint32_t near =
           childrenNear(*this->Own, node, static_cast<int>(other.lane), this->Slack);
         near != 0; near &= near - 1)
    {
      const int lane = __builtin_ctz(near);
      const std::uint32_t first = this->Own->first[lane];
      for (std::uint32_t i = 0; other.node >= first && i < this->Own->count[lane]; ++i)
      {
        for (std::uint32_t j = other.node == first ? i + 1 : 0; j < other.count; ++j)
        {
          this->compare(first + i, other.node + j);
        }
      }
    }
    return true;
  }

private:
  void compare(std::uint32_t placeOne, std::uint32_t placeTwo)
  {
    const Face& a = this->Faces[placeOne];
    const Face& b = this->Faces[placeTwo];
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
    // In order, so that nothing depends on the tree.
    const auto [lower, higher] =
      std::minmax({ this->Tree.order[placeOne], this->Tree.order[placeTwo] });
    const Vec3& apex = this->Tree.mesh->corner(lower, 0);
    const Corners one = cornersFrom(*this->Tree.mesh, lower, apex);
    const Corners two = cornersFrom(*this->Tree.mesh, higher, apex);
    const double tolerance = static_cast<double>(a.tolerance) + static_cast<double>(b.tolerance);
    // Most planes that are parallel lie apart.
    const Vec3 n(a.normal[0], a.normal[1], a.normal[2]);
    const double level = tolerance + tilt * glm::dot(glm::abs(two.a), Vec3(1.0));
    if (!(std::fabs(glm::dot(n, two.a)) > level) && !isBeside(one, two) && !isBeside(two, one) &&
      this->Sets.rootOf(lower) != this->Sets.rootOf(higher) && coincide(one, two, tolerance))
    {
      this->Sets.unite(lower, higher);
    }
  }

  const CollisionTree& Tree;
  const std::vector<Face>& Faces;
  const float Slack; ///< m, most that boxes may lie apart
  Forest& Sets;
  TraversalStack Stack;
  const WideNode* Parent = nullptr;
  int Lane = 0;
  const WideNode* Own = nullptr; ///< the node
  std::uint32_t First = 0;       ///< its first leaf's place in the order
};

class Search
{
public:
  Search(const CollisionTree& tree, int threads)
    : Tree(tree)
    , Mesh(*tree.mesh)
    , Threads(threads)
    , Faces(tree.order.size())
    , Sets(tree.order.size())
  {
  }

  /// Set what the tree holds of coincident faces. @return false if stopped
  bool run(const KeepGoing& keepGoing, CollisionTree& tree)
  {
    constexpr std::size_t block = 1024;
    parallelFor(this->Faces.size(), block, this->Threads,
      [this](std::size_t begin, std::size_t end, int)
      {
        for (std::size_t k = begin; k < end; ++k)
        {
          this->Faces[k] = faceOf(this->Mesh, this->Tree.order[k]);
        }
      });
    const float widest = std::max_element(this->Faces.begin(), this->Faces.end(),
      [](const Face& a, const Face& b) {
        return a.tolerance < b.tolerance;
      })->tolerance;
    const float slack = 2.0f * widest + WideRounding * static_cast<float>(tree.wide.extent);
    constexpr std::size_t nodes = 64;
    const bool finished = parallelFor(
      tree.wide.nodes.size(), nodes, this->Threads,
      [&](std::size_t begin, std::size_t end, int)
      {
        LeafSearch search(this->Tree, this->Faces, slack, this->Sets);
        WideNode root;
        root.clear();
        root.first[0] = 0;
        root.halfX[0] = root.halfY[0] = root.halfZ[0] = std::numeric_limits<float>::max();
        for (std::size_t n = begin; n < end; ++n)
        {
          for (int i = 0; i < WideNode::Width; ++i)
          {
            const WideNode& node = tree.wide.nodes[n];
            if (node.count[i] == 0 && node.first[i] != NoChild)
            {
              search.run(node, i);
            }
          }
          if (n == 0)
          {
            search.run(root, 0);
          }
        }
      },
      keepGoing);
    if (finished)
    {
      tree.planeOwners = this->owners();
      tree.planeDepth = tree.planeOwners.empty() ? 0.0 : 2.0 * widest;
    }
    return finished;
  }

private:
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

  /// Empty if nothing coincides.
  std::vector<std::uint32_t> owners()
  {
    bool found = false;
    const auto size = static_cast<std::uint32_t>(this->Faces.size());
    std::vector<std::uint32_t> owners(size, NoTriangle); // of the roots of sets of several
    for (std::uint32_t t = 0; t < size; ++t)
    {
      const std::uint32_t root = this->Sets.rootOf(t);
      std::uint32_t& owner = owners[root];
      if (root != t)
      {
        found = true;
        owner = owner == NoTriangle ? root : owner;
        constexpr double clearly = 1.001; // copies have the plane of the first
        owner = this->leastAltitudeOf(t) > clearly * this->leastAltitudeOf(owner) ? t : owner;
      }
    }
    std::vector<std::uint32_t> result(found ? size : 0, NoTriangle);
    for (std::uint32_t t = 0; t < result.size(); ++t)
    {
      const std::uint32_t owner = owners[this->Sets.rootOf(t)];
      result[t] = owner != NoTriangle && this->fits(t, owner) ? owner : NoTriangle;
    }
    return result;
  }

  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  int Threads;
  std::vector<Face> Faces; ///< in the tree's order
  Forest Sets;
};
}

bool findPlaneOwners(CollisionTree& tree, int threads, const KeepGoing& keepGoing)
{
  return Search(tree, threads).run(keepGoing, tree);
}
}
