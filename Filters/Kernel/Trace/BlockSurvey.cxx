// SPDX-License-Identifier: BSD-3-Clause
#include "BlockSurvey.h"

#include "Descents.h"

#include <limits>

namespace avianlidar
{
/// Triangles of the cone, for those who asked.
class BlockSurvey::Visitor
{
public:
  explicit Visitor(BeamSurvey& survey)
    : Survey(survey)
  {
  }
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    return this->Survey.leaf(triangles, count);
  }

private:
  BeamSurvey& Survey;
};

BlockSurvey::BlockSurvey(const CollisionTree& tree, const BeamBlock& block,
  std::vector<TraceCounters>& counters, TraversalStack& stack)
  : Tree(tree)
  , Block(block)
  , Counters(counters)
  , Stack(stack)
{
}

bool BlockSurvey::run(
  std::uint32_t beam, const BeamRoots* roots, const std::uint32_t* triangles, std::size_t count)
{
  BeamSurvey* const survey = this->Block.survey;
  this->FilledBefore = false;
  if (!survey || !survey->begin(beam, triangles, count))
  {
    return false;
  }
  TraceCounters& counters = this->Counters[beam];
  Visitor visitor(*survey);
  const BeamVolumeTest probe(this->Block.frames[beam]);
  WideCone cone;
  if (roots && !this->Tree.wide.nodes.empty() && cone.set(this->Tree.wide, probe))
  {
    counters.nodesVisited += descendWide(this->Tree, cone, visitor, this->Stack, roots);
  }
  else
  {
    counters.nodesVisited += descendCone(this->Tree, probe, visitor, this->Stack);
  }
  if (!survey->end())
  {
    return false;
  }
  counters.raysTraced = 0;
  this->FilledBefore = true;
  return true;
}
}
