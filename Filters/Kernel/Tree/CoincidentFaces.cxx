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
  float tilt;      ///< rad, by which rounding may turn it
  float tolerance; ///< toleranceOf(), rounded up
};

double longestSideOf(const Corners& t)
{
  return std::max(safeLength(t.b - t.a), std::max(safeLength(t.c - t.b), safeLength(t.a - t.c)));
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
  const Corners t = cornersOf(mesh, triangle);
  const Vec3 area = normalOf(t);
  const double size = safeLength(area);
  if (!(size > 0.0))
  {
    return {};
  }
  const Vec3 n = area / size;
  const double tolerance = toleranceOf(mesh, triangle, n);
  constexpr float up = 1.0f + 1e-6f;
  return { { static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z) },
    up * static_cast<float>(2.0 * tolerance * longestSideOf(t) / size),
    up * static_cast<float>(tolerance) };
}

/// True if two triangles overlap, and are nowhere in their overlap farther apart than `tolerance`.
bool coincide(const Corners& one, const Corners& two, double tolerance)
{
  const Vec3 area = normalOf(one);
  const double size = safeLength(area);
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
  const double least = std::min(size, safeLength(normalOf(two)));
  const double edge = 8.0 * tolerance * std::min(longestSideOf(one), longestSideOf(two));
  return farthest <= tolerance &&
    std::fabs(glm::dot(n, overlap)) > std::max(LeastOverlap * least, edge);
}

/// A box of the wide tree.
struct Part
{
  float low[3], high[3];
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
    , Faces(tree.mesh->size())
    , Parents(new std::atomic<std::uint32_t>[tree.mesh->size()])
  {
  }

  std::vector<std::uint32_t> run()
  {
    constexpr std::size_t block = 1024;
    std::atomic<float> widest{ 0.0f };
    this->Team.loop(this->Faces.size(), block,
      [&](std::size_t begin, std::size_t end, int)
      {
        float most = 0.0f;
        for (std::size_t t = begin; t < end; ++t)
        {
          this->Faces[t] = faceOf(this->Mesh, static_cast<std::uint32_t>(t));
          this->Parents[t] = static_cast<std::uint32_t>(t);
          most = std::max(most, this->Faces[t].tolerance);
        }
        float known = widest;
        while (known < most && !widest.compare_exchange_weak(known, most))
        {
        }
      });
    this->Slack = 2.0f * widest;
    std::vector<PartPair> pairs = this->firstPairs();
    this->Team.loop(pairs.size(), 1,
      [&](std::size_t begin, std::size_t end, int)
      {
        std::vector<PartPair> stack(pairs.begin() + begin, pairs.begin() + end);
        while (!stack.empty())
        {
          const PartPair pair = stack.back();
          stack.pop_back();
          this->visit(pair, stack);
        }
      });
    return this->Found ? this->owners() : std::vector<std::uint32_t>();
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

  template <class F>
  void forEachChild(std::uint32_t number, F f) const
  {
    const WideNode& node = this->Tree.wide.nodes[number];
    for (int i = 0; i < WideNode::Width; ++i)
    {
      if (node.first[i] != NoChild)
      {
        f(Part{ { node.x[i] - node.halfX[i], node.y[i] - node.halfY[i], node.z[i] - node.halfZ[i] },
          { node.x[i] + node.halfX[i], node.y[i] + node.halfY[i], node.z[i] + node.halfZ[i] },
          node.first[i], node.count[i] });
      }
    }
  }

  void addIfMet(const Part& one, const Part& two, bool wanted, std::vector<PartPair>& pairs) const
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      wanted = wanted && !(one.low[axis] > two.high[axis] + this->Slack) &&
        !(two.low[axis] > one.high[axis] + this->Slack);
    }
    if (wanted)
    {
      pairs.emplace_back(one, two);
    }
  }

  void visit(const PartPair& pair, std::vector<PartPair>& more)
  {
    const Part& one = pair.first;
    const Part& two = pair.second;
    if (one.isLeaf() && two.isLeaf())
    {
      this->compare(one, two);
    }
    else if (one == two)
    {
      this->forEachChild(one.first,
        [&](const Part& a)
        {
          bool after = false; // each pair once
          this->forEachChild(one.first,
            [&](const Part& b)
            {
              after = after || a == b;
              this->addIfMet(a, b, after, more);
            });
        });
    }
    else
    {
      const bool opensOne = !one.isLeaf();
      this->forEachChild(opensOne ? one.first : two.first,
        [&](const Part& child) { this->addIfMet(child, opensOne ? two : one, true, more); });
    }
  }

  void compare(const Part& one, const Part& two)
  {
    for (std::uint32_t i = 0; i < one.count; ++i)
    {
      for (std::uint32_t j = one == two ? i + 1 : 0; j < two.count; ++j)
      {
        const auto both =
          std::minmax(this->Tree.order[one.first + i], this->Tree.order[two.first + j]);
        this->compare(both.first, both.second);
      }
    }
  }

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
    if (!(x * x + y * y + z * z <= tilt * tilt) || !(std::fabs(cosine) > 0.5f) ||
      this->rootOf(one) == this->rootOf(two))
    {
      return;
    }
    const Vec3& apex = this->Mesh.corner(one, 0);
    if (coincide(cornersFrom(this->Mesh, one, apex), cornersFrom(this->Mesh, two, apex),
          static_cast<double>(a.tolerance) + static_cast<double>(b.tolerance)))
    {
      this->unite(one, two);
      this->Found = true;
    }
  }

  std::uint32_t rootOf(std::uint32_t triangle) const
  {
    while (true)
    {
      const std::uint32_t parent = this->Parents[triangle].load(std::memory_order_relaxed);
      if (parent == triangle)
      {
        return triangle;
      }
      triangle = parent;
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
    return safeLength(normalOf(t)) / longestSideOf(t);
  }

  /// True if rounding explains how far a triangle lies from the plane of another.
  bool fits(std::uint32_t triangle, std::uint32_t owner) const
  {
    const Corners plane = cornersOf(this->Mesh, owner);
    const Corners t = cornersFrom(this->Mesh, triangle, this->Mesh.corner(owner, 0));
    const Vec3 area = normalOf(plane);
    const Vec3 n = area / safeLength(area);
    const double least = this->leastAltitudeOf(owner);
    for (const Vec3* corner : { &t.a, &t.b, &t.c })
    {
      const double ofOwner = static_cast<double>(this->Faces[owner].tolerance) *
        (1.0 + 4.0 * safeLength(*corner) / least);
      if (!(std::fabs(glm::dot(n, *corner)) <=
            static_cast<double>(this->Faces[triangle].tolerance) + ofOwner))
      {
        return false;
      }
    }
    return true;
  }

  std::vector<std::uint32_t> owners() const
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
  std::unique_ptr<std::atomic<std::uint32_t>[]> Parents; ///< of sets of triangles that coincide
  float Slack = 0.0f;                                    ///< m, most that boxes may lie apart
  std::atomic<bool> Found{ false };
};
}

std::vector<std::uint32_t> findPlaneOwners(const CollisionTree& tree, ParallelTeam& team)
{
  return Search(tree, team).run();
}
}
