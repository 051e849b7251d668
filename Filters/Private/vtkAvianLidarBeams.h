// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBeams.h
 * @brief Reads beams and the sensor from a vtkPolyData, whoever made it. Not installed.
 */
#ifndef vtkAvianLidarBeams_h
#define vtkAvianLidarBeams_h

#include "Scan.h"
#include "Sensor.h"

#include "vtkType.h"

#include <string>
#include <utility>
#include <vector>

class vtkPolyData;

struct vtkAvianLidarBeams
{
  avianlidar::ScanBeams beams;
  avianlidar::Sensor sensor;
  std::vector<int> laserIds; ///< as given, else 0
  std::vector<double>
    azimuths; ///< 0.01 deg clockwise from north, as given, else from the direction
  std::vector<double> verticalAngles; ///< deg, as given, else from the direction
  std::vector<double> timestamps;     ///< us, as given, else 0
  double displayLength = 1000.0;      ///< m
  std::string problem;                ///< what is wrong with the input

  /// Read `input`; what is here already is kept where it was read from the same arrays, not
  /// modified since.
  void Read(vtkPolyData* input);

private:
  using State = std::vector<std::pair<const void*, vtkMTimeType>>;
  static State StateOf(vtkPolyData* input);
  std::string ReadBeams(vtkPolyData* input);
  State ReadFrom; ///< empty if something was wrong
};

#endif
