// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectSpheres.h"

#include "BoundingVolume.h"
#include "Hash.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <unordered_map>

namespace avianlidar
{
namespace
{
constexpr std::uint32_t SpheresOfLeaf = 4;

/// Rounding of centres and distances.
constexpr double BarelyWider = 1.0 + 1e-12;

/// Numbers of the objects of all triangles, from 0 on in the order in which they come.
std::vector<std::uint32_t> numbersOf(const SharedVector<int>& ids, std::size_t& count)
{
  std::unordered_map<int, std::uint32_t> known;
  std::vector<std::uint32_t> numbers(ids.size());
  // Neighbouring triangles mostly are of one object.
  int last = 0;
  std::uint32_t number = 0;
  for (std::size_t t = 0; t < ids.size(); ++t)
  {
    const int id = ids[t];
    if (t == 0 || id != last)
    {
      number = known.emplace(id, static_cast<std::uint32_t>(known.size())).first->second;
      last = id;
    }
    numbers[t] = number;
  }
  count = known.size();
  return numbers;
}

/// A total order that does not ask for ids.
bool before(const ObjectSphere& a, const ObjectSphere& b)
{
  return std::tie(a.radius, a.center.x, a.center.y, a.center.z, a.number) <
    std::tie(b.radius, b.center.x, b.center.y, b.center.z, b.number);
}
}

ObjectSpheres::ObjectSpheres(
  const TriangleMesh& mesh, std::uint64_t geometry, const SharedVector<int>& objectIds)
  : Geometry(geometry)
  , ObjectIds(objectIds)
{
  if (objectIds.size() != mesh.size())
  {
    return;
  }
  std::size_t count = 0;
  const std::vector<std::uint32_t> objects = numbersOf(objectIds, count);
  std::vector<AABB> boxes(count);
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    for (int c = 0; c < 3; ++c)
    {
      boxes[objects[t]].extend(mesh.corner(t, c));
    }
  }
  this->Objects = static_cast<std::uint32_t>(count);
  this->Checksum = hashOf(objects.data(), objects.size() * sizeof(objects[0]), count);
  this->Spheres.resize(count);
  for (std::uint32_t k = 0; k < count; ++k)
  {
    this->Spheres[k].center = boxes[k].center();
    this->Spheres[k].number = k;
  }
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    ObjectSphere& sphere = this->Spheres[objects[t]];
    sphere.id = objectIds[t];
    for (int c = 0; c < 3; ++c)
    {
      sphere.radius = std::max(sphere.radius, safeLength(mesh.corner(t, c) - sphere.center));
    }
  }
  const auto isNone = [](const ObjectSphere& sphere)
  { return !isFinite(sphere.center) || !std::isfinite(sphere.radius) || !(sphere.radius > 0.0); };
  this->Spheres.erase(
    std::remove_if(this->Spheres.begin(), this->Spheres.end(), isNone), this->Spheres.end());
  std::sort(this->Spheres.begin(), this->Spheres.end(), before);
  if (!this->Spheres.empty())
  {
    this->build(0, static_cast<std::uint32_t>(this->Spheres.size()));
  }
}

ObjectSpheres::ObjectSpheres(
  const ObjectSpheres& others, const TriangleMesh& mesh, const SharedVector<int>& objectIds)
  : ObjectSpheres(mesh, 0, objectIds)
{
  this->Others = &others;
  for (ObjectSphere& sphere : this->Spheres)
  {
    sphere.number += others.Objects;
  }
}

std::uint32_t ObjectSpheres::build(std::uint32_t first, std::uint32_t count)
{
  const auto begin = this->Spheres.begin() + first;
  const auto end = begin + count;
  AABB box;
  AABB centers;
  Node node{ Vec3(0.0), 0.0, begin->radius, begin->radius, first, count };
  for (auto sphere = begin; sphere != end; ++sphere)
  {
    box.extend(sphere->center - Vec3(sphere->radius));
    box.extend(sphere->center + Vec3(sphere->radius));
    centers.extend(sphere->center);
    node.smallest = std::min(node.smallest, sphere->radius);
    node.largest = std::max(node.largest, sphere->radius);
  }
  node.center = box.center();
  for (auto sphere = begin; sphere != end; ++sphere)
  {
    node.radius = std::max(
      node.radius, (safeLength(sphere->center - node.center) + sphere->radius) * BarelyWider);
  }
  const auto index = static_cast<std::uint32_t>(this->Nodes.size());
  this->Nodes.push_back(node);
  if (count <= SpheresOfLeaf)
  {
    return index;
  }
  const Vec3 extent = centers.upper - centers.lower;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  std::nth_element(begin, begin + count / 2, end,
    [axis](const ObjectSphere& a, const ObjectSphere& b) {
      return a.center[axis] < b.center[axis] || (a.center[axis] == b.center[axis] && before(a, b));
    });
  this->build(first, count / 2);
  const std::uint32_t second = this->build(first + count / 2, count - count / 2);
  this->Nodes[index].first = second;
  this->Nodes[index].count = 0;
  return index;
}

namespace
{
/// sin of the half-angle of the cone whose 1 - cos is given.
double sineOf(double versine)
{
  return versine < 1.0 ? std::sqrt(versine * (2.0 - versine))
                       : std::numeric_limits<double>::infinity();
}

/// Nothing here is so far away, or so near, that squares over- or underflow and the object matters.
double lengthOf(const Vec3& v)
{
  return std::sqrt(glm::dot(v, v));
}
}

ShareWindow::ShareWindow(double halfBeamwidth, double first, double end)
  : from(first)
  , to(end)
{
  const double half = std::sin(0.5 * halfBeamwidth);
  this->whole = 2.0 * half * half;
  this->least = sineOf(first * this->whole);
  this->most = sineOf(end * this->whole);
}

/// What is searched for, and where it goes.
struct ObjectSpheres::Search
{
  const BeamFrame& beam;
  const ShareWindow& window;
  std::vector<Seen>& seen;

  /// False if no ray of the beam meets the sphere about `v` from the apex.
  bool meets(const Vec3& v, double distance, double radius) const
  {
    if (distance <= radius)
    {
      return true;
    }
    const double along = glm::dot(v, this->beam.axis);
    const double across = std::sqrt(std::max(0.0, distance * distance - along * along));
    // Rounding of `across`, where it is all but 0.
    return across * this->beam.cosHalf - along * this->beam.sinHalf <=
      radius + 1e-7 * distance * this->beam.sinHalf;
  }
};

void ObjectSpheres::visit(std::uint32_t index, Search& search) const
{
  const Node& node = this->Nodes[index];
  const Vec3 v = node.center - search.beam.origin;
  const double distance = lengthOf(v);
  const double farthest = distance + node.radius;
  const double nearest = distance - node.radius;
  if (node.smallest >= search.window.most * farthest * BarelyWider ||
    node.largest * BarelyWider < search.window.least * nearest ||
    !search.meets(v, distance, node.radius))
  {
    return;
  }
  if (node.count == 0)
  {
    this->visit(index + 1, search);
    this->visit(node.first, search);
    return;
  }
  for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
  {
    const ObjectSphere& sphere = this->Spheres[k];
    const Vec3 to = sphere.center - search.beam.origin;
    const double range = lengthOf(to);
    if (range <= sphere.radius || glm::dot(to, search.beam.axis) <= 0.0 ||
      !search.meets(to, range, sphere.radius))
    {
      continue;
    }
    const double sine = sphere.radius / range;
    const double cosine = std::sqrt((1.0 - sine) * (1.0 + sine));
    const double share = sine * sine / (1.0 + cosine) / search.window.whole;
    if (share >= search.window.from && share < search.window.to)
    {
      search.seen.push_back({ &sphere, share });
    }
  }
}

void ObjectSpheres::find(
  const BeamFrame& beam, const ShareWindow& window, std::vector<Seen>& seen) const
{
  if (this->Others)
  {
    this->Others->find(beam, window, seen);
  }
  if (this->Nodes.empty() || !(window.from < window.to))
  {
    return;
  }
  Search search{ beam, window, seen };
  this->visit(0, search);
}
}
