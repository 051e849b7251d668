// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarEchoOutput.h
 * @brief Turns the kernel's echoes and reports into vtkPolyData, and writes down what they were
 * made with. Not installed.
 */
#ifndef vtkAvianLidarEchoOutput_h
#define vtkAvianLidarEchoOutput_h

#include "Scan.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarSurfaces.h"

class vtkFieldData;
class vtkPolyData;

namespace vtkAvianLidarEchoOutput
{
/// One vertex per return, with all its arrays.
void FillEchoes(
  const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams, vtkPolyData* echoes);

/// One vertex per beam: status and cost.
void FillReport(
  const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams, vtkPolyData* report);

/// Everything needed to make the file again (`sceneChecksum`: ScanSetup::sceneChecksum), and the
/// bounds on what was not modelled.
void FillFields(const avianlidar::ScanSetup& setup, vtkFieldData* beamFields,
  const vtkAvianLidarSurfaces& surfaces, vtkFieldData* surfaceFields, std::uint64_t sceneChecksum,
  vtkFieldData* fields);
}

#endif
