// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarLASWriter
 * @brief Writes echoes as LAS 1.4, or as LAZ if FileName ends with .laz, with a coordinate
 * reference system, all arrays and waveforms.
 *
 * Input port 0 is a vtkPointSet. Points have the record format 6, or 7 with the point array `rgb`.
 * The fields of LAS hold `intensity`, `return_number`, `number_of_returns`, `timestamp`,
 * `vertical_angle` and the class of `object_id`, or the arrays that vtkAvianLidarPointCloudReader
 * makes of a LAS file. All other numeric arrays become extra bytes of their own type. A warning
 * names arrays with values that are cut and arrays that are left out.
 *
 * With the field data `geodetic_origin` the points are transformed to the UTM or geocentric system
 * that the file describes in WKT. With the field data `crs_wkt` the points are not transformed, and
 * the file contains `crs_wkt`. Without `geodetic_origin` and `crs_wkt` the file does not describe a
 * system. A warning then says that the system is missing, unless CoordinateSystem is local.
 * Coordinates are 32-bit integers with the finest scale, at least 1e-6 m, that the extent of the
 * points allows. Field data become one line of JSON.
 *
 * Input port 1 (optional) is vtkPolyData with waveforms, as from vtkAvianLidarEchoFilter: lines of
 * equally spaced samples, with the point arrays `sample_time` and `sample` and the cell arrays
 * `beam_id` and `timestamp`. Points then have format 9, or 10 with `rgb`. The waveform of a point
 * has the same `beam_id` and `timestamp`, and contains the time of `distance_m`. A warning counts
 * points without a waveform. Waveforms without a point are not written. Samples are the codes of
 * the digitiser (field data `digitiser_bits`), or 32 bits from the least to the greatest sample, J.
 * Each waveform is a line in the file's system, tangential to the beam at the point. If the
 * waveforms have more than 255 lengths, short waveforms are padded with 0 J.
 *
 * The writer gives the errors of vtkAvianLidarCloudWriter, and an error for LAZ with waveforms or
 * in a build without LASzip, or for a `crs_wkt` that is not WKT.
 *
 * @code
 * writer->SetInputConnection(echoes->GetOutputPort());
 * writer->SetFileName("echoes.las");
 * writer->Write();
 * @endcode
 *
 * Source: LAS Specification 1.4 - R15, ASPRS 2019. Fields and rounding:
 * Documentation/reference/formats.md, LAS.
 *
 * @sa vtkAvianLidarCloudWriter, vtkAvianLidarPointCloudReader
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

  enum CoordinateSystems
  {
    COORDINATE_SYSTEM_UTM = 0,
    COORDINATE_SYSTEM_GEOCENTRIC = 1,
    COORDINATE_SYSTEM_LOCAL = 2
  };

  ///@{
  /**
   * Coordinate system of the file. Local is the system of the points. Default
   * COORDINATE_SYSTEM_UTM.
   */
  vtkAvianLidarLimitedMacro(
    CoordinateSystem, COORDINATE_SYSTEM_UTM, COORDINATE_SYSTEM_LOCAL, COORDINATE_SYSTEM_UTM);
  void SetCoordinateSystemToUTM() { this->SetCoordinateSystem(COORDINATE_SYSTEM_UTM); }
  void SetCoordinateSystemToGeocentric()
  {
    this->SetCoordinateSystem(COORDINATE_SYSTEM_GEOCENTRIC);
  }
  void SetCoordinateSystemToLocal() { this->SetCoordinateSystem(COORDINATE_SYSTEM_LOCAL); }
  ///@}

  /// UTM zone, 1 to 60 in the north, -1 to -60 in the south. 0 is the zone of the origin. Default
  /// 0.
  vtkAvianLidarLimitedMacro(UTMZone, -60, 60, 0);

  /// Source id of the file and of each point, 0 (no id) to 65535. Default 0.
  vtkAvianLidarLimitedMacro(SourceId, 0, 65535, 0);

  /// Whether all numeric arrays are written, or only `energy`, `energy_received`, `return_energy`,
  /// `energy_std_error`, `object_id`, `material_id`, `secondary_share`, `incidence_angle`,
  /// `distance_m` and `laser_id`. Default: on.
  vtkAvianLidarSwitchMacro(WriteAllArrays, true);

  ///@{
  /// Input port 1, waveforms (optional). Without lines, the file is the same as without this input.
  void SetWaveformsConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  void SetWaveformsData(vtkDataObject* waveforms) { this->SetInputData(1, waveforms); }
  ///@}

  /// Whether points with waveforms have the record format 4, or 5 with colours, for programs that
  /// do not read the formats 9 and 10. These formats hold 7 returns, classes up to 31 (above: 1)
  /// and whole degrees of the scan angle from -90 to 90. Default: off.
  vtkAvianLidarSwitchMacro(LegacyFormat, false);

  /// Whether waveforms are written to a file of the same name with the ending .wdp. Default: off,
  /// waveforms are in the LAS file.
  vtkAvianLidarSwitchMacro(ExternalWaveforms, false);

  /// Largest rounding error of a coordinate in the last file, m, or 0 before the first file.
  vtkGetMacro(RoundingBound, double);

protected:
  vtkAvianLidarLASWriter();
  ~vtkAvianLidarLASWriter() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteCloud(vtkPointSet* input) override;

  double RoundingBound = 0.0;

private:
  vtkAvianLidarLASWriter(const vtkAvianLidarLASWriter&) = delete;
  void operator=(const vtkAvianLidarLASWriter&) = delete;
};

#endif
