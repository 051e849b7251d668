// SPDX-License-Identifier: BSD-3-Clause
#include "CoincidentFaces.h"

#include <boost/container/static_vector.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <utility>

namespace avianlidar
{
namespace
{
/// Least overlap, as a share of the smaller triangle. Rounding makes neighbours overlap by less.
constexpr double LeastOverlap = 1e-6;

/// Angle, rad, that single precision may add between two normals.
constexpr float TiltOfRounding = 1e-6f;

/// Factor by which an altitude must be larger to change the owner of a plane. Among copies, the
/// first triangle then remains the owner.
constexpr double ClearlyLarger = 1.001;

/// Plane of a triangle in single precision.
struct Face
{
  glm::vec3 normal{ 0.0f };
  float tilt = 0.0f;      ///< angle by which rounding may turn the plane, rad
  float tolerance = 0.0f; ///< toleranceOf(), rounded up, m
};

/// Vector along the normal whose length is twice the area, m2.
Vec3 areaOf(const Corners& t)
{
  return glm::cross(t.b - t.a, t.c - t.a);
}

double longestSideOf(const Corners& t)
{
  const Vec3 ab = t.b - t.a;
  const Vec3 bc = t.c - t.b;
  const Vec3 ca = t.a - t.c;
  return std::sqrt(std::max({ glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca) }));
}

double leastAltitudeOf(const Corners& t)
{
  return glm::length(areaOf(t)) / longestSideOf(t);
}

/// Corners relative to the first corner.
Corners cornersOf(const TriangleMesh& mesh, std::uint32_t triangle)
{
  return cornersFrom(mesh, triangle, mesh.corner(triangle, 0));
}

/// True if a number has no more digits than single precision. Its bits are tested because GCC 12
/// drops roundings to single precision and back where it vectorises them.
bool isSingle(double x)
{
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return (bits & 0x1fffffffu) == 0;
}

/// Most by which rounding moves a corner of the triangle off its plane, m. @param normal unit
/// normal
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
    allSingle = allSingle && isSingle(p.x) && isSingle(p.y) && isSingle(p.z);
    largest = glm::max(largest, glm::abs(p));
  }
  return ofDouble * std::max({ largest.x, largest.y, largest.z }) +
    (allSingle ? std::min(most, ofSingle * glm::dot(glm::abs(normal), largest)) : 0.0);
}

Face faceOf(const TriangleMesh& mesh, std::uint32_t triangle)
{
  const Corners t = cornersOf(mesh, triangle);
  const Vec3 area = areaOf(t);
  const double size = glm::length(area);
  if (!(size > 0.0))
  {
    return {};
  }
  const Vec3 n = area / size;
  const double tolerance = toleranceOf(mesh, triangle, n);
  const double longest = longestSideOf(t);
  constexpr float up = 1.0f + 1e-6f;
  return { glm::vec3(n),
    up * static_cast<float>((2.0 * tolerance + 8.0 * RoundOffDouble * longest) * longest / size),
    up * static_cast<float>(tolerance) };
}

/// True if, seen along the normal of the first triangle, one of its sides separates the two
/// triangles.
bool isBeside(const Corners& one, const Corners& two)
{
  const Vec3 n = areaOf(one);
  const auto separates = [&](const Vec3& from, const Vec3& to)
  {
    const Vec3 inwards = glm::cross(n, to - from);
    return glm::dot(inwards, two.a - from) <= 0.0 && glm::dot(inwards, two.b - from) <= 0.0 &&
      glm::dot(inwards, two.c - from) <= 0.0;
  };
  return separates(one.a, one.b) || separates(one.b, one.c) || separates(one.c, one.a);
}

/// True if two triangles overlap, and are nowhere in their overlap farther apart than `tolerance`.
bool coincide(const Corners& one, const Corners& two, double tolerance)
{
  const Vec3 area = areaOf(one);
  const double size = glm::length(area);
  const Vec3 n = area / size;
  // Part of the second triangle within the sides of the first. The part has six corners at most. If
  // rounding bends a side, a ring may cross each line more than twice. Rings of 3, 4 and 6 corners
  // then get 4, 6 and 9 corners: half of the corners are kept, and each crossing adds a corner.
  using Ring = boost::container::static_vector<Vec3, 9>;
  Ring ring{ two.a, two.b, two.c };
  const Vec3 corners[] = { one.a, one.b, one.c };
  for (int k = 0; k < 3; ++k)
  {
    const Vec3& from = corners[k];
    const Vec3 inwards = glm::cross(n, corners[(k + 1) % 3] - from);
    const Ring whole = std::exchange(ring, {});
    Vec3 before = whole.back();
    double sideBefore = glm::dot(inwards, before - from);
    for (const Vec3& p : whole)
    {
      const double side = glm::dot(inwards, p - from);
      if (sideBefore * side < 0.0)
      {
        ring.push_back(before + sideBefore / (sideBefore - side) * (p - before));
      }
      if (side >= 0.0)
      {
        ring.push_back(p);
      }
      before = p;
      sideBefore = side;
    }
    if (ring.size() < 3)
    {
      return false;
    }
  }
  Vec3 overlap(0.0);
  double farthest = 0.0;
  Vec3 before = ring.back();
  for (const Vec3& p : ring)
  {
    overlap += glm::cross(before - ring[0], p - ring[0]);
    farthest = std::max(farthest, std::fabs(glm::dot(n, p - one.a)));
    before = p;
  }
  const double least = std::min(size, glm::length(areaOf(two)));
  const double edge = 8.0 * tolerance * std::min(longestSideOf(one), longestSideOf(two));
  return farthest <= tolerance &&
    std::fabs(glm::dot(n, overlap)) > std::max(LeastOverlap * least, edge);
}

/// Bits of the children of `node` within `slack` (m) of the child `lane` of `other`.
AVIANLIDAR_MULTIVERSION std::uint32_t childrenNear(
  const WideNode& node, const WideNode& other, int lane, float slack)
{
  std::uint32_t near = 0;
#pragma omp simd reduction(| : near)
  for (int i = 0; i < WideNode::Width; ++i)
  {
    const float x = std::fabs(node.x[i] - other.x[lane]) - (node.halfX[i] + other.halfX[lane]);
    const float y = std::fabs(node.y[i] - other.y[lane]) - (node.halfY[i] + other.halfY[lane]);
    const float z = std::fabs(node.z[i] - other.z[lane]) - (node.halfZ[i] + other.halfZ[lane]);
    const float apart = x > y ? (x > z ? x : z) : (y > z ? y : z);
    near |= (!(apart > slack) & (node.first[i] != NoChild) ? 1u : 0u) << i;
  }
  return near;
}

/// Sets of coincident triangles, united by several threads. The root of a set is its lowest
/// triangle number, whatever the order of the pairs.
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

  std::uint32_t rootOf(std::uint32_t t)
  {
    while (this->Parents[t] != t)
    {
      t = this->Parents[t] = this->Parents[this->Parents[t]].load(); // shortens the path
    }
    return t;
  }

  void unite(std::uint32_t one, std::uint32_t two)
  {
    while ((one = this->rootOf(one)) != (two = this->rootOf(two)))
    {
      std::uint32_t higher = std::max(one, two);
      this->Parents[higher].compare_exchange_strong(higher, std::min(one, two));
    }
  }

private:
  std::vector<std::atomic<std::uint32_t>> Parents;
};

/// A child of a node of the tree.
struct Child
{
  const WideNode* node;
  int lane;

  std::uint32_t first() const { return this->node->first[this->lane]; }
  std::uint32_t count() const { return this->node->count[this->lane]; }
  float size() const
  {
    return this->node->halfX[this->lane] + this->node->halfY[this->lane] +
      this->node->halfZ[this->lane];
  }
};

class Search
{
public:
  explicit Search(const CollisionTree& tree)
    : Tree(tree)
    , Mesh(*tree.mesh)
    , Faces(tree.order.size())
    , Sets(tree.order.size())
  {
  }

  /// Set planeOwners and planeDepth of the tree. @return false if stopped
  bool run(const KeepGoing& keepGoing, int threads, CollisionTree& tree)
  {
    constexpr std::size_t block = 1024;
    parallelFor(this->Faces.size(), block, threads,
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
    this->Slack = 2.0f * widest + WideRounding * static_cast<float>(tree.wide.extent);
    constexpr std::size_t nodes = 64;
    const bool finished = parallelFor(
      tree.wide.nodes.size(), nodes, threads,
      [&](std::size_t begin, std::size_t end, int)
      {
        for (std::size_t n = begin; n < end; ++n)
        {
          this->compareChildren(tree.wide.nodes[n]);
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
  /// Compare the triangles of different children of a node, and the triangles within each leaf.
  void compareChildren(const WideNode& node)
  {
    for (int i = 0; i < WideNode::Width && node.first[i] != NoChild; ++i)
    {
      for (std::uint32_t k = 1; k < node.count[i]; ++k)
      {
        for (std::uint32_t j = 0; j < k; ++j)
        {
          this->compare(node.first[i] + j, node.first[i] + k);
        }
      }
      this->compareNear({ &node, i }, node, ~1u << i);
    }
  }

  /// Compare the triangles of a child with the triangles of some children of a node. @param some
  /// bits of these children
  void compareNear(const Child& one, const WideNode& node, std::uint32_t some)
  {
    some &= childrenNear(node, *one.node, one.lane, this->Slack);
    for (; some != 0; some &= some - 1)
    {
      this->compareBelow(one, { &node, __builtin_ctz(some) });
    }
  }

  void compareBelow(Child one, Child two)
  {
    if (one.count() > 0 && two.count() > 0)
    {
      for (std::uint32_t i = 0; i < one.count(); ++i)
      {
        for (std::uint32_t j = 0; j < two.count(); ++j)
        {
          this->compare(one.first() + i, two.first() + j);
        }
      }
      return;
    }
    if (two.count() > 0 || (one.count() == 0 && one.size() > two.size()))
    {
      std::swap(one, two);
    }
    this->compareNear(one, this->Tree.wide.nodes[two.first()], ~0u);
  }

  void compare(std::uint32_t placeOne, std::uint32_t placeTwo)
  {
    const Face& a = this->Faces[placeOne];
    const Face& b = this->Faces[placeTwo];
    const glm::vec3 sine = glm::cross(a.normal, b.normal);
    const float tilt = a.tilt + b.tilt + TiltOfRounding;
    if (!(glm::dot(sine, sine) <= tilt * tilt) || !(std::fabs(glm::dot(a.normal, b.normal)) > 0.5f))
    {
      return;
    }
    // The order of triangle numbers makes the result independent of the tree.
    const auto [lower, higher] =
      std::minmax({ this->Tree.order[placeOne], this->Tree.order[placeTwo] });
    const Vec3& apex = this->Mesh.corner(lower, 0);
    const Vec3 between = this->Mesh.corner(higher, 0) - apex;
    const double tolerance = static_cast<double>(a.tolerance) + static_cast<double>(b.tolerance);
    // Most parallel planes lie apart and need no exact comparison.
    const double level = tolerance + tilt * glm::dot(glm::abs(between), Vec3(1.0));
    if (std::fabs(glm::dot(Vec3(a.normal), between)) > level)
    {
      return;
    }
    const Corners one = cornersFrom(this->Mesh, lower, apex);
    const Corners two = cornersFrom(this->Mesh, higher, apex);
    if (!isBeside(one, two) && !isBeside(two, one) &&
      this->Sets.rootOf(lower) != this->Sets.rootOf(higher) && coincide(one, two, tolerance))
    {
      this->Sets.unite(lower, higher);
    }
  }

  /// True if rounding explains the distance of a triangle from the plane of another triangle.
  bool fits(std::uint32_t triangle, std::uint32_t owner) const
  {
    const Corners plane = cornersOf(this->Mesh, owner);
    const Corners t = cornersFrom(this->Mesh, triangle, this->Mesh.corner(owner, 0));
    const Vec3 n = areaOf(plane) / glm::length(areaOf(plane));
    const double least = leastAltitudeOf(plane);
    const double own = faceOf(this->Mesh, triangle).tolerance;
    const double ofPlane = faceOf(this->Mesh, owner).tolerance;
    const auto isOnPlane = [&](const Vec3& corner)
    {
      const double reach = 1.0 + 4.0 * glm::length(corner) / least;
      return std::fabs(glm::dot(n, corner)) <= own + ofPlane * reach;
    };
    return isOnPlane(t.a) && isOnPlane(t.b) && isOnPlane(t.c);
  }

  /// Owner of the plane of each triangle, or NoTriangle; empty if nothing coincides.
  std::vector<std::uint32_t> owners()
  {
    bool found = false;
    const auto size = static_cast<std::uint32_t>(this->Faces.size());
    std::vector<std::uint32_t> owners(size, NoTriangle); // owners by root of a set
    for (std::uint32_t t = 0; t < size; ++t)
    {
      const std::uint32_t root = this->Sets.rootOf(t);
      std::uint32_t& owner = owners[root];
      if (root != t)
      {
        found = true;
        owner = owner == NoTriangle ? root : owner;
        const auto altitude = [&](std::uint32_t of)
        { return leastAltitudeOf(cornersOf(this->Mesh, of)); };
        owner = altitude(t) > ClearlyLarger * altitude(owner) ? t : owner;
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
  std::vector<Face> Faces; ///< faces in the tree's order
  float Slack = 0.0f;      ///< largest distance between the boxes of coincident triangles, m
  Forest Sets;
};
}

bool findPlaneOwners(CollisionTree& tree, int threads, const KeepGoing& keepGoing)
{
  return Search(tree).run(keepGoing, threads, tree);
}
}
