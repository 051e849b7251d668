// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockPreTest.h
 * @brief What the beams of a block may meet, told to those who asked for it (BeamPreTest).
 */
#ifndef avianlidar_BlockPreTest_h
#define avianlidar_BlockPreTest_h

#include "BeamTracer.h"
#include "EntryPoints.h"
#include "Traversal.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Pre-tests of the beams of one block; what the constructor is given must outlive it.
class BlockPreTest
{
public:
  /// @param counters of each beam of the block
  BlockPreTest(const CollisionTree& tree, const BeamBlock& block,
    std::vector<TraceCounters>& counters, TraversalStack& stack);

  /// After some rays of a beam, which hit these triangles; or, with a `count` of 0, before all.
  /// @param entryPoints null: those of the tree @return true if the beam needs no rays
  bool run(std::uint32_t beam, const EntryPoints* entryPoints, const std::uint32_t* triangles,
    std::size_t count);

  /// The beam that was pre-tested last needed no rays: its neighbour is worth a pre-test before
  /// all.
  bool filledBefore() const { return this->FilledBefore; }

private:
  class Visitor;

  const CollisionTree& Tree;
  const BeamBlock& Block;
  std::vector<TraceCounters>& Counters;
  TraversalStack& Stack;
  bool FilledBefore = false;
};
}

#endif
