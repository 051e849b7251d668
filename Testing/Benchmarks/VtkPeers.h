// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VtkPeers.h
 * @brief What a VTK user has today: vtkStaticCellLocator, vtkOBBTree, vtkModifiedBSPTree.
 *
 * The last one reads memory that nobody wrote on many meshes (boxes; ParaView 5.11) and crashes:
 * run it in a process of its own.
 */
#ifndef avianlidar_VtkPeers_h
#define avianlidar_VtkPeers_h

#include "Workload.h"

namespace benchmarks
{
struct VtkPeer
{
  double buildSeconds;
  Tracer trace; ///< on one thread, whatever is asked
};

struct PeerMaker
{
  std::string name;
  std::function<VtkPeer(const Scene&)> make;
};

/// The three locators.
std::vector<PeerMaker> vtkPeers();
}

#endif
