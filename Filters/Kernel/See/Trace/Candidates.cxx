// SPDX-License-Identifier: BSD-3-Clause
#include "Candidates.h"

#include "Descents.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Collects the triangles of leaves.
struct LeafCollector
{
  std::vector<std::uint32_t>& triangles;
  double range; ///< largest range of leaves, m
  double limit() const { return this->range; }
  bool leaf(const std::uint32_t* first, std::uint32_t count)
  {
    this->triangles.insert(this->triangles.end(), first, first + count);
    return true;
  }
};

double squareOf(const Vec3& v)
{
  return glm::dot(v, v);
}

/// Squared distance of the apex from the side between two corners, m2.
double squareToSide(const Vec3& a, const Vec3& b)
{
  const Vec3 side = b - a;
  const double length2 = squareOf(side);
  const double t = length2 > 0.0 ? std::clamp(-glm::dot(a, side) / length2, 0.0, 1.0) : 0.0;
  return squareOf(a + t * side);
}

/// True if the whole triangle, with corners relative to the apex, is farther than a range, m.
bool isFarther(const Corners& t, double range)
{
  const double square = range * range;
  if (squareOf(t.a) <= square || squareToSide(t.a, t.b) <= square ||
    squareToSide(t.b, t.c) <= square || squareToSide(t.c, t.a) <= square)
  {
    return false;
  }
  const Vec3 normal = normalOf(t);
  const double height = glm::dot(normal, t.a);
  const auto side = [&](const Vec3& a, const Vec3& b)
  { return glm::dot(glm::cross(b - a, -a), normal) > 0.0; };
  const bool isAbove = side(t.a, t.b) && side(t.b, t.c) && side(t.c, t.a);
  return !(isAbove && height * height <= square * squareOf(normal));
}
}

void BeamCandidates::begin(
  const SceneTriangles& scene, const BeamFrame* frames, std::size_t count, bool together)
{
  this->Scene = &scene;
  this->Tree = &scene.tree();
  this->Frames = frames;
  GroupRule rule;
  rule.together = together;
  const bool isEmpty = this->Tree->empty() && scene.moved().empty();
  this->Groups.begin(*this->Tree, frames, isEmpty ? 0 : count, rule);
}

bool BeamCandidates::next()
{
  BeamCluster cluster;
  while (this->Groups.next(cluster))
  {
    this->Beam = cluster.beams[0];
    this->Entries = cluster.entries;
    this->NodesVisited = cluster.nodesVisited;
    if (!this->Entries || !this->Entries->nodes.empty() || !this->Scene->moved().empty())
    {
      return true;
    }
  }
  return false;
}

const std::vector<std::uint32_t>& BeamCandidates::collect(double range)
{
  this->Triangles.clear();
  if (!this->Tree->empty() && (!this->Entries || !this->Entries->nodes.empty()))
  {
    // Triangles beyond the range go by their own distances, so that no list depends on the tree.
    constexpr double Margin = 1.0 + 1e-6;
    const BeamFrame& frame = this->Frames[this->Beam];
    const double most = Margin * limitOf(*this->Tree, range);
    LeafCollector leaves{ this->Triangles, Margin * most };
    this->NodesVisited +=
      descendCone(*this->Tree, frame, leaves, this->Groups.stack(), this->Entries);
    if (most < std::numeric_limits<double>::infinity())
    {
      this->Triangles.erase(
        std::remove_if(this->Triangles.begin(), this->Triangles.end(),
          [&](std::uint32_t triangle)
          { return isFarther(this->Scene->cornersFrom(triangle, frame.origin), most); }),
        this->Triangles.end());
    }
  }
  const std::vector<std::uint32_t>& moved = this->Scene->moved();
  this->Triangles.insert(this->Triangles.end(), moved.begin(), moved.end());
  return this->Triangles;
}

double BeamCandidates::farthest() const
{
  const WideTree& boxes = this->Tree->wide;
  if (boxes.nodes.empty() || !this->Scene->moved().empty())
  {
    return std::numeric_limits<double>::infinity();
  }
  const WideNode& root = boxes.nodes[0];
  const Vec3 apex = this->Frames[this->Beam].origin - boxes.reference;
  double square = 0.0;
  for (std::uint32_t i = 0; i < WideNode::Width; ++i)
  {
    if (root.first[i] != NoChild)
    {
      const Vec3 center(root.x[i], root.y[i], root.z[i]);
      const Vec3 half(root.halfX[i], root.halfY[i], root.halfZ[i]);
      square = std::max(square, squareOf(glm::abs(center - apex) + half));
    }
  }
  constexpr double Rounding = 1.0 + 1e-5;
  return Rounding * std::sqrt(square);
}
}
