// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarTreeExchange.h
 * @brief One rank builds the collision tree, all have it. Not installed.
 */
#ifndef vtkAvianLidarTreeExchange_h
#define vtkAvianLidarTreeExchange_h

#include "CollisionTree.h"
#include "vtkAvianLidarRanks.h"

#include <functional>
#include <memory>

class vtkAlgorithm;

namespace vtkAvianLidarTreeExchange
{
using Tree = std::shared_ptr<const avianlidar::CollisionTree>;

/// Give every rank a tree of `mesh`, which all have: that of the lowest rank that has one; if none
/// has, rank 0 builds one. Nothing is sent where all have one. Alone: `build` where it is needed.
/// All ranks must call it.
/// @param tree that this rank has, or null @param build returns null if somebody said stop
/// @param threads > 0, or 0 for loopThreads(0) @param sent bytes that this rank gave are added
vtkAvianLidarRanks::Outcome Share(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  const std::shared_ptr<const avianlidar::TriangleMesh>& mesh, int threads, Tree& tree,
  const std::function<Tree()>& build, double& sent);
}

#endif
