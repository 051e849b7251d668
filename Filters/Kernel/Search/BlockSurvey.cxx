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
  std::vector<TraceCounters>& counters, SurveyWorkspace& work)
  : Tree(tree)
  , Block(block)
  , Counters(counters)
  , Work(work)
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
    counters.nodesVisited += this->visitRoots(*roots, cone, visitor);
  }
  else
  {
    counters.nodesVisited += descendCone(this->Tree, probe, visitor, this->Work.stack);
  }
  if (!survey->end())
  {
    return false;
  }
  counters.raysTraced = 0;
  this->FilledBefore = true;
  return true;
}

/// @return number of boxes tested
std::uint64_t BlockSurvey::visitRoots(
  const BeamRoots& roots, const WideCone& cone, Visitor& visitor)
{
  const CollisionTree& tree = this->Tree;
  std::uint64_t visited = 0;
  std::vector<std::uint32_t>& inner = this->Work.nodes;
  inner.clear();
  // @return false if the survey is at its end
  const auto open = [&](const WideNode& node)
  {
    alignas(64) float nearest[WideNode::Width];
    cone.distances(node, nearest);
    visited += WideNode::Width;
    for (int i = 0; i < WideNode::Width; ++i)
    {
      if (node.first[i] == NoChild || !(nearest[i] < std::numeric_limits<float>::infinity()))
      {
        continue;
      }
      if (node.count[i] == 0)
      {
        inner.push_back(node.first[i]);
      }
      else if (!visitor.leaf(tree.order.data() + node.first[i], node.count[i]))
      {
        return false;
      }
    }
    return true;
  };
  bool more = true;
  for (std::size_t k = 0; more && k < roots.nodes.size(); ++k)
  {
    more = open(roots.nodes[k]);
  }
  while (more && !inner.empty())
  {
    const std::uint32_t node = inner.back();
    inner.pop_back();
    more = open(tree.wide.nodes[node]);
  }
  return visited;
}
}
