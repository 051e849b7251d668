// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarPointCloudReader
 * @brief Reads a point cloud, real or simulated, with the array names of this project.
 *
 * The ending of FileName gives the format. Documentation/reference/formats.md lists the formats,
 * and what is read, refused or left out with a warning.
 *
 * The reader has no input. Output port 0 is vtkPolyData, a vertex for each point, in double
 * precision. Arrays keep their names and types in the file, except that `intensity` (0 to 255),
 * `laser_id`, `distance_m`, `azimuth`, `vertical_angle`, `timestamp`, `return_number`,
 * `number_of_returns`, `rgb`, `semantic_label` and `instance_id` are the same for all formats. A
 * file of this project's writers comes back with its names, units and types. A field with such a
 * name but without a unit gets the prefix `file_`. Active scalars are `energy`, else `intensity`.
 *
 * KITTI's axes become x right, y forward, z up. If LocalCoordinates is on, a LAS file with a
 * `geodetic_origin` comes back in metres east, north and up. Otherwise the field data `crs_wkt` and
 * `utm_zone` give the system. Other field data, if the file has them: `position`, `revolution`,
 * `number_of_revolutions`, `description`, `comment`.
 *
 * Each revolution of packets is a time step, in seconds since the full hour before the first
 * packet; other files have no time. The whole cloud is piece 0.
 *
 * Errors name the file and the fault. The output is empty after an error or an abort.
 *
 * @code
 * reader->SetFileName("scan.las");
 * reader->Update();
 * @endcode
 *
 * @sa vtkAvianLidarCloudWriter, vtkAvianLidarCloudComparison, vtkAvianLidarGeodeticTransform
 */
#ifndef vtkAvianLidarPointCloudReader_h
#define vtkAvianLidarPointCloudReader_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr
#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarPointCloudReader : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarPointCloudReader* New();
  vtkTypeMacro(vtkAvianLidarPointCloudReader, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The file to read. After a change on disk call Modified(). Default: none, which is an error. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /** Whether points are metres east, north, up of the file's `geodetic_origin`. Default: on. */
  vtkSetMacro(LocalCoordinates, bool);
  vtkGetMacro(LocalCoordinates, bool);
  vtkBooleanMacro(LocalCoordinates, bool);
  ///@}

  ///@{
  /**
   * Sensor to read if packets come from several sensors: its IPv4 address, with the port if only
   * that differs ("192.168.1.201:2368"). Default: none; packets of several sensors are then an
   * error.
   */
  vtkSetStringMacro(SensorAddress);
  vtkGetStringMacro(SensorAddress);
  ///@}

  /// 1 if the name and the first bytes of a file are right for a cloud (.bin: name and length;
  /// .ply: also no faces), else 0.
  static int CanReadFile(VTK_FILEPATH const char* fileName);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarPointCloudReader();
  ~vtkAvianLidarPointCloudReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  char* FileName;
  bool LocalCoordinates;
  char* SensorAddress;

private:
  void Warn(const std::string& what);

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;

  vtkAvianLidarPointCloudReader(const vtkAvianLidarPointCloudReader&) = delete;
  void operator=(const vtkAvianLidarPointCloudReader&) = delete;
};

#endif
