// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTreeExchange.h"

#include "vtkAvianLidarTreeAccess.h"

#include "vtkTable.h"

#include <utility>

using Outcome = vtkAvianLidarRanks::Outcome;

//------------------------------------------------------------------------------
Outcome vtkAvianLidarTreeExchange::Share(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  const std::shared_ptr<const avianlidar::TriangleMesh>& mesh, int threads, Tree& tree,
  const std::function<Tree()>& build, double& sent)
{
  if (ranks.All(tree != nullptr))
  {
    return Outcome::Done;
  }
  // The lowest rank that has a tree, or rank 0.
  const double place = ranks.Largest(tree ? ranks.Size() - ranks.Rank() : 0);
  const int owner = place > 0 ? ranks.Size() - static_cast<int>(place) : 0;
  vtkNew<vtkTable> flat; // VTK sends field data of a vtkPolyData without points as ASCII
  const Outcome outcome = ranks.Together(self,
    [&]() -> std::string
    {
      if (owner == ranks.Rank())
      {
        tree = tree ? tree : build();
        if (!tree)
        {
          throw avianlidar::WorkStopped{};
        }
        if (!ranks.Alone())
        {
          vtkAvianLidarTreeAccess::Write(
            avianlidar::flattenForTransfer(*tree), flat->GetFieldData());
        }
      }
      const std::string wrong = vtkAvianLidarRanks::CheckSize(flat);
      return wrong.empty() ? wrong : "The collision tree is " + wrong;
    });
  if (ranks.Alone() || outcome != Outcome::Done)
  {
    return outcome;
  }
  ranks.Broadcast(flat, owner, sent);
  return ranks.Together(self,
    [&]() -> std::string
    {
      avianlidar::FlatTree read;
      if (!tree)
      {
        read.checksum = mesh->checksum();
        if (!vtkAvianLidarTreeAccess::Read(flat->GetFieldData(), read))
        {
          return "The collision tree cannot be read as another rank sent it";
        }
        tree = avianlidar::restoreTransferred(mesh, std::move(read), threads);
      }
      return {};
    });
}
