// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBeams.h
 * @brief Reads beams and the sensor from any vtkPolyData. Not installed.
 */
#ifndef vtkAvianLidarBeams_h
#define vtkAvianLidarBeams_h

#include "Scan.h"
#include "Sensor.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarRanks.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkPolyData;

struct vtkAvianLidarBeams
{
  avianlidar::ScanBeams beams;
  avianlidar::Sensor sensor;
  /// Unit vectors along which echoes are placed, as given; empty: the directions of the beams.
  std::vector<avianlidar::Vec3> reportedDirections;
  std::vector<int> laserIds; ///< channels of the beams, as given, else 0
  std::vector<double>
    azimuths; ///< azimuths, 0.01 deg clockwise from north, as given, else of the reported direction
  std::vector<double> verticalAngles; ///< elevations, deg, as given, else of the reported direction
  std::vector<double> timestamps;     ///< firing times, us, as given, else 0
  /// Position, m, and orientation of the sensor at each firing, as given; empty: not given.
  std::vector<std::array<double, 3>> sensorPositions;
  std::vector<std::array<double, 4>> sensorOrientations;
  bool isTimed = false;          ///< true if timestamps were given
  double displayLength = 1000.0; ///< length of the lines that display beams, m
  std::int32_t revolution = 0;   ///< revolution of the sensor, as given, else 0

  /// Azimuth of a direction, 0.01 deg clockwise from north, in [0, 36000).
  static double AzimuthOf(const avianlidar::Vec3& d);

  /// Elevation of a direction, deg.
  static double ElevationOf(const avianlidar::Vec3& d);

  /// Read `input`. Earlier results are kept if the values of points and arrays have not changed.
  /// Throws std::runtime_error, which names the input and the array.
  void Read(vtkPolyData* input);

  /// Check that the beams of all ranks belong to one sensor, and that no id occurs twice. All ranks
  /// must call this function.
  void CheckRanks(const vtkAvianLidarRanks& ranks);

  /// Throws if there are beams without timestamps. @param what what the beams meet, which moves
  void RequireTimes(const std::string& what) const;

  /// Check ids again at the next CheckRanks(), because the ranks may have changed.
  void ForgetRanks() { this->checkedWith = nullptr; }

  /// Hash of sensor, revolution and beams.
  std::uint64_t Hash() const;

  /// Hash of sensor, revolution and everything that is read for each beam.
  std::uint64_t HashOfAll() const;

  /// Unit vector along which the echoes of a beam are placed: the direction that the sensor
  /// reports.
  const avianlidar::Vec3& ReportedDirection(std::size_t beam) const
  {
    return this->reportedDirections.empty() ? this->beams.directions[beam]
                                            : this->reportedDirections[beam];
  }

  std::uint64_t total = 0; ///< number of beams of all ranks, after CheckRanks()

private:
  void ReadAll(vtkPolyData* input);
  void ReadBeams(vtkPolyData* input);
  void CompareIds(const vtkAvianLidarRanks& ranks) const;
  const void* checkedWith = nullptr;    ///< ranks among which no id occurs twice; null: not checked
  vtkAvianLidarContent::State ReadFrom; ///< state of the input read last; empty after an error
  std::uint64_t Content = 0;            ///< hash of the beams without their origins
  std::uint64_t Origins = 0;            ///< hash of the origins
};

#endif
