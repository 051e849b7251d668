// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"

#include "CoincidentFaces.h"
#include "TreeDraft.h"
#include "WideTreeBuilder.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>

namespace avianlidar
{
namespace
{
void checkOptions(const TreeOptions& options)
{
  const int rule = static_cast<int>(options.splitRule);
  if (rule < 0 || rule > 3)
  {
    throw std::invalid_argument("split rule is " + std::to_string(rule) + ", expected 0 to 3");
  }
  if (options.maximumLeafSize < 1)
  {
    throw std::invalid_argument(
      "maximum leaf size is " + std::to_string(options.maximumLeafSize) + ", expected at least 1");
  }
}

/// Nodes of at most so many triangles are divided by one thread: enough of them to keep many
/// threads busy, each small enough for its boxes to stay in a cache.
std::size_t largestSubtree(const TreeDraft& draft)
{
  const std::size_t size = std::clamp<std::size_t>(draft.scene.count / 16, 1024, 131072);
  return std::max(size, static_cast<std::size_t>(draft.options.maximumLeafSize));
}

/// Shares of the work that are done when all nodes are divided, and when the wide tree is made.
constexpr double Divided = 0.5;
constexpr double Widened = 0.55;

class Builder
{
public:
  Builder(CollisionTree& tree, bool wide, ParallelTeam& team, const KeepGoing& keepGoing)
    : Tree(tree)
    , Team(team)
    , Continue(keepGoing)
  {
    this->Draft.options = tree.options;
    this->Draft.wide = wide;
  }

  /// False if `keepGoing` returned false.
  bool build()
  {
    this->Draft.scene =
      makeTriangleBoxes(*this->Tree.mesh, this->Team, this->stage(0.0, 0.1 * Divided));
    if (this->Tree.mesh->size() == 0)
    {
      return !this->Continue || this->Continue(1.0);
    }
    if (!this->Draft.scene.boxes || !this->divide())
    {
      return false;
    }
    this->number();
    collectLeafTriangles(this->Tree, this->Team);
    return !this->Draft.wide || this->makeWideTree();
  }

private:
  /// A part of the whole work.
  KeepGoing stage(double from, double to) const
  {
    if (!this->Continue)
    {
      return {};
    }
    // Rounding must not lead beyond what the next stage begins with.
    return [this, from, to](double done)
    { return this->Continue(std::min(to, from + (to - from) * done)); };
  }

  bool divide()
  {
    TreeDraft& draft = this->Draft;
    const std::size_t n = draft.scene.count;
    draft.makeRoom();
    std::vector<DraftEntry> rest;
    if (!divideUpperLayers(draft, largestSubtree(draft), this->Team,
          this->stage(0.1 * Divided, 0.4 * Divided), rest))
    {
      return false;
    }
    this->Tree.order.resize(n);
    std::atomic<std::size_t> below{ 0 };
    const auto body = [&](std::size_t begin, std::size_t end, int)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        below += divideSubtree(draft, rest[i], this->Tree.order.data());
      }
    };
    const bool finished =
      this->Team.loop(rest.size(), 1, body, this->stage(0.4 * Divided, Divided));
    this->NodeCount = 1 + 2 * draft.upper.size() + below;
    draft.scene.memory = ScratchMemory();
    return finished;
  }

  /// Breadth first: j1 = j0 + P at the start of each layer, two more for every inner node.
  void number()
  {
    std::vector<TreeNode>& nodes = this->Tree.nodes;
    nodes.resize(this->NodeCount);
    // Until its turn comes, a node holds its slot.
    nodes[0].first = 0;
    std::uint32_t next = 1;
    for (TreeNode& node : nodes)
    {
      node = this->Draft.nodes[node.first];
      if (!node.isLeaf())
      {
        const std::uint32_t slot = node.first;
        node.first = next;
        nodes[next++].first = slot;
        nodes[next++].first = slot + 1;
      }
    }
  }

  bool makeWideTree()
  {
    const WideTreeInput input = this->Draft.wideTreeInput();
    std::for_each(this->Draft.upper.rbegin(), this->Draft.upper.rend(),
      [&](std::uint32_t slot) { input.setCosts(slot, slot + 1); });
    this->Tree.wide =
      buildWideTree(input, this->Draft.scene, this->Team, this->stage(Divided, Widened));
    return !this->Tree.wide.nodes.empty() &&
      findPlaneOwners(this->Tree, this->Team, this->stage(Widened, 1.0));
  }

  CollisionTree& Tree;
  ParallelTeam& Team;
  const KeepGoing& Continue;
  TreeDraft Draft;
  std::size_t NodeCount = 0;
};
}

namespace
{
std::shared_ptr<CollisionTree> build(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, bool wide, const KeepGoing& keepGoing, int threads)
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
  // To begin a loop costs about as much as the boxes of a few hundred triangles.
  constexpr std::size_t LeastPerThread = 1024;
  const std::size_t useful = std::max<std::size_t>(1, tree->mesh->size() / LeastPerThread);
  const std::size_t most = static_cast<std::size_t>(loopThreads(threads));
  bool finished = false;
  ParallelTeam::run(static_cast<int>(std::min(useful, most)),
    [&](ParallelTeam& team) { finished = Builder(*tree, wide, team, keepGoing).build(); });
  return finished ? tree : nullptr;
}
}

std::shared_ptr<const CollisionTree> buildCollisionTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing, int threads)
{
  if (options.boundingVolume != BoundingVolumeType::AABB)
  {
    throw std::invalid_argument("bounding volume is " +
      std::to_string(static_cast<int>(options.boundingVolume)) +
      ", expected 0 (boxes); buildVolumeTree() makes the others");
  }
  return build(std::move(mesh), options, true, keepGoing, threads);
}

std::shared_ptr<CollisionTree> buildBinaryTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing, int threads)
{
  return build(std::move(mesh), options, false, keepGoing, threads);
}
}
