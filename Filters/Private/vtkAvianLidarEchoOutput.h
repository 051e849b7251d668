// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarEchoOutput.h
 * @brief Turns the kernel's echoes into vtkPolyData, and writes down what they were
 * made with. Not installed.
 */
#ifndef vtkAvianLidarEchoOutput_h
#define vtkAvianLidarEchoOutput_h

#include "Scan.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellArray.h"
#include "vtkSmartPointer.h"

class vtkFieldData;
class vtkPolyData;

namespace vtkAvianLidarEchoOutput
{
/// One vertex per return, with all its arrays.
void FillEchoes(
  const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams, vtkPolyData* echoes);

/// Vertices on points 0 ... count - 1.
vtkSmartPointer<vtkCellArray> MakeVertices(vtkIdType count);

/// How many beams of the piece left out small targets.
int CrowdedBeams(const avianlidar::ScanResult& result);

/// Everything needed to make the file again (`sceneChecksum`: SceneSummary::checksum), and the
/// bounds on what was not modelled.
void FillFields(const avianlidar::ScanSetup& setup, int preset, int crowdedBeams,
  vtkFieldData* beamFields, const vtkAvianLidarSurfaces& surfaces, vtkFieldData* surfaceFields,
  std::uint64_t sceneChecksum, vtkFieldData* fields);
}

#endif
