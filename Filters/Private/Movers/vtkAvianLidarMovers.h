// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMovers.h
 * @brief Converts a vtkPolyData, or a composite of vtkPolyData, to movers for the kernel. Not
 * installed.
 *
 * Each vtkPolyData is an object in a frame of its own. Its field data give the poses of this frame:
 * `pose_time` (n, s; may be missing if there is one pose, which is then constant), `pose_position`
 * (n x 3, m), `pose_orientation` (n x 4, unit quaternion w, x, y, z; may be missing for a mover
 * that is not turned). Parts that flap are given by the cell array `part` and by the field data
 * `flap_hinge` (k x 3, m), `flap_axis` (k x 3), `flap_amplitude` (k, rad), `flap_frequency` (k,
 * Hz), `flap_phase` (k, turns). Materials and ids are given as for surfaces.
 */
#ifndef vtkAvianLidarMovers_h
#define vtkAvianLidarMovers_h

#include "Mover.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarRanks.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

class vtkDataObject;
struct vtkAvianLidarSurfaces;

struct vtkAvianLidarMovers
{
  std::shared_ptr<const std::vector<avianlidar::Mover>> movers; ///< movers; null: no movers
  std::uint64_t checksum = 0; ///< checksum of all movers; 0 without movers
  /// Names of objects by id, for surfaces and movers.
  std::vector<std::string> objectNames;
  std::vector<std::string> objectClasses; ///< classes by object id; empty: no input has classes
  std::vector<std::string> materialNames;
  std::string warning; ///< warning about suspicious input; empty: no warning

  /// Read the movers of all ranks, unless input, surfaces and ranks are unchanged. All ranks must
  /// call this function. Ids of movers are kept if all these ids are larger than the ids of the
  /// surfaces. Otherwise new ids follow the ids of the surfaces.
  /// @param input movers, may be null @param surfaces surfaces, whose ids and names come first
  void Read(
    const vtkAvianLidarRanks& ranks, vtkDataObject* input, const vtkAvianLidarSurfaces& surfaces);

private:
  /// @param named true if blocks also come from other ranks, with their names as field data
  void ReadAll(vtkDataObject* input, bool named, const vtkAvianLidarSurfaces& surfaces);
  vtkAvianLidarContent::State State;     ///< state of the input read last
  std::vector<std::string> SurfaceNames; ///< names of objects, then of classes and materials
  const void* ReadBy = nullptr;          ///< ranks that read the movers
  bool Known = false;
};

#endif
