// SPDX-License-Identifier: BSD-3-Clause
// How the echo filter comes by its surfaces and their tree.
#include "vtkAvianLidarEchoFilterInternals.h"

#include "CollisionTreeBuilder.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarText.h"
#include "vtkAvianLidarTreeAccess.h"
#include "vtkAvianLidarTreeExchange.h"

#include "vtkDataObject.h"

#include <utility>

namespace
{
using Outcome = vtkAvianLidarRanks::Outcome;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarEchoFilter::PrepareSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  auto state = vtkAvianLidarContent::StateOf(input);
  if (ranks.All(!state.empty() && state == in.State && in.MergedBy == ranks.Group()))
  {
    return true; // nothing was modified since the last execution
  }
  in.State.clear();
  const auto merged = vtkAvianLidarTreeAccess::FindMerged(input);
  const bool given = ranks.All(merged != nullptr) && ranks.Same(merged->checksum);
  if (!given &&
    !in.GoOn(in.Exchange.Merge(
      ranks, this, input, "Input port 1, ", this->NumberOfThreads, in.Surfaces, in.Surfaces)))
  {
    return false;
  }
  const Outcome summarized = ranks.Together(this,
    [&]() -> std::string
    {
      if (given)
      {
        in.Exchange.Forget();
        in.Exchange.Fields = input->GetFieldData();
        in.Surfaces = *merged;
      }
      this->SummarizeSurfaces(input, ranks.Rank() == 0);
      return {};
    });
  if (!in.GoOn(summarized))
  {
    return false;
  }
  in.State = std::move(state);
  in.MergedBy = ranks.Group();
  return true;
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::SummarizeSurfaces(vtkDataObject* input, bool warn)
{
  vtkInternals& in = *this->Internals;
  in.Geometry = in.Surfaces.checksum;
  in.Setup.materials = in.Surfaces.materials;
  in.Setup.objectIds = in.Surfaces.objectIds;
  in.Setup.materialIds = in.Surfaces.materialIds;
  in.Summary.follow(in.Setup);
  in.Scene = in.Summary.checksum(in.Geometry);
  if (in.Warnings.IsNew(input, in.Geometry, in.Surfaces.warning) && warn)
  {
    vtkWarningMacro("Input port 1, " << vtkAvianLidarText(in.Surfaces.warning));
  }
}

//------------------------------------------------------------------------------
bool vtkAvianLidarEchoFilter::PrepareTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  in.Threads = ranks.Threads(this->NumberOfThreads);
  const Outcome outcome = ranks.Together(this,
    [&]() -> std::string
    {
      this->FindTree(input);
      return {};
    });
  if (!in.GoOn(outcome))
  {
    return false;
  }
  const auto keepGoing = [this](double fraction)
  {
    this->UpdateProgress(vtkInternals::BuildShare * fraction);
    return !vtkAvianLidarAbort::Wanted(this);
  };
  const auto build = [&]()
  {
    auto tree = avianlidar::buildCollisionTree(
      in.Surfaces.mesh, avianlidar::TreeOptions{}, keepGoing, in.Threads);
    in.TreeBuilds += tree != nullptr;
    return tree;
  };
  const bool found = in.Setup.tree != nullptr;
  const Outcome shared = vtkAvianLidarTreeExchange::Share(
    ranks, this, in.Surfaces.mesh, in.Threads, in.Setup.tree, build, in.TreeBytesSent);
  in.OwnTree = found ? in.OwnTree : in.Setup.tree;
  return in.GoOn(shared);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::FindTree(vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  const std::uint64_t checksum = in.Geometry;
  const vtkAvianLidarTreeAccess::Found found =
    vtkAvianLidarTreeAccess::Find(input, in.Surfaces.mesh, checksum);
  in.Setup.tree = found.tree;
  if ((found.stale || !found.problem.empty()) && in.StaleFor != checksum)
  {
    vtkWarningMacro("Input port 1: the collision tree that came with the surfaces "
      << (found.stale ? "is of another geometry"
                      : "is damaged (" + vtkAvianLidarText(found.problem) + ")")
      << ", so one is built here. Put the Collision Tree filter after whatever changes the "
         "geometry.");
    in.StaleFor = checksum;
  }
  if (!in.Setup.tree && in.OwnTree && in.OwnTree->checksum == checksum)
  {
    in.Setup.tree = in.OwnTree;
  }
}
