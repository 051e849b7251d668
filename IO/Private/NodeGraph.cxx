// SPDX-License-Identifier: BSD-3-Clause
#include "NodeGraph.h"

#include "AvailableMemory.h"
#include "LookedBytes.h"

#include <algorithm>

namespace avianlidar::scene
{
namespace
{
// Assimp's node, with a name of a kilobyte.
constexpr double BytesPerNode = 1200.0;
}

std::size_t NodeGraph::Add()
{
  this->Children.emplace_back();
  return this->Children.size() - 1;
}

void NodeGraph::Connect(std::size_t parent, std::size_t child)
{
  this->Children[parent].push_back(child);
}

void NodeGraph::Check() const
{
  // Nodes in layers, from those without children up: a node counts when all its children have.
  const std::size_t n = this->Size();
  std::vector<std::vector<std::size_t>> parents(n);
  std::vector<std::size_t> missing(n), ready;
  for (std::size_t node = 0; node < n; ++node)
  {
    missing[node] = this->Children[node].size();
    for (const std::size_t child : this->Children[node])
    {
      parents[child].push_back(node);
    }
    if (missing[node] == 0)
    {
      ready.push_back(node);
    }
  }
  std::vector<int> levels(n, 1);
  std::vector<double> places(n, 1.0);
  double most = 0.0;
  for (std::size_t i = 0; i < ready.size(); ++i)
  {
    const std::size_t node = ready[i];
    RefuseLevel(levels[node]);
    most = std::max(most, places[node]);
    for (const std::size_t parent : parents[node])
    {
      levels[parent] = std::max(levels[parent], levels[node] + 1);
      places[parent] += places[node];
      if (--missing[parent] == 0)
      {
        ready.push_back(parent);
      }
    }
  }
  if (ready.size() < n)
  {
    throw Error("has a node within itself");
  }
  requireMemory(most, "nodes", most * BytesPerNode);
}
}
