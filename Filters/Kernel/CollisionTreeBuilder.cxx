// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"

#include "SplitRule.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace avianlidar
{
namespace
{
/// A node of the current layer that is still to be made: its part of the order array (L_p of
/// Algorithm 1).
struct LayerEntry
{
  std::uint32_t first;
  std::uint32_t count;
};

/// Below this depth every rule halves the list: a rule that peels off one triangle at a time (sizes
/// in geometric progression) would otherwise make a list instead of a tree.
constexpr std::uint32_t MaximumRuleDepth = 96;

void checkOptions(const TreeOptions& options)
{
  const int rule = static_cast<int>(options.splitRule);
  const int volume = static_cast<int>(options.boundingVolume);
  if (rule < 0 || rule > 3)
  {
    throw std::invalid_argument("split rule is " + std::to_string(rule) + ", expected 0 to 3");
  }
  if (volume < 0 || volume > 2)
  {
    throw std::invalid_argument(
      "bounding volume is " + std::to_string(volume) + ", expected 0 to 2");
  }
  if (options.maximumLeafSize < 1)
  {
    throw std::invalid_argument(
      "maximum leaf size is " + std::to_string(options.maximumLeafSize) + ", expected at least 1");
  }
}

std::vector<AABB> checkedBoxes(const TriangleMesh& mesh)
{
  if (mesh.size() > 0x7fffffffu)
  {
    throw std::invalid_argument(
      std::to_string(mesh.size()) + " triangles, expected at most 2^31 - 1");
  }
  std::vector<AABB> boxes(mesh.size());
  for (std::size_t t = 0; t < mesh.size(); ++t)
  {
    for (const std::uint32_t p : mesh.triangles[t])
    {
      if (p >= mesh.points.size())
      {
        throw std::invalid_argument("triangle " + std::to_string(t) + " names point " +
          std::to_string(p) + " of " + std::to_string(mesh.points.size()));
      }
      const Vec3& corner = mesh.points[p];
      const Vec3 size = glm::abs(corner);
      if (!(std::fmax(size.x, std::fmax(size.y, size.z)) <= MaximumCoordinate) || !isFinite(corner))
      {
        throw std::invalid_argument("triangle " + std::to_string(t) + " has the corner (" +
          std::to_string(corner.x) + ", " + std::to_string(corner.y) + ", " +
          std::to_string(corner.z) + "), expected finite coordinates of at most 1e30 m");
      }
      boxes[t].extend(corner);
    }
  }
  return boxes;
}

/// Algorithm 1 for one kind of volume.
template <class Volume>
class LayerBuilder
{
public:
  LayerBuilder(CollisionTree& tree, const KeepGoing& keepGoing)
    : Tree(tree)
    , Mesh(*tree.mesh)
    , Continue(keepGoing)
    , Boxes(checkedBoxes(*tree.mesh))
  {
  }

  bool build()
  {
    const std::size_t n = this->Mesh.size();
    const std::size_t leafSize = static_cast<std::size_t>(this->Tree.options.maximumLeafSize);
    this->ExpectedLayers =
      1.0 + std::ceil(std::log2(std::fmax(1.0, static_cast<double>(n) / leafSize)));
    this->Tree.order.resize(n);
    std::iota(this->Tree.order.begin(), this->Tree.order.end(), 0u);
    std::vector<LayerEntry> layer;
    if (n > 0)
    {
      layer.push_back({ 0, static_cast<std::uint32_t>(n) });
    }
    for (std::uint32_t depth = 0; !layer.empty(); ++depth)
    {
      std::vector<LayerEntry> next;
      for (const LayerEntry& entry : layer)
      {
        if (!this->report(depth, entry))
        {
          return false;
        }
        this->makeNode(entry, depth, static_cast<std::uint32_t>(layer.size()), next);
      }
      this->LayerStart = this->Nodes.size();
      layer.swap(next);
    }
    this->Tree.nodes = std::move(this->Nodes);
    this->Tree.volumes = std::move(this->Volumes);
    return true;
  }

private:
  void makeNode(const LayerEntry& entry, std::uint32_t depth, std::uint32_t layerSize,
    std::vector<LayerEntry>& next)
  {
    std::uint32_t* order = this->Tree.order.data() + entry.first;
    this->Volumes.push_back(this->fit(order, entry.count));
    if (entry.count <= static_cast<std::uint32_t>(this->Tree.options.maximumLeafSize))
    {
      // Ascending numbers in a leaf: neighbours in the list are often neighbours in memory.
      std::sort(order, order + entry.count);
      this->Nodes.push_back({ entry.first, entry.count });
      return;
    }
    const SplitRule rule =
      depth < MaximumRuleDepth ? this->Tree.options.splitRule : SplitRule::Halves;
    const std::uint32_t first =
      static_cast<std::uint32_t>(splitTriangles(rule, this->Boxes, order, entry.count, depth));
    // j1 = j0 + P at the start of the layer, two more for every inner node so far.
    const std::uint32_t child =
      static_cast<std::uint32_t>(this->LayerStart + layerSize + next.size());
    this->Nodes.push_back({ child, 0 });
    next.push_back({ entry.first, first });
    next.push_back({ entry.first + first, entry.count - first });
  }

  Volume fit(const std::uint32_t* order, std::uint32_t count) const;

  bool report(std::uint32_t depth, const LayerEntry& entry)
  {
    constexpr std::size_t Interval = 1u << 16;
    this->SinceReport += entry.count;
    if (!this->Continue || this->SinceReport < Interval)
    {
      return true;
    }
    this->SinceReport = 0;
    const double inLayer =
      static_cast<double>(entry.first) / static_cast<double>(this->Mesh.size());
    return this->Continue(std::fmin(0.99, (depth + inLayer) / this->ExpectedLayers));
  }

  CollisionTree& Tree;
  const TriangleMesh& Mesh;
  const KeepGoing& Continue;
  std::vector<AABB> Boxes;
  std::vector<TreeNode> Nodes;
  std::vector<Volume> Volumes;
  std::size_t LayerStart = 0;
  std::size_t SinceReport = 0;
  double ExpectedLayers = 1.0;
};

template <class Volume>
Volume LayerBuilder<Volume>::fit(const std::uint32_t* order, std::uint32_t count) const
{
  return fitToTriangles<Volume>(this->Mesh, order, count);
}

/// The boxes of the triangles are at hand: merging them gives the same box from half the memory
/// traffic.
template <>
AABB LayerBuilder<AABB>::fit(const std::uint32_t* order, std::uint32_t count) const
{
  AABB box;
  for (std::uint32_t i = 0; i < count; ++i)
  {
    box = merge(box, this->Boxes[order[i]]);
  }
  return box;
}
}

std::shared_ptr<const CollisionTree> buildCollisionTree(
  std::shared_ptr<const TriangleMesh> mesh, const TreeOptions& options, const KeepGoing& keepGoing)
{
  if (!mesh)
  {
    throw std::invalid_argument("no mesh");
  }
  checkOptions(options);
  const auto tree = std::make_shared<CollisionTree>();
  tree->mesh = std::move(mesh);
  tree->options = options;
  tree->checksum = tree->mesh->checksum();
  bool finished = false;
  switch (options.boundingVolume)
  {
    case BoundingVolumeType::AABB:
      finished = LayerBuilder<AABB>(*tree, keepGoing).build();
      break;
    case BoundingVolumeType::OBB:
      finished = LayerBuilder<OBB>(*tree, keepGoing).build();
      break;
    case BoundingVolumeType::Sphere:
      finished = LayerBuilder<BoundingSphere>(*tree, keepGoing).build();
      break;
  }
  if (!finished)
  {
    return nullptr;
  }
  finishTree(*tree);
  if (keepGoing)
  {
    keepGoing(1.0);
  }
  return tree;
}
}
