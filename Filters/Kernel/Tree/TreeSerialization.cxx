// SPDX-License-Identifier: BSD-3-Clause
#include "TreeSerialization.h"

#include "TreeDraft.h"
#include "WideTreeBuilder.h"

#include <stdexcept>
#include <string>

namespace avianlidar
{
namespace
{
[[noreturn]] void refuse(const std::string& what)
{
  throw std::invalid_argument("collision tree: " + what);
}

std::string atNode(std::size_t node)
{
  return "node " + std::to_string(node) + ": ";
}

void append(std::vector<double>& numbers, const Vec3& v)
{
  numbers.insert(numbers.end(), { v.x, v.y, v.z });
}

void write(std::vector<double>& numbers, const AABB& v)
{
  append(numbers, v.lower);
  append(numbers, v.upper);
}

void write(std::vector<double>& numbers, const OBB& v)
{
  append(numbers, v.center);
  for (const Vec3& axis : v.axes)
  {
    append(numbers, axis);
  }
  append(numbers, v.half);
}

void write(std::vector<double>& numbers, const BoundingSphere& v)
{
  append(numbers, v.center);
  numbers.push_back(v.radius);
}

Vec3 vectorAt(const double* numbers)
{
  return { numbers[0], numbers[1], numbers[2] };
}

void read(const double* numbers, std::size_t node, AABB& v)
{
  v.lower = vectorAt(numbers);
  v.upper = vectorAt(numbers + 3);
  if (v.lower.x > v.upper.x || v.lower.y > v.upper.y || v.lower.z > v.upper.z)
  {
    refuse(atNode(node) + "a lower corner of its box is above the upper one");
  }
}

void read(const double* numbers, std::size_t node, OBB& v)
{
  constexpr double Tolerance = 1e-12;
  v.center = vectorAt(numbers);
  for (int i = 0; i < 3; ++i)
  {
    v.axes[i] = vectorAt(numbers + 3 + 3 * i);
  }
  v.half = vectorAt(numbers + 12);
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      if (!(std::fabs(glm::dot(v.axes[i], v.axes[j]) - (i == j ? 1.0 : 0.0)) <= Tolerance))
      {
        refuse(atNode(node) + "the axes of its box are not orthonormal");
      }
    }
  }
  if (v.half.x < 0.0 || v.half.y < 0.0 || v.half.z < 0.0)
  {
    refuse(atNode(node) + "a half extent of its box is negative");
  }
}

void read(const double* numbers, std::size_t node, BoundingSphere& v)
{
  v.center = vectorAt(numbers);
  v.radius = numbers[3];
  if (v.radius < 0.0)
  {
    refuse(atNode(node) + "the radius of its sphere is negative");
  }
}

void checkSizes(const TriangleMesh& mesh, const FlatTree& flat)
{
  const int rule = static_cast<int>(flat.options.splitRule);
  const int type = static_cast<int>(flat.options.boundingVolume);
  if (rule < 0 || rule > 3 || type < 0 || type > 2 || flat.options.maximumLeafSize < 1)
  {
    refuse("options (" + std::to_string(rule) + ", " + std::to_string(type) + ", " +
      std::to_string(flat.options.maximumLeafSize) +
      "), expected a split rule 0 to 3, a bounding volume 0 to 2 and a leaf size of at least 1");
  }
  if (flat.order.size() != mesh.size())
  {
    refuse("it orders " + std::to_string(flat.order.size()) + " triangles, the surface has " +
      std::to_string(mesh.size()));
  }
  if (flat.nodes.size() % 2 != 0)
  {
    refuse("an odd number of node numbers, expected two per node");
  }
  const std::size_t count = flat.nodes.size() / 2;
  if ((count == 0) != (mesh.size() == 0) || (mesh.size() > 0 && count > 2 * mesh.size() - 1))
  {
    refuse(
      std::to_string(count) + " nodes do not fit " + std::to_string(mesh.size()) + " triangles");
  }
  const std::size_t numbers = numbersPerVolume(flat.options.boundingVolume);
  if (flat.volumes.size() != count * numbers)
  {
    refuse(std::to_string(flat.volumes.size()) + " numbers of bounding volumes, expected " +
      std::to_string(count * numbers));
  }
  for (std::size_t t = 0; t < mesh.size(); ++t)
  {
    for (const std::uint32_t point : mesh.triangles[t])
    {
      if (point >= mesh.points.size())
      {
        refuse("triangle " + std::to_string(t) + " of the surface names point " +
          std::to_string(point) + " of " + std::to_string(mesh.points.size()));
      }
    }
  }
  if (flat.checksum != mesh.checksum())
  {
    refuse("it belongs to other surfaces (checksums differ)");
  }
}

/// Numbering of Algorithm 1: children are named in the order in which their parents stand, without
/// gaps.
std::vector<std::uint32_t> checkedParents(const FlatTree& flat)
{
  const std::size_t count = flat.nodes.size() / 2;
  std::vector<std::uint32_t> parents(count, 0);
  std::vector<std::uint32_t> depths(count, 0);
  std::vector<bool> taken(flat.order.size(), false);
  std::size_t next = 1;
  std::size_t covered = 0;
  for (std::size_t node = 0; node < count; ++node)
  {
    const std::size_t first = flat.nodes[2 * node];
    const std::size_t triangles = flat.nodes[2 * node + 1];
    if (depths[node] > MaximumTreeDepth)
    {
      refuse(atNode(node) + "it lies " + std::to_string(depths[node]) +
        " levels below the root, expected at most " + std::to_string(MaximumTreeDepth));
    }
    if (triangles == 0)
    {
      if (first != next || next + 1 >= count || next <= node)
      {
        refuse(atNode(node) + "its first child is " + std::to_string(first) + ", expected " +
          std::to_string(next) + " of " + std::to_string(count) + " nodes");
      }
      parents[next] = parents[next + 1] = static_cast<std::uint32_t>(node);
      depths[next] = depths[next + 1] = depths[node] + 1;
      next += 2;
      continue;
    }
    if (triangles > static_cast<std::size_t>(flat.options.maximumLeafSize) ||
      first >= flat.order.size() || triangles > flat.order.size() - first)
    {
      refuse(atNode(node) + "a leaf of " + std::to_string(triangles) + " triangles from " +
        std::to_string(first) + ", expected at most " +
        std::to_string(flat.options.maximumLeafSize) + " within " +
        std::to_string(flat.order.size()));
    }
    for (std::size_t i = first; i < first + triangles; ++i)
    {
      if (taken[i])
      {
        refuse(
          atNode(node) + "position " + std::to_string(i) + " of the order belongs to two leaves");
      }
      taken[i] = true;
      ++covered;
    }
  }
  if (count > 0 && next != count)
  {
    refuse(std::to_string(count - next) + " nodes have no parent");
  }
  if (covered != flat.order.size())
  {
    refuse(std::to_string(flat.order.size() - covered) + " triangles are in no leaf");
  }
  return parents;
}

void checkOrder(const FlatTree& flat)
{
  std::vector<bool> seen(flat.order.size(), false);
  for (const std::uint32_t triangle : flat.order)
  {
    if (triangle >= seen.size())
    {
      refuse("triangle " + std::to_string(triangle) + " of " + std::to_string(seen.size()));
    }
    if (seen[triangle])
    {
      refuse("triangle " + std::to_string(triangle) + " stands in it twice");
    }
    seen[triangle] = true;
  }
}

template <class Volume>
void checkContents(const CollisionTree& tree, const std::vector<Volume>& volumes,
  const std::vector<std::uint32_t>& parents)
{
  const auto check = [&](std::size_t node, std::uint32_t triangle)
  {
    for (int c = 0; c < 3; ++c)
    {
      if (!contains(volumes[node], tree.mesh->corner(triangle, c)))
      {
        refuse(atNode(node) + "its volume does not hold triangle " + std::to_string(triangle));
      }
    }
  };
  for (std::size_t leaf = 0; leaf < tree.nodes.size(); ++leaf)
  {
    for (std::uint32_t i = 0; i < tree.nodes[leaf].count; ++i)
    {
      const std::uint32_t triangle = tree.order[tree.nodes[leaf].first + i];
      std::size_t node = leaf;
      check(node, triangle);
      while (node != 0)
      {
        node = parents[node];
        check(node, triangle);
      }
    }
  }
}

template <class Volume>
std::vector<Volume> readVolumes(const FlatTree& flat)
{
  const std::size_t numbers = numbersPerVolume(flat.options.boundingVolume);
  std::vector<Volume> volumes(flat.nodes.size() / 2);
  for (std::size_t node = 0; node < volumes.size(); ++node)
  {
    const double* values = flat.volumes.data() + node * numbers;
    for (std::size_t i = 0; i < numbers; ++i)
    {
      if (!(std::fabs(values[i]) <= 4.0 * MaximumCoordinate))
      {
        refuse(atNode(node) + "a number of its volume is not finite or out of range");
      }
    }
    read(values, node, volumes[node]);
  }
  return volumes;
}
}

std::size_t numbersPerVolume(BoundingVolumeType type)
{
  switch (type)
  {
    case BoundingVolumeType::OBB:
      return 15;
    case BoundingVolumeType::Sphere:
      return 4;
    case BoundingVolumeType::AABB:
      break;
  }
  return 6;
}

namespace
{
FlatTree flattenNodes(const CollisionTree& tree)
{
  FlatTree flat;
  flat.options = tree.options;
  flat.checksum = tree.checksum;
  flat.order = tree.order;
  flat.nodes.reserve(2 * tree.nodes.size());
  for (const TreeNode& node : tree.nodes)
  {
    flat.nodes.push_back(node.first);
    flat.nodes.push_back(node.count);
  }
  return flat;
}

std::vector<TreeNode> nodesOf(const FlatTree& flat)
{
  std::vector<TreeNode> nodes;
  nodes.reserve(flat.nodes.size() / 2);
  for (std::size_t i = 0; i + 1 < flat.nodes.size(); i += 2)
  {
    nodes.push_back({ flat.nodes[i], flat.nodes[i + 1] });
  }
  return nodes;
}
}

FlatTree flattenTree(const CollisionTree& tree)
{
  FlatTree flat = flattenNodes(tree);
  flat.volumes.reserve(tree.nodes.size() * numbersPerVolume(tree.options.boundingVolume));
  withVolumes(tree,
    [&](const auto& volumes)
    {
      for (const auto& volume : volumes)
      {
        write(flat.volumes, volume);
      }
    });
  return flat;
}

std::shared_ptr<const CollisionTree> restoreTree(
  std::shared_ptr<const TriangleMesh> mesh, const FlatTree& flat, int threads)
{
  if (!mesh)
  {
    refuse("no mesh");
  }
  checkSizes(*mesh, flat);
  const std::vector<std::uint32_t> parents = checkedParents(flat);
  checkOrder(flat);
  const auto tree = std::make_shared<CollisionTree>();
  tree->mesh = std::move(mesh);
  tree->options = flat.options;
  tree->checksum = flat.checksum;
  tree->order = flat.order;
  tree->nodes = nodesOf(flat);
  switch (flat.options.boundingVolume)
  {
    case BoundingVolumeType::AABB:
      tree->keptVolumes = readVolumes<AABB>(flat);
      break;
    case BoundingVolumeType::OBB:
      tree->keptVolumes = readVolumes<OBB>(flat);
      break;
    case BoundingVolumeType::Sphere:
      tree->keptVolumes = readVolumes<BoundingSphere>(flat);
      break;
  }
  std::visit(
    [&](const auto& volumes) { checkContents(*tree, volumes, parents); }, tree->keptVolumes);
  ParallelTeam::run(threads,
    [&](ParallelTeam& team)
    {
      collectLeafTriangles(*tree, team);
      if (flat.options.boundingVolume == BoundingVolumeType::AABB)
      {
        tree->wide = buildWideTree(*tree, team);
      }
    });
  if (!tree->wide.nodes.empty())
  {
    tree->keptVolumes = TreeVolumes();
  }
  return tree;
}

FlatTree flattenForTransfer(const CollisionTree& tree)
{
  return tree.wide.nodes.empty() ? flattenTree(tree) : flattenNodes(tree);
}

std::shared_ptr<const CollisionTree> restoreTransferred(
  std::shared_ptr<const TriangleMesh> mesh, FlatTree flat, int threads)
{
  if (!flat.volumes.empty() || !mesh || mesh->size() == 0)
  {
    return restoreTree(std::move(mesh), flat, threads);
  }
  if (flat.order.size() != mesh->size() || flat.nodes.size() % 2 != 0 || flat.nodes.empty())
  {
    refuse("what was sent does not fit the surfaces");
  }
  const auto tree = std::make_shared<CollisionTree>();
  tree->nodes = nodesOf(flat);
  tree->mesh = std::move(mesh);
  tree->options = flat.options;
  tree->checksum = flat.checksum;
  tree->order = std::move(flat.order);
  ParallelTeam::run(threads,
    [&](ParallelTeam& team)
    {
      collectLeafTriangles(*tree, team);
      tree->wide = buildWideTree(*tree, team);
    });
  return tree;
}
}
