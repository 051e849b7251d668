// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VtkPeers.h
 * @brief What a VTK user has today: vtkStaticCellLocator, vtkOBBTree, vtkModifiedBSPTree.
 */
#ifndef avianlidar_VtkPeers_h
#define avianlidar_VtkPeers_h

#include "Workload.h"

#include "vtkSmartPointer.h"

class vtkPolyData;

namespace benchmarks
{
/// The surfaces relative to the lidar, in double precision.
vtkSmartPointer<vtkPolyData> toPolyData(const Scene& scene);

struct VtkPeer
{
  std::string name;
  double buildSeconds;
  Tracer trace; ///< on one thread, whatever is asked
};

/// The three locators, built.
std::vector<VtkPeer> vtkPeers(const Scene& scene);
}

#endif
