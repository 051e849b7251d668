// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarPointCloudReader
 * @brief Reads a point cloud, of a real lidar or simulated, with the array names of this project.
 *
 * - `.las`: LAS 1.0 to 1.4, point data record formats 0 to 10, extra bytes, coordinate systems as
 *   WKT or as GeoTIFF keys; a warning says that waveforms are left out
 * - `.laz`: the same, compressed, without formats that have waveforms; an error in a build without
 *   LASzip
 * - `.pcd`: PCD of the Point Cloud Library: ascii, binary, binary_compressed
 * - `.ply`: the element `vertex` of PLY: ascii, binary of either byte order; vertices have no
 * lists, other elements are passed over
 * - `.bin`: KITTI scans (float32 x, y, z, reflectance), with SemanticKITTI's labels if there are
 *   any: the same name with .label beside it or in the folder `labels` beside its own. Points of
 *   five numbers (nuScenes) are an error
 * - `.pcap`, `.pcapng`: packets of a Velodyne VLP-16, strongest, last or dual return, of one sensor
 *   (SensorAddress). Damaged packets, and what follows a cut, are left out, and counted in a
 *   warning. Each revolution is a time step, in seconds since the full hour before the first packet
 *   (TIME_STEPS and TIME_RANGE; without a time asked for: the first); the first and the last are
 *   those parts that were recorded. The azimuth of each laser is interpolated, its vertical offset
 *   (at most 11 mm, second-hand) is not applied
 *
 * **Output** (port 0): vtkPolyData, a vertex for each point, double points. Cells of an organised
 * PCD without a point (not-a-number) are left out. Point arrays keep name and type of the file but
 * for what this project has a name for:
 *
 * - `intensity` (unit 1): PCD and PLY as it is, LAS / 257, KITTI * 255: 0 to 255. Numbers above 1
 * in a KITTI scan are taken as they are, with a warning
 * - `laser_id`: the field `ring` or `channel`
 * - `distance_m` (m): of the points, where the sensor's place is known (PCD: VIEWPOINT, KITTI:
 *   origin)
 * - `azimuth` (0.01 deg): the same, clockwise from y (north), [0, 36000)
 * - `vertical_angle` (deg): the same, from the x-y plane, up
 * - `timestamp` (us): LAS: GPS time * 1e6, in the epoch of the file; packets: since the full hour
 * - `return_number`, `number_of_returns` (unit 1): LAS, packets
 * - `rgb` (unit 1): three unsigned chars: LAS / 256 (as they are where no
 *   channel of the file is above 255), packed colours of PCD, `red`, `green`, `blue`
 *   of PLY
 * - `semantic_label`, `instance_id`: SemanticKITTI
 *
 * A file of this project's writers says what its arrays are: they come back with name, unit and
 * type. Active scalars are `energy` or else `intensity`. A name above whose unit a file does not
 * say is put behind `file_` (`file_azimuth`): PCD and PLY have no units. LAS's `classification`,
 * `classification_flags`, `user_data`, `scan_angle` (deg) and `point_source_id` keep these names;
 * extra bytes keep theirs.
 *
 * **Frame.** KITTI's forward-left-up becomes x right, y forward, z up. LAS in UTM on WGS84 or
 * geocentric (EPSG:4978) that says its `geodetic_origin` (this project's writer) comes back in
 * metres east, north and up of it with LocalCoordinates. Otherwise points stay and the field data
 * `crs_wkt` says what they are, with `utm_zone` where it is UTM on WGS84:
 * vtkAvianLidarGeodeticTransform moves them. Where its unit is not the metre, a warning says so.
 *
 * Field data, as far as the file has it: `revolution`, `number_of_revolutions` (packets),
 * `position` (m, of the sensor), `crs_wkt`, `description`, `comment`, and what this project's
 * writers put there.
 *
 * **Errors** name the file and what is wrong: no file name, not there, no regular file (a pipe, a
 * device), not of that format, cut short (sizes in headers are believed only as far as the file is
 * long), damaged. Output empty then, and after an abort. Pieces: the whole cloud is piece 0, others
 * are empty.
 *
 * @sa vtkAvianLidarLASWriter vtkAvianLidarPCDWriter vtkAvianLidarPLYWriter vtkAvianLidarKITTIWriter
 * vtkAvianLidarCloudComparison vtkAvianLidarHSBColorMap
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
  /**
   * The file to read, whose ending says what it is. Default: none, which is an error. A change of
   * the file on disk is not noticed: call Modified().
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * Bring coordinates on the Earth to metres east, north and up of the `geodetic_origin` that the
   * file says, if it says one. Default on.
   */
  vtkSetMacro(LocalCoordinates, bool);
  vtkGetMacro(LocalCoordinates, bool);
  vtkBooleanMacro(LocalCoordinates, bool);
  ///@}

  ///@{
  /**
   * The sensor whose packets are read of a recording of several: the IPv4 address that it sends
   * from, with the port that it sends to where addresses do not differ ("192.168.1.201" or
   * "192.168.1.201:2368"). Default: none; a recording of several sensors is an error that lists
   * them. Other files have no sensors, and are read as without.
   */
  vtkSetStringMacro(SensorAddress);
  vtkGetStringMacro(SensorAddress);
  ///@}

  /**
   * Whether a file is a cloud by its name and by how it begins (.bin: by its length, a multiple of
   * 16; .ply: without faces). 1 or 0.
   */
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
