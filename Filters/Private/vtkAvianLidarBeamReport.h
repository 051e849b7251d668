// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBeamReport.h
 * @brief The beam report as vtkPolyData: one vertex per beam, with status and cost.
 *
 * Of a scan lit again, most beams have the report they had: arrays are kept from one execution to
 * the next, and only what changed is written, into the same array if nobody else holds it or its
 * values, else into a copy. Not installed.
 */
#ifndef vtkAvianLidarBeamReport_h
#define vtkAvianLidarBeamReport_h

#include "Scan.h"
#include "vtkAvianLidarBeams.h"

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkSmartPointer.h"

#include <cstddef>
#include <cstdint>

class vtkPolyData;

class vtkAvianLidarBeamReport
{
public:
  /**
   * Give `report` a vertex for each beam, in their order: at its strongest return, or at the
   * display length, m. Point arrays: `beam_id`, `laser_id`, `azimuth`, 0.01 deg, and
   * `vertical_angle`, deg, as the echoes have them; `status` (BeamStatus; the active scalars), the
   * counts `candidates`, `nodes_visited` and `rays_traced`, and `skipped` (SkippedPart) with
   * `skipped_bound`, J, and `small_targets_left_out`.
   *
   * If `result` goes on from the one that the last call was for, with the same beams, the cost is
   * that of its changed beams and of copies of what others hold; else that of all beams.
   * @param result of a scan of `beams`: one report for each @param beams read without a problem
   * @param noise of the scan
   * @param report empty; shares the arrays that are kept here, which the next call may write to
   * unless somebody still holds them
   */
  void Fill(const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams,
    const avianlidar::NoisePlan& noise, vtkPolyData* report);

  /// Of the arrays that are kept.
  std::size_t Bytes() const;

private:
  int SkippedOf(const avianlidar::BeamReport& report) const;
  void MakeAngles(const vtkAvianLidarBeams& beams);
  void Make(const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams);
  void Change(const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams);

  std::uint64_t Run = 0;      ///< whose reports these are; 0: none
  std::uint64_t Checksum = 0; ///< of the beams
  double DisplayLength = 0.0; ///< m
  double NoiseSkipped = 0.0;  ///< J, its bound; 0: none was
  vtkSmartPointer<vtkDoubleArray> Coordinates;
  vtkSmartPointer<vtkCellArray> Vertices;
  vtkSmartPointer<vtkIdTypeArray> BeamIds;
  vtkSmartPointer<vtkIntArray> LaserIds;
  vtkSmartPointer<vtkDoubleArray> Azimuths;
  vtkSmartPointer<vtkDoubleArray> VerticalAngles;
  vtkSmartPointer<vtkIntArray> Status;
  vtkSmartPointer<vtkIdTypeArray> Candidates;
  vtkSmartPointer<vtkIdTypeArray> NodesVisited;
  vtkSmartPointer<vtkIdTypeArray> RaysTraced;
  vtkSmartPointer<vtkIntArray> Skipped;
  vtkSmartPointer<vtkDoubleArray> SkippedBound;
  vtkSmartPointer<vtkIntArray> LeftOut;
};

#endif
