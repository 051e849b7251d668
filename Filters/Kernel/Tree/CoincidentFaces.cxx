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

/// True if a side separates two triangles, seen along an axis. @param corners corners of both
bool areBeside(const Vec3* const* corners, int axis)
{
  double x[6];
  double y[6];
  for (int c = 0; c < 6; ++c)
  {
    x[c] = (&corners[c]->x)[(axis + 1) % 3];
    y[c] = (&corners[c]->x)[(axis + 2) % 3];
  }
  constexpr int nexts[] = { 1, 2, 0, 4, 5, 3 };
  for (int from = 0; from < 6; ++from)
  {
    const int to = nexts[from];
    const auto side = [&](int c)
    { return (x[to] - x[from]) * (y[c] - y[from]) - (y[to] - y[from]) * (x[c] - x[from]); };
    const double sign = side(nexts[to]) > 0.0 ? 1.0 : -1.0;
    const int other = from < 3 ? 3 : 0;
    if (sign * side(other) <= 0.0 && sign * side(other + 1) <= 0.0 && sign * side(other + 2) <= 0.0)
    {
      return true;
    }
  }
  return false;
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

constexpr std::size_t FaceWidth = 8; ///< number of faces in a loop over lanes

/// Numbers of a face in single precision.
enum FaceNumber : std::size_t
{
  NormalX, ///< unit normal; 0 if the triangle is degenerate
  NormalY,
  NormalZ,
  Tilt,      ///< angle by which rounding may turn the plane, rad
  Tolerance, ///< most by which rounding moves a corner off the plane, rounded up, m
  PointX,    ///< first corner relative to a reference, m
  PointY,
  PointZ,
  FaceNumbers
};

/// Set the numbers of FaceWidth faces, of which `count` are used. @param to the numbers of a face
/// are `stride` apart
AVIANLIDAR_MULTIVERSION void setFaces(const TriangleMesh& mesh, const std::uint32_t* triangles,
  std::size_t count, const Vec3& reference, float* to, std::size_t stride)
{
  double corners[9][FaceWidth] = {};
  double ofSingle[FaceWidth] = {}; ///< rounding to single precision, if all numbers are single
  for (std::size_t i = 0; i < count; ++i)
  {
    std::uint64_t digits = 0;
    for (int k = 0; k < 9; ++k)
    {
      const double x = mesh.corner(triangles[i], k / 3)[k % 3];
      std::uint64_t bits;
      std::memcpy(&bits, &x, sizeof bits);
      corners[k][i] = x;
      digits |= bits;
    }
    // A number of single precision has zeros in the last bits of its double. The bits are tested
    // because GCC 12 drops roundings to single precision and back where it vectorises them.
    ofSingle[i] = (digits & 0x1fffffffu) == 0 ? 4.0 * RoundOffSingle : 0.0;
  }
  constexpr float up = 1.0f + 1e-6f;
  constexpr double most = 5e-4;
#pragma omp simd
  for (std::size_t i = 0; i < FaceWidth; ++i)
  {
    const Vec3 a(corners[0][i], corners[1][i], corners[2][i]);
    const Vec3 b(corners[3][i], corners[4][i], corners[5][i]);
    const Vec3 c(corners[6][i], corners[7][i], corners[8][i]);
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 bc = ac - ab;
    const Vec3 area = glm::cross(ab, ac);
    const double squared = glm::dot(area, area);
    const double longest =
      std::sqrt(glm::max(glm::dot(ab, ab), glm::max(glm::dot(bc, bc), glm::dot(ac, ac))));
    const Vec3 largest = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c)));
    const double good = squared > 0.0 ? 1.0 : 0.0; // 0 for a degenerate triangle
    const double size = std::sqrt(squared + (1.0 - good));
    const Vec3 n = area / size;
    const double single = ofSingle[i] * glm::dot(glm::abs(n), largest);
    const double tolerance = good *
      (32.0 * RoundOffDouble * glm::max(largest.x, glm::max(largest.y, largest.z)) +
        (single < most ? single : most));
    const Vec3 point = a - reference;
    to[NormalX * stride + i] = static_cast<float>(n.x);
    to[NormalY * stride + i] = static_cast<float>(n.y);
    to[NormalZ * stride + i] = static_cast<float>(n.z);
    to[Tilt * stride + i] =
      up * static_cast<float>((2.0 * tolerance + 8.0 * RoundOffDouble * longest) * longest / size);
    to[Tolerance * stride + i] = up * static_cast<float>(tolerance);
    to[PointX * stride + i] = static_cast<float>(point.x);
    to[PointY * stride + i] = static_cast<float>(point.y);
    to[PointZ * stride + i] = static_cast<float>(point.z);
  }
}

/// Find pairs of faces that may have one plane. @param one,two numbers of FaceWidth faces, read as
/// setFaces() writes them @param countOne number of faces `one` @param slack rounding of points, m
/// @return bit FaceWidth i + j for the faces i and j
AVIANLIDAR_MULTIVERSION std::uint64_t facesNear(
  const float* one, std::size_t countOne, const float* two, std::size_t stride, float slack)
{
  std::uint64_t near = 0;
  for (std::size_t i = 0; i < countOne; ++i)
  {
    const float* const a = one + i;
    const float ax = a[NormalX * stride];
    const float ay = a[NormalY * stride];
    const float az = a[NormalZ * stride];
    std::uint32_t bits = 0;
#pragma omp simd reduction(| : bits)
    for (std::size_t j = 0; j < FaceWidth; ++j)
    {
      const float* const b = two + j;
      const float bx = b[NormalX * stride];
      const float by = b[NormalY * stride];
      const float bz = b[NormalZ * stride];
      const float sineX = ay * bz - by * az;
      const float sineY = az * bx - bz * ax;
      const float sineZ = ax * by - bx * ay;
      const float tilt = a[Tilt * stride] + b[Tilt * stride] + TiltOfRounding;
      const float x = b[PointX * stride] - a[PointX * stride];
      const float y = b[PointY * stride] - a[PointY * stride];
      const float z = b[PointZ * stride] - a[PointZ * stride];
      const float level = a[Tolerance * stride] + b[Tolerance * stride] + slack +
        tilt * (std::fabs(x) + std::fabs(y) + std::fabs(z));
      const bool met = (sineX * sineX + sineY * sineY + sineZ * sineZ <= tilt * tilt) &
        (std::fabs(ax * bx + ay * by + az * bz) > 0.5f) &
        !(std::fabs(ax * x + ay * y + az * z) > level);
      bits |= (met ? 1u : 0u) << j;
    }
    near |= static_cast<std::uint64_t>(bits) << (FaceWidth * i);
  }
  return near;
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
    , Stride(tree.order.size() + FaceWidth)
    , Faces(FaceNumbers * this->Stride)
    , Sets(tree.order.size())
  {
  }

  /// Set planeOwners and planeDepth of the tree. @return false if stopped
  bool run(const KeepGoing& keepGoing, int threads, CollisionTree& tree)
  {
    const std::vector<std::uint32_t>& order = this->Tree.order;
    constexpr std::size_t block = 1024;
    parallelFor(order.size(), block, threads,
      [&](std::size_t begin, std::size_t end, int)
      {
        for (std::size_t k = begin; k < end; k += FaceWidth)
        {
          setFaces(this->Mesh, &order[k], std::min(FaceWidth, end - k), tree.wide.reference,
            &this->Faces[k], this->Stride);
        }
      });
    const auto tolerances = this->Faces.begin() + Tolerance * this->Stride;
    const float widest = *std::max_element(tolerances, tolerances + order.size());
    this->Rounding = WideRounding * static_cast<float>(tree.wide.extent);
    this->Slack = 2.0f * widest + this->Rounding;
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
      this->compareNear({ &node, i }, node, (node.count[i] > 0 ? ~0u : ~1u) << i);
    }
  }

  /// Compare the triangles of a child with the triangles of some children of a node. @param some
  /// bits of these children
  void compareNear(const Child& one, const WideNode& node, std::uint32_t some)
  {
    some &= childrenNear(node, *one.node, one.lane, this->Slack);
    while (some != 0)
    {
      const Child two{ &node, __builtin_ctz(some) };
      some &= some - 1;
      if (one.count() == 0 || two.count() == 0)
      {
        this->compareBelow(one, two);
        continue;
      }
      // Leaves that fill one vector are compared at once, with what lies between them.
      std::uint32_t end = two.first() + two.count();
      for (; some != 0; some &= some - 1)
      {
        const Child next{ &node, __builtin_ctz(some) };
        const std::uint32_t width = next.first() + next.count() - two.first();
        if (next.count() == 0 || width > FaceWidth)
        {
          break;
        }
        end = two.first() + width;
      }
      this->compareLeaves(one, two.first(), end);
    }
  }

  /// Compare the triangles of two children, one of which is a node.
  void compareBelow(Child one, Child two)
  {
    if (two.count() > 0 || (one.count() == 0 && one.size() > two.size()))
    {
      std::swap(one, two);
    }
    this->compareNear(one, this->Tree.wide.nodes[two.first()], ~0u);
  }

  /// Compare the triangles of a leaf with those at places [begin, end), each pair once.
  void compareLeaves(const Child& leaf, std::uint32_t begin, std::uint32_t end)
  {
    const std::uint32_t endOne = leaf.first() + leaf.count();
    for (std::uint32_t i = leaf.first(); i < endOne; i += FaceWidth)
    {
      for (std::uint32_t j = begin; j < end; j += FaceWidth)
      {
        std::uint64_t near =
          facesNear(&this->Faces[i], std::min<std::size_t>(FaceWidth, endOne - i), &this->Faces[j],
            this->Stride, this->Rounding);
        for (; near != 0; near &= near - 1)
        {
          const auto pair = static_cast<std::uint32_t>(__builtin_ctzll(near));
          const std::uint32_t placeOne = i + pair / FaceWidth;
          const std::uint32_t placeTwo = j + pair % FaceWidth;
          if (placeTwo < end && (placeTwo > placeOne || placeTwo < leaf.first()))
          {
            this->compare(placeOne, placeTwo);
          }
        }
      }
    }
  }

  float face(FaceNumber number, std::uint32_t place) const
  {
    return this->Faces[number * this->Stride + place];
  }

  void compare(std::uint32_t placeOne, std::uint32_t placeTwo)
  {
    // The order of triangle numbers makes the result independent of the tree.
    const auto [lower, higher] =
      std::minmax({ this->Tree.order[placeOne], this->Tree.order[placeTwo] });
    const float normal[] = { std::fabs(this->face(NormalX, placeOne)),
      std::fabs(this->face(NormalY, placeOne)), std::fabs(this->face(NormalZ, placeOne)) };
    const auto axis = static_cast<int>(std::max_element(normal, normal + 3) - normal);
    const Vec3* corners[6];
    for (int c = 0; c < 3; ++c)
    {
      corners[c] = &this->Mesh.corner(lower, c);
      corners[c + 3] = &this->Mesh.corner(higher, c);
    }
    if (areBeside(corners, axis) || this->Sets.rootOf(lower) == this->Sets.rootOf(higher))
    {
      return;
    }
    const Vec3& apex = this->Mesh.corner(lower, 0);
    const double tolerance =
      double{ this->face(Tolerance, placeOne) } + double{ this->face(Tolerance, placeTwo) };
    if (coincide(
          cornersFrom(this->Mesh, lower, apex), cornersFrom(this->Mesh, higher, apex), tolerance))
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
    const double own = this->Tolerances[triangle];
    const double ofPlane = this->Tolerances[owner];
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
    const auto size = static_cast<std::uint32_t>(this->Mesh.size());
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
    this->Tolerances.resize(result.size());
    for (std::uint32_t k = 0; k < result.size(); ++k)
    {
      this->Tolerances[this->Tree.order[k]] = this->face(Tolerance, k);
    }
    for (std::uint32_t t = 0; t < result.size(); ++t)
    {
      const std::uint32_t owner = owners[this->Sets.rootOf(t)];
      result[t] = owner != NoTriangle && this->fits(t, owner) ? owner : NoTriangle;
    }
    return result;
  }

  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  const std::size_t Stride;      ///< distance of the numbers of a face in `Faces`
  std::vector<float> Faces;      ///< faces in the tree's order
  std::vector<float> Tolerances; ///< FaceNumber::Tolerance by triangle, if any faces coincide
  float Rounding = 0.0f;         ///< rounding of positions in single precision, m
  float Slack = 0.0f;            ///< largest distance between the boxes of coincident triangles, m
  Forest Sets;
};
}

bool findPlaneOwners(CollisionTree& tree, int threads, const KeepGoing& keepGoing)
{
  return Search(tree).run(keepGoing, threads, tree);
}
}
