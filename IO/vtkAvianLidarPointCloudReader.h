// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarPointCloudReader
 * @brief Reads point clouds, real or simulated, with the array names of this project.
 *
 * The file extension gives the format. Documentation/reference/formats.md lists the formats and the
 * parts of each format that the reader reads, refuses or leaves out with a warning.
 *
 * The reader does not have an input. Output port 1 has the waveforms of a LAS file, else it is
 * empty: a line for each waveform packet to which points refer, with a point for each sample. The
 * point arrays are `sample`, in the unit of the file or in V, and `sample_time`, s. If the points
 * have `distance_m`, times count from the pulse, and the samples also have `distance_m`. Otherwise
 * times count from the first sample. The cell arrays `beam_id` and `timestamp` are those of a
 * point. A warning gives the reason if waveforms cannot be read.
 *
 * Output port 0 is vtkPolyData in double precision, with a
 * vertex for each point. The arrays `intensity` (0 to 255), `laser_id`, `distance_m`, `azimuth`,
 * `vertical_angle`, `timestamp`, `return_number`, `number_of_returns`, `rgb`, `semantic_label` and
 * `instance_id` are the same for all formats. Other arrays keep the names and types that they have
 * in the file. Arrays of a file from this project's writers also keep their units. The prefix
 * `file_` is added to the name of a field if the name has a unit in this project but not in the
 * file. The active scalars are `energy` or, without `energy`, `intensity`.
 *
 * KITTI's axes become x right, y forward, z up. If LocalCoordinates is on, the points of a LAS file
 * with a `geodetic_origin` are in metres east, north and up. Otherwise the field data `crs_wkt` and
 * `utm_zone` give the coordinate system. The output has the field data `position`, `revolution`,
 * `number_of_revolutions`, `description` and `comment` if the file has them.
 *
 * Several files are the scans of one recording. Each scan is a time step, s: the number of the scan
 * divided by ScanRate if ScanRate is set, else the time in a file `times.txt` or `timestamps.txt`
 * beside the files or in the folder above, else the time in the name of the file (s, ms, us or ns
 * since 1970, or ISO 8601), else the number in the name, or the place in the list, at 10 scans a
 * second (assumed). The field data `scan_times` says which. Any other time gives the last scan
 * before this time, or the first scan.
 *
 * Each revolution in a file of packets is a time step. Times are in seconds since the full hour
 * before the first packet. Packets must be one file. A single file of another format has no time
 * steps. Piece 0 has the whole cloud.
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

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
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
  /**
   * Name of the file, which replaces all files. Call Modified() if the file changes. Default: no
   * name, which gives an error. GetFileName() returns the first name.
   */
  virtual void SetFileName(VTK_FILEPATH const char* name);
  virtual VTK_FILEPATH const char* GetFileName();
  ///@}

  ///@{
  /**
   * Names of the files of a recording, in any order. GetScanFileName() returns the file of a time
   * step after UpdateInformation(), or null.
   */
  void AddFileName(VTK_FILEPATH const char* name);
  void RemoveAllFileNames();
  int GetNumberOfFileNames();
  VTK_FILEPATH const char* GetScanFileName(int step);
  ///@}

  /// Number of scans in a second, Hz, 0 to 1e6, for several files. Default 0: as the files say.
  vtkAvianLidarPropertyMacro(ScanRate, double, 0.0);

  /// Returns words on where the times of several files come from, after UpdateInformation().
  std::string GetScanTimes();

  /// Whether points are metres east, north, up of the file's `geodetic_origin`. Default: on.
  vtkAvianLidarSwitchMacro(LocalCoordinates, true);

  ///@{
  /**
   * IPv4 address of the sensor to read. If sensors differ only by their ports, the address includes
   * the port ("192.168.1.201:2368"). Without an address, packets of several sensors give an error.
   * Default: no address.
   */
  vtkSetStringMacro(SensorAddress);
  vtkGetStringMacro(SensorAddress);
  ///@}

  /// Returns 1 if the file extension and the first bytes fit a format of point clouds, else 0. For
  /// a .bin file the length must fit instead of the first bytes. A .ply file must not have faces.
  static int CanReadFile(VTK_FILEPATH const char* fileName);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarPointCloudReader();
  ~vtkAvianLidarPointCloudReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  char* SensorAddress = nullptr;

private:
  void Warn(const std::string& file, const std::string& what);

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;

  vtkAvianLidarPointCloudReader(const vtkAvianLidarPointCloudReader&) = delete;
  void operator=(const vtkAvianLidarPointCloudReader&) = delete;
};

#endif
