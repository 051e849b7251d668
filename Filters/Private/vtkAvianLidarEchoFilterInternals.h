// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarEchoFilterInternals.h
 * @brief What the echo filter keeps from one execution to the next. Not installed.
 */
#ifndef vtkAvianLidarEchoFilterInternals_h
#define vtkAvianLidarEchoFilterInternals_h

#include "Scan.h"
#include "SceneSummary.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarEchoFilter.h"
#include "vtkAvianLidarMovers.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarSurfaceExchange.h"
#include "vtkAvianLidarSurfaces.h"
#include "vtkAvianLidarWarnings.h"

#include <cstddef>
#include <cstdint>
#include <memory>

struct vtkAvianLidarEchoFilter::vtkInternals
{
  /// Of the progress, for merging surfaces and building a tree.
  static constexpr double BuildShare = 0.1;

  avianlidar::ScanSetup Setup;
  avianlidar::TraceCache Cache;
  vtkAvianLidarBeams Beams;
  vtkAvianLidarSurfaces Surfaces;
  vtkAvianLidarSurfaceExchange Exchange; ///< of surfaces between ranks
  avianlidar::SceneSummary Summary;      ///< of them
  vtkAvianLidarMovers Movers;
  std::shared_ptr<const avianlidar::CollisionTree> OwnTree;
  vtkAvianLidarContent::State State; ///< of the surfaces merged last
  const void* MergedBy = nullptr;    ///< ranks that they were of; null: alone
  std::uint64_t Geometry = 0;        ///< checksum of the mesh
  std::uint64_t Scene = 0;           ///< checksum of mesh and materials
  vtkAvianLidarWarnings Warnings;
  std::uint64_t StaleFor = 0;
  double TracedRays = 0.0;   ///< of all ranks, as the two below
  double TracedBeams = 0.0;  ///< whose surfaces were looked for
  double TouchedBeams = 0.0; ///< by movers
  int TreeBuilds = 0;
  double TreeBytesSent = 0.0;
  int Threads = 0;
  int CrowdedBeams = 0;                                                 ///< of this rank
  vtkAvianLidarRanks::Outcome Last = vtkAvianLidarRanks::Outcome::Done; ///< of the execution so far

  /// Note how far the execution came. @return true to go on
  bool GoOn(vtkAvianLidarRanks::Outcome outcome)
  {
    this->Last = outcome;
    return outcome == vtkAvianLidarRanks::Outcome::Done;
  }
};

#endif
