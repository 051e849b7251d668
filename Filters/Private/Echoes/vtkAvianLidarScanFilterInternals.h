// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScanFilterInternals.h
 * @brief Holds the results that filters of scans keep from one execution to the next. Not
 * installed.
 */
#ifndef vtkAvianLidarScanFilterInternals_h
#define vtkAvianLidarScanFilterInternals_h

#include "Scan.h"
#include "SceneSummary.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarScanFilter.h"
#include "vtkAvianLidarSurfaceExchange.h"
#include "vtkAvianLidarSurfaces.h"
#include "vtkAvianLidarWarnings.h"

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

struct vtkAvianLidarScanFilter::vtkInternals
{
  /// Share of the progress for merging surfaces and building a tree.
  static constexpr double BuildShare = 0.1;

  avianlidar::ScanSetup Setup;
  avianlidar::TraceCache Cache;
  vtkAvianLidarBeams Beams;
  std::shared_ptr<const vtkAvianLidarSurfaces> Surfaces; ///< surfaces merged last
  vtkAvianLidarSurfaceExchange Exchange;                 ///< exchange of surfaces between ranks
  std::vector<avianlidar::PlacedMedium> Media;           ///< media of the surfaces
  std::vector<std::string> MediaOf;                      ///< texts from which `Media` were read
  avianlidar::LidarView MediaFor;                        ///< lidar for which `Media` were read
  avianlidar::SceneSummary Summary;                      ///< summary of the surfaces
  std::shared_ptr<const avianlidar::CollisionTree> OwnTree;
  vtkAvianLidarContent::State State; ///< state of the surfaces merged last
  const void* MergedBy = nullptr;    ///< ranks that merged the surfaces; null: one process
  std::uint64_t Geometry = 0;        ///< checksum of the mesh
  std::uint64_t Scene = 0;           ///< checksum of mesh and materials
  vtkAvianLidarWarnings Warnings;
  std::uint64_t StaleFor = 0;
  double TracedRays = 0.0;  ///< number of rays traced by all ranks
  double TracedBeams = 0.0; ///< number of beams, of all ranks, that were traced
  int TreeBuilds = 0;
  int Threads = 0;

  /// A property that is a number, a choice or a switch.
  struct Property
  {
    const char* name;
    std::variant<int vtkAvianLidarScanFilter::*, double vtkAvianLidarScanFilter::*,
      bool vtkAvianLidarScanFilter::*>
      member;
    const char* unit = ""; ///< unit with a blank before it, such as " m"
    double ValueOf(const vtkAvianLidarScanFilter& self) const
    {
      return std::visit([&](auto of) { return static_cast<double>(self.*of); }, this->member);
    }
  };
  /// Properties that all filters of scans have.
  static const std::vector<Property>& Properties();
};

#endif
