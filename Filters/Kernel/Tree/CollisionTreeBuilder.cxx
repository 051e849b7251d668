// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"

#include "CoincidentFaces.h"
#include "SplitRule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace avianlidar
{
namespace
{
constexpr int Width = WideNode::Width;

/// Boxes [first, first + count), in the array of their depth's parity: a node of a binary tree,
/// from which wide nodes are made.
struct Range
{
  LaneBox box;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t depth = 0;    ///< root 0
  std::uint32_t children = 0; ///< number of the first of two that follow each other; 0: none
  /// [k - 1]: least sum of the areas of the wide nodes below, if the range takes up to k lanes of
  /// the node above. A descent visits a node as often as its box is met, that is, in proportion to
  /// its area, and tests its eight children at once.
  float least[Width] = {};
};

/// Root first, children after their parents.
using Ranges = std::vector<Range>;

/// What takes a lane of a wide node.
struct Lane
{
  const Ranges* ranges;
  std::uint32_t number;
  const Range& range() const { return (*this->ranges)[this->number]; }
};

AVIANLIDAR_MULTIVERSION void measure(const LaneBox* boxes, std::size_t count, LaneExtent& extent)
{
  extent.clear();
  extent.include(boxes, count);
}

/// Set the costs of all ranges that were divided. @param unit 1/m^2: areas so scaled are floats
AVIANLIDAR_MULTIVERSION void setCosts(Ranges& ranges, double unit)
{
  constexpr float never = std::numeric_limits<float>::max();
  for (std::size_t i = ranges.size(); i-- > 0;)
  {
    Range& range = ranges[i];
    if (range.children == 0)
    {
      continue;
    }
    // The least of all ways in which two children share the lanes.
    const float* const first = ranges[range.children].least;
    float second[2 * Width];
    float least[Width];
    for (int k = 0; k < Width; ++k)
    {
      second[k] = never;
      second[Width + k] = ranges[range.children + 1].least[k];
      least[k] = never;
    }
    for (int j = 1; j < Width; ++j)
    {
      for (int k = 0; k < Width; ++k)
      {
        const float sum = first[j - 1] + second[Width + k - j];
        least[k] = sum < least[k] ? sum : least[k];
      }
    }
    const auto area = static_cast<float>(range.box.halfArea() * unit);
    const float whole = area + least[Width - 1];
    for (int k = 0; k < Width; ++k)
    {
      range.least[k] = k > 0 && least[k] < whole ? least[k] : whole;
    }
  }
}

void setLane(WideNode& node, int lane, const LaneBox& box)
{
  const Lanes center = 0.5f * box.twiceCenter();
  // Sums of two floats that are rounded once.
  const Lanes half = roundedUp(larger(box.above - center, box.below + center));
  node.x[lane] = center[0];
  node.y[lane] = center[1];
  node.z[lane] = center[2];
  node.halfX[lane] = half[0];
  node.halfY[lane] = half[1];
  node.halfZ[lane] = half[2];
}

class Builder
{
public:
  Builder(CollisionTree& tree, int threads, const KeepGoing& keepGoing)
    : Tree(tree)
    , Threads(threads)
    , Continue(keepGoing)
  {
  }

  /// False if `keepGoing` returned false.
  bool build()
  {
    this->Scene = makeTriangleBoxes(*this->Tree.mesh, this->Threads, this->stage(0.0, 0.05));
    if (this->Tree.mesh->size() == 0)
    {
      return !this->Continue || this->Continue(1.0);
    }
    if (!this->Scene.boxes || !this->divideLarge() || !this->divideSmall())
    {
      return false;
    }
    this->addNode({ &this->Large, 0 }, 0);
    WideTree& wide = this->Tree.wide;
    wide.nodes.shrink_to_fit();
    wide.reference = this->Scene.reference;
    wide.extent = this->Scene.extent;
    this->Small = {};
    return findPlaneOwners(this->Tree, this->Threads, this->stage(0.55, 1.0));
  }

private:
  /// A stage of the whole work.
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

  /// Call `f` with the number of each item in parallel.
  template <class F>
  bool forEach(std::size_t count, double from, double to, F&& f) const
  {
    const auto body = [&f](std::size_t begin, std::size_t end, int)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        f(i);
      }
    };
    return parallelFor(count, 1, this->Threads, body, this->stage(from, to));
  }

  LaneBox* boxesOf(const Range& range, std::uint32_t depth) const
  {
    return (depth % 2 == 0 ? this->Scene.boxes : this->Scene.room) + range.first;
  }

  bool isLeaf(const Range& range) const
  {
    return range.count <= static_cast<std::uint32_t>(this->Tree.options.maximumLeafSize);
  }

  /// Neither divided among the large ones nor a leaf.
  bool isSmall(const Range& range) const { return range.children == 0 && !this->isLeaf(range); }

  /// Measure a range, and divide it. @param children null: measure it alone
  void divide(Range& range, Range* children) const
  {
    LaneBox* const from = this->boxesOf(range, range.depth);
    LaneExtent extent;
    measure(from, range.count, extent);
    range.box = extent.box;
    if (children)
    {
      const auto first = static_cast<std::uint32_t>(splitTriangles(this->Tree.options.splitRule,
        from, this->boxesOf(range, range.depth + 1), range.count, extent.centers, range.depth));
      children[0].first = range.first;
      children[0].count = first;
      children[1].first = range.first + first;
      children[1].count = range.count - first;
      children[0].depth = children[1].depth = range.depth + 1;
    }
  }

  /// Divide a range, and all that becomes of it, down to the leaves.
  void divideDown(Ranges& ranges, std::uint32_t number) const
  {
    if (this->isLeaf(ranges[number]))
    {
      this->divide(ranges[number], nullptr);
      this->writeLeaf(ranges[number]);
      return;
    }
    const auto children = static_cast<std::uint32_t>(ranges.size());
    ranges.resize(ranges.size() + 2);
    ranges[number].children = children;
    this->divide(ranges[number], &ranges[children]);
    this->divideDown(ranges, children);
    this->divideDown(ranges, children + 1);
  }

  /// Ascending numbers in a leaf: neighbours in the list are often neighbours in memory.
  void writeLeaf(const Range& range) const
  {
    const LaneBox* const boxes = this->boxesOf(range, range.depth);
    std::uint32_t* const order = this->Tree.order.data() + range.first;
    for (std::uint32_t i = 0; i < range.count; ++i)
    {
      order[i] = boxes[i].triangle();
    }
    std::sort(order, order + range.count);
  }

  /// Divide ranges until there are enough to keep many threads busy, each small enough for its
  /// boxes to stay in a cache.
  bool divideLarge()
  {
    const std::size_t count = this->Scene.count;
    const auto largest =
      std::max<std::size_t>(static_cast<std::size_t>(this->Tree.options.maximumLeafSize),
        std::clamp<std::size_t>(count / 16, 1024, 131072));
    Ranges& ranges = this->Large;
    this->Tree.order.resize(count);
    ranges.resize(1);
    ranges[0].count = static_cast<std::uint32_t>(count);
    std::size_t end = 0;
    for (std::size_t begin = 0; begin < ranges.size(); begin = end)
    {
      end = ranges.size();
      for (std::size_t i = begin; i < end; ++i)
      {
        if (ranges[i].count > largest)
        {
          ranges[i].children = static_cast<std::uint32_t>(ranges.size());
          ranges.resize(ranges.size() + 2);
        }
      }
      const auto divideOne = [&](std::size_t i)
      {
        Range& range = ranges[begin + i];
        if (range.children != 0)
        {
          this->divide(range, &ranges[range.children]);
        }
        else if (this->isLeaf(range))
        {
          this->divide(range, nullptr);
          this->writeLeaf(range);
        }
      };
      // How many layers there will be is not known.
      const double done = 0.2 - 0.15 * std::pow(0.9, static_cast<double>(begin));
      if (!this->forEach(end - begin, done, done, divideOne))
      {
        return false;
      }
    }
    return true;
  }

  /// Divide the ranges that were left, each on one thread.
  bool divideSmall()
  {
    this->Small.resize(this->Large.size());
    // Scaled by it, areas are floats.
    const double extent = this->Scene.extent;
    const double unit = extent > 0.0 ? 1.0 / (extent * extent) : 0.0;
    const auto divideOne = [&](std::size_t i)
    {
      Range& range = this->Large[i];
      Ranges& small = this->Small[i];
      if (this->isSmall(range))
      {
        small.reserve(range.count);
        small.push_back(range);
        this->divideDown(small, 0);
        setCosts(small, unit);
        range.box = small[0].box;
        std::copy_n(small[0].least, Width, range.least);
      }
    };
    const bool finished = this->forEach(this->Large.size(), 0.2, 0.5, divideOne);
    setCosts(this->Large, unit);
    this->Scene.memory = ScratchMemory();
    return finished;
  }

  /// What takes the lanes of a node, or shares `lanes` of them. @return how many
  int lanesOf(Lane whole, int lanes, Lane* list) const
  {
    if (this->isSmall(whole.range()))
    {
      whole = { &this->Small[whole.number], 0 };
    }
    const Range& range = whole.range();
    const bool takesOne = lanes < Width && !(range.least[lanes - 1] < range.least[0]);
    if (range.children == 0 || takesOne)
    {
      list[0] = whole;
      return 1;
    }
    const float* const first = (*whole.ranges)[range.children].least;
    const float* const second = (*whole.ranges)[range.children + 1].least;
    int toFirst = 1;
    for (int j = 2; j < lanes; ++j)
    {
      if (first[j - 1] + second[lanes - j - 1] < first[toFirst - 1] + second[lanes - toFirst - 1])
      {
        toFirst = j;
      }
    }
    const int count = this->lanesOf({ whole.ranges, range.children }, toFirst, list);
    return count +
      this->lanesOf({ whole.ranges, range.children + 1 }, lanes - toFirst, list + count);
  }

  /// Add a node and all below it, depth first. @return its number
  std::uint32_t addNode(const Lane& range, std::uint32_t level)
  {
    std::vector<WideNode>& nodes = this->Tree.wide.nodes;
    const auto number = static_cast<std::uint32_t>(nodes.size());
    this->Tree.wide.depth = std::max(this->Tree.wide.depth, level);
    nodes.emplace_back().clear();
    Lane lanes[Width];
    const int count = this->lanesOf(range, Width, lanes);
    for (int i = 0; i < count; ++i)
    {
      const Range& lane = lanes[i].range();
      setLane(nodes[number], i, lane.box);
      std::uint32_t first = lane.first;
      if (this->isLeaf(lane))
      {
        ++this->Tree.leaves;
        this->Tree.depth = std::max(this->Tree.depth, lane.depth);
        nodes[number].count[i] = lane.count;
      }
      else
      {
        first = this->addNode(lanes[i], level + 1);
      }
      nodes[number].first[i] = first;
    }
    return number;
  }

  CollisionTree& Tree;
  int Threads;
  const KeepGoing& Continue;
  TriangleBoxes Scene;
  Ranges Large;              ///< the uppermost layers
  std::vector<Ranges> Small; ///< ranges into which the small ones among them are divided
};
}

void checkTreeInput(const TriangleMesh* mesh, const TreeOptions& options)
{
  const int rule = static_cast<int>(options.splitRule);
  if (!mesh)
  {
    throw std::invalid_argument("no mesh");
  }
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

std::shared_ptr<const CollisionTree> buildCollisionTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing, int threads)
{
  checkTreeInput(mesh.get(), options);
  if (options.boundingVolume != BoundingVolumeType::AABB)
  {
    throw std::invalid_argument("bounding volume is " +
      std::to_string(static_cast<int>(options.boundingVolume)) +
      ", expected 0 (boxes); buildVolumeTree() makes the others");
  }
  const auto tree = std::make_shared<CollisionTree>();
  tree->mesh = std::move(mesh);
  tree->options = options;
  tree->checksum = tree->mesh->checksum();
  // To begin a loop costs about as much as the boxes of a few hundred triangles.
  constexpr std::size_t LeastPerThread = 1024;
  const std::size_t useful = std::max<std::size_t>(1, tree->mesh->size() / LeastPerThread);
  const std::size_t most = static_cast<std::size_t>(loopThreads(threads));
  const int team = static_cast<int>(std::min(useful, most));
  return Builder(*tree, team, keepGoing).build() ? tree : nullptr;
}
}
