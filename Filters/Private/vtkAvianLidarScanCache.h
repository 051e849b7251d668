// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScanCache.h
 * @brief The arrays of a scan, kept between executions of the beam source and handed out again
 * unchanged.
 *
 * Outputs share these arrays; nothing here writes to an array that was handed out. Keys are the
 * values that an array depends on, so a change of anything else makes no new array and no new
 * modification time. Not installed.
 */
#ifndef vtkAvianLidarScanCache_h
#define vtkAvianLidarScanCache_h

#include "ScanClock.h"

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <vector>

class vtkAvianLidarScanCache
{
public:
  using Key = std::vector<double>;

  /// The arrays of the beams of a part.
  struct Scan
  {
    Key MadeFrom;
    vtkSmartPointer<vtkIdTypeArray> BeamIds;
    vtkSmartPointer<vtkDoubleArray> Directions;
    vtkSmartPointer<vtkIntArray> LaserIds;
    vtkSmartPointer<vtkDoubleArray> Azimuths;
    vtkSmartPointer<vtkDoubleArray> VerticalAngles;
    std::vector<double> Times; ///< s since the start of the revolution
    int Revolution = 0;        ///< of the timestamps
    vtkSmartPointer<vtkDoubleArray> Timestamps;

    vtkIdType Size() const { return this->BeamIds->GetNumberOfTuples(); }
  };

  /// From one revolution to another, timestamps alone are new.
  const Scan& GetScan(
    const avianlidar::ScanPattern& pattern, const avianlidar::ScanPart& part, int revolution);

  /// Give `output` one vertex per beam, all at `position`.
  void GetVertices(vtkIdType size, const double position[3], vtkPolyData* output);

  /// Give `output` one line of `length` per beam.
  void GetRays(const Scan& scan, const double position[3], double length, vtkPolyData* output);

private:
  Scan Kept;
  Key VerticesMadeFrom;
  vtkSmartPointer<vtkPoints> VertexPoints;
  vtkSmartPointer<vtkCellArray> Vertices;
  Key RaysMadeFrom;
  vtkSmartPointer<vtkPoints> RayPoints;
  vtkSmartPointer<vtkCellArray> Rays;
};

#endif
