// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarLASWriter
 * @brief Writes echoes as LAS 1.4 or LAZ, with a coordinate reference system and what LAS has no
 * place for as extra bytes.
 *
 * Point data record format 6, or 7 if there are colours (point array `rgb`, three unsigned chars).
 * A file is written as a whole or not at all, see vtkAvianLidarCloudWriter. A name that ends with
 * .laz makes a LAZ file, whose points are compressed without loss; an error in a build without
 * LASzip.
 *
 * - X, Y, Z: the points, see below
 * - intensity: `intensity` (0 to 255) times 257, so that 255 becomes 65535
 * - return number, of returns: `return_number`, `number_of_returns`, 15 at most (else 1)
 * - GPS time: `timestamp` (us) / 1e6: seconds since the scan began, no epoch
 * - scan angle: 90 degrees + `vertical_angle`: from straight down, in 0.006 deg
 * - classification: `object_id` through the field data `object_classes`
 * - point source id: SourceId
 * - synthetic flag: set for echoes of the echo filter (`avian_lidar_version`)
 *
 * Where the input has them, the arrays `scan_angle`, `classification`, `classification_flags`,
 * `user_data` and `point_source_id`, as vtkAvianLidarPointCloudReader makes them of a LAS file, are
 * written instead.
 *
 * Every other numeric point array goes to the extra bytes (LASF_Spec 4) in its own type, so without
 * any loss, with its unit in square brackets in the description; one of several components as
 * `name [0]`, `name [1]`, ... An array whose numbers LAS's own field does not hold, as a return
 * number above 15, is cut there and goes to the extra bytes, too. Without WriteAllArrays these are
 * written alone: `energy`, `energy_received`, `return_energy`, `energy_std_error`, `object_id`,
 * `material_id`, `secondary_share`, `incidence_angle`, `distance_m`, `laser_id`.
 *
 * Warnings name arrays that are left out (no numbers, no name, whole numbers beyond 2^53, more than
 * 341), and those that are cut, their names to 31 bytes of UTF-8. Classes: 2 ground, 5
 * vegetation, 6 building, 9 water, 11 road, 17 bridge, else 1; the words are in
 * Documentation/formats.md.
 *
 * **Coordinates.** With the field data `geodetic_origin` the points, metres east, north and up of
 * it, are carried in double precision to UTM (WGS84, heights above the ellipsoid) or to geocentric
 * coordinates (EPSG:4978), and the file says so in WKT. With the field data `crs_wkt` they are
 * coordinates of that system and stay; what does not begin as WKT is an error. Without either they
 * are written as they are, without a system, and a warning says so (not if CoordinateSystem is
 * Local). Written are 32-bit integers: offset + scale * n, with the finest scale 10^-6, 10^-5, ...
 * m that the extent leaves room for. GetRoundingBound() is how far a coordinate may be off: half
 * the scale and the rounding of doubles, 0.5 micrometres for clouds up to 4.2 km across, 5 up to 42
 * km.
 *
 * Field data (units, sensor, settings, origin, the rounding bound as `las_rounding_bound`) go as
 * one line of JSON to the text area (LASF_Spec 3); what does not fit into its 65,535 bytes is left
 * out and said in a warning. No points: a file with none.
 *
 * Source: LAS Specification 1.4 - R15, ASPRS 2019.
 */
#ifndef vtkAvianLidarLASWriter_h
#define vtkAvianLidarLASWriter_h

#include "vtkAvianLidarCloudWriter.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarLASWriter : public vtkAvianLidarCloudWriter
{
public:
  static vtkAvianLidarLASWriter* New();
  vtkTypeMacro(vtkAvianLidarLASWriter, vtkAvianLidarCloudWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Values of CoordinateSystem.
  enum CoordinateSystems
  {
    COORDINATE_SYSTEM_UTM = 0,
    COORDINATE_SYSTEM_GEOCENTRIC = 1,
    COORDINATE_SYSTEM_LOCAL = 2
  };

  ///@{
  /**
   * The system of the coordinates in the file: UTM, geocentric, or local (the points as they are).
   * Default COORDINATE_SYSTEM_UTM.
   */
  vtkSetClampMacro(CoordinateSystem, int, COORDINATE_SYSTEM_UTM, COORDINATE_SYSTEM_LOCAL);
  vtkGetMacro(CoordinateSystem, int);
  void SetCoordinateSystemToUTM() { this->SetCoordinateSystem(COORDINATE_SYSTEM_UTM); }
  void SetCoordinateSystemToGeocentric()
  {
    this->SetCoordinateSystem(COORDINATE_SYSTEM_GEOCENTRIC);
  }
  void SetCoordinateSystemToLocal() { this->SetCoordinateSystem(COORDINATE_SYSTEM_LOCAL); }
  ///@}

  ///@{
  /**
   * Zone of UTM: 1 to 60 in the northern hemisphere, -1 to -60 in the southern one, or 0,
   * automatic: that of the origin. Default 0.
   */
  vtkSetClampMacro(UTMZone, int, -60, 60);
  vtkGetMacro(UTMZone, int);
  ///@}

  ///@{
  /**
   * File source id and point source id, 0 to 65535: a number of your own for the flight line or
   * sensor. Default 0, which means none.
   */
  vtkSetClampMacro(SourceId, int, 0, 65535);
  vtkGetMacro(SourceId, int);
  ///@}

  ///@{
  /**
   * Write every numeric point array, not only those named above. Default on.
   */
  vtkSetMacro(WriteAllArrays, bool);
  vtkGetMacro(WriteAllArrays, bool);
  vtkBooleanMacro(WriteAllArrays, bool);
  ///@}

  /**
   * How far a coordinate of the last file may be from what it was, in metres. 0 before the first.
   */
  vtkGetMacro(RoundingBound, double);

protected:
  vtkAvianLidarLASWriter();
  ~vtkAvianLidarLASWriter() override;

  void WriteCloud(vtkPointSet* input) override;

  int CoordinateSystem;
  int UTMZone;
  int SourceId;
  bool WriteAllArrays;
  double RoundingBound;

private:
  vtkAvianLidarLASWriter(const vtkAvianLidarLASWriter&) = delete;
  void operator=(const vtkAvianLidarLASWriter&) = delete;

  class vtkWork;
};

#endif
