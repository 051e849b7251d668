// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarPCDWriter
 * @brief Writes echoes as PCD 0.7, the format of the Point Cloud Library (PCL), in rows and columns
 * if the beams of the scan form a grid.
 *
 * Input port 0 is a vtkPointSet. The file has the fields `x`, `y`, `z` (m), `intensity` (float),
 * every other numeric point array in the type of the array (64-bit integers as doubles, exact up to
 * 2^53), and `rgb` packed as in PCL. An array of several components becomes the fields `name_0`,
 * `name_1`, ... The field data `position` and `orientation` become the VIEWPOINT. Units and field
 * data become one line of JSON in a comment. An array is left out with a warning if another field
 * already has its name.
 *
 * An organised file has the columns of the scan, in the order of firing, and a row for each
 * channel, the highest channel first. Cells without an echo hold NaN, -1 or 0. An organised file
 * needs field data of the beam source that give the grid, and arrays `beam_id` and `laser_id` that
 * agree with the grid. A cell holds one echo (see SetOrganisation()).
 *
 * Single precision changes a coordinate by at most 4 micrometres at 100 m and 0.12 mm at 4 km. The
 * writer gives a warning if a coordinate changes by more than 1 mm, and an error for coordinates
 * beyond 3.4e38 m. Source: The PCD file format, pointclouds.org.
 *
 * Example: `writer->SetFileName("echoes.pcd"); writer->Write();` Documentation:
 * reference/formats.md.
 *
 * @sa vtkAvianLidarCloudWriter, vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarPCDWriter_h
#define vtkAvianLidarPCDWriter_h

#include "vtkAvianLidarCloudWriter.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarPCDWriter : public vtkAvianLidarCloudWriter
{
public:
  static vtkAvianLidarPCDWriter* New();
  vtkTypeMacro(vtkAvianLidarPCDWriter, vtkAvianLidarCloudWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum FileTypes
  {
    FILE_TYPE_BINARY = 0,
    FILE_TYPE_ASCII = 1
  };

  enum Organisations
  {
    ORGANISATION_AUTOMATIC = 0,
    ORGANISATION_ORGANISED = 1,
    ORGANISATION_LIST = 2
  };

  enum Precisions
  {
    PRECISION_SINGLE = 0,
    PRECISION_DOUBLE = 1,
    PRECISION_AUTOMATIC = 2
  };

  ///@{
  /** Type: binary, or text with the fewest digits that are exact. Default FILE_TYPE_BINARY. */
  vtkAvianLidarLimitedMacro(FileType, FILE_TYPE_BINARY, FILE_TYPE_ASCII, FILE_TYPE_BINARY);
  void SetFileTypeToBinary() { this->SetFileType(FILE_TYPE_BINARY); }
  void SetFileTypeToASCII() { this->SetFileType(FILE_TYPE_ASCII); }
  ///@}

  ///@{
  /**
   * Whether the file has rows and columns. Automatic: only if no beam has several echoes.
   * Organised: always, with the echo of the largest `energy_received` in each cell, and an error if
   * the beams do not form a grid. List: never. Default ORGANISATION_AUTOMATIC.
   */
  vtkAvianLidarLimitedMacro(
    Organisation, ORGANISATION_AUTOMATIC, ORGANISATION_LIST, ORGANISATION_AUTOMATIC);
  void SetOrganisationToAutomatic() { this->SetOrganisation(ORGANISATION_AUTOMATIC); }
  void SetOrganisationToOrganised() { this->SetOrganisation(ORGANISATION_ORGANISED); }
  void SetOrganisationToList() { this->SetOrganisation(ORGANISATION_LIST); }
  ///@}

  ///@{
  /** Precision of x, y and z. PRECISION_AUTOMATIC: double if single precision moves a coordinate
   * by more than 1 mm, with a warning. PCL's point types hold only floats. Default
   * PRECISION_SINGLE. */
  vtkAvianLidarLimitedMacro(Precision, PRECISION_SINGLE, PRECISION_AUTOMATIC, PRECISION_SINGLE);
  void SetPrecisionToSingle() { this->SetPrecision(PRECISION_SINGLE); }
  void SetPrecisionToDouble() { this->SetPrecision(PRECISION_DOUBLE); }
  void SetPrecisionToAutomatic() { this->SetPrecision(PRECISION_AUTOMATIC); }
  ///@}

protected:
  vtkAvianLidarPCDWriter() = default;
  ~vtkAvianLidarPCDWriter() override = default;

  void WriteCloud(vtkPointSet* input) override;

private:
  vtkAvianLidarPCDWriter(const vtkAvianLidarPCDWriter&) = delete;
  void operator=(const vtkAvianLidarPCDWriter&) = delete;
};

#endif
