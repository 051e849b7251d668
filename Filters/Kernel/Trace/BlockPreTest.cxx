// SPDX-License-Identifier: BSD-3-Clause
#include "BlockPreTest.h"

#include "Descents.h"

#include <limits>

namespace avianlidar
{
/// Triangles of the cone, for those who asked.
class BlockPreTest::Visitor
{
public:
  explicit Visitor(BeamPreTest& preTest)
    : PreTest(preTest)
  {
  }
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    return this->PreTest.leaf(triangles, count);
  }

private:
  BeamPreTest& PreTest;
};

BlockPreTest::BlockPreTest(const CollisionTree& tree, const BeamBlock& block,
  std::vector<TraceCounters>& counters, TraversalStack& stack)
  : Tree(tree)
  , Block(block)
  , Counters(counters)
  , Stack(stack)
{
}

bool BlockPreTest::run(std::uint32_t beam, const EntryPoints* entryPoints,
  const std::uint32_t* triangles, std::size_t count)
{
  BeamPreTest* const preTest = this->Block.preTest;
  this->FilledBefore = false;
  if (!preTest || !preTest->begin(beam, triangles, count))
  {
    return false;
  }
  TraceCounters& counters = this->Counters[beam];
  Visitor visitor(*preTest);
  const BeamVolumeTest probe(this->Block.frames[beam]);
  WideCone cone;
  if (entryPoints && !this->Tree.wide.nodes.empty() && cone.set(this->Tree.wide, probe))
  {
    counters.nodesVisited += descendWide(this->Tree, cone, visitor, this->Stack, entryPoints);
  }
  else
  {
    counters.nodesVisited += descendCone(this->Tree, probe, visitor, this->Stack);
  }
  if (!preTest->end())
  {
    return false;
  }
  counters.raysTraced = 0;
  this->FilledBefore = true;
  return true;
}
}
