// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarLandmarks
 * @brief Names places in a picture of a scan, and makes rings of equal range around the lidar.
 *
 * Input port 0 (optional) is vtkPolyData: beams, with `direction` and `laser_id`. Input port 1
 * (optional) is vtkPolyData: surfaces, with the cell array `object_id` and the field data
 * `object_names` and `object_classes`. Without these arrays there are no names. Each rank names the
 * surfaces that it has. All outputs are vtkPolyData, m:
 *
 * - Port 0, rings: level lines around the first beam's origin, with the cell array `distance_m`.
 * - Port 1, ranges: a vertex on each ring, with the point array `name`, such as "100 m", and a
 *   vertex "N" in the north.
 * - Port 2, names: a vertex above each runway end and each large building, with the point array
 *   `name`. An end of a runway "09/27" has the designator of the direction in which aircraft land
 *   at this end. Ends of other runways are named by the wind. A runway is at least ten times as
 *   long as wide. Buildings are at least 2 m high, at most a quarter as wide as the scene, and have
 *   a name of their own, unlike "Hangar 3". Other things get no name.
 * - Port 3, fan: beams in twelve directions, of up to 16 lasers, to the first ring.
 *
 * A bad number, or a first beam that is not at a finite place, gives empty outputs and an error
 * that names the property or the input. Setters accept any value.
 *
 * @sa vtkAvianLidarBeamSource, vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarLandmarks_h
#define vtkAvianLidarLandmarks_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarLandmarks : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarLandmarks* New();
  vtkTypeMacro(vtkAvianLidarLandmarks, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Distance from ring to ring, m, 1e-6 to 1e9. Default 100.
  vtkAvianLidarPropertyMacro(RingSpacing, double, 100.0);

  /// Number of rings, 0 to 1000. Default 5.
  vtkAvianLidarPropertyMacro(NumberOfRings, int, 5);

  /// Direction of the ranges from the middle, deg from north, clockwise, any finite angle. Default
  /// 45.
  vtkAvianLidarPropertyMacro(RangeDirection, double, 45.0);

  /// Greatest number of named buildings, from the largest ground plan on, at least 0. Default 12.
  vtkAvianLidarPropertyMacro(MaximumNumberOfBuildings, int, 12);

  /// Name of an end of a runway, as of output port 2. @param east, north away from the runway
  static std::string EndName(const std::string& runway, double east, double north);

  /// Whether a name says more than a class with a number, such as "Hangar 3".
  static bool IsOwnName(const std::string& name);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarLandmarks();
  ~vtkAvianLidarLandmarks() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarLandmarks(const vtkAvianLidarLandmarks&) = delete;
  void operator=(const vtkAvianLidarLandmarks&) = delete;
};

#endif
