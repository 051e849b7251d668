// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarPCDWriter
 * @brief Writes echoes as PCD 0.7, the format of the Point Cloud Library, in rows and columns where
 * the scan has them.
 *
 * Fields: `x`, `y`, `z` (m), `intensity` (0 to 255, float as PCL's point types have it), then every
 * other numeric point array of one component, of its own type, and `rgb` (three unsigned chars)
 * packed as PCL does. `beam_id` and other integers of 64 bits are written as doubles, exact up to
 * 2^53, since PCL's tools of today do not all know such integers. The sensor's `position` and
 * `orientation` (field data) become the VIEWPOINT; units and field data stand as one line of JSON
 * in a comment. An array whose name another field has (blanks of names become underscores) is left
 * out with a warning. A file is written as a whole or not at all, see vtkAvianLidarCloudWriter.
 *
 * **Rounding.** With Precision Single, which is what PCL's point types take, a coordinate is off by
 * at most 2^-25 of the next power of two above it: 4 micrometres at 100 m, 0.12 mm at 4 km. From 1
 * mm on (16 km) a warning says so; beyond 3.4e38 m it is an error. ASCII has the shortest digits
 * that give the same numbers back.
 *
 * **Organised** (WIDTH columns, HEIGHT channels, the highest first; not-a-number in x, y, z where
 * no echo is, -1 in identifiers, 0 in counts): if the field data of the beam source say what the
 * grid is (`number_of_channels`, `azimuth_range`, `azimuth_step`) and `beam_id` and `laser_id` fit
 * it. A cell has room for one echo: Automatic organises only if no beam has more (return modes
 * Strongest, First, Last), Organised keeps the strongest (`energy_received`, else the first) and is
 * an error without a grid, List never organises (HEIGHT 1). No points: a list of none.
 *
 * Source: The PCD file format, pointclouds.org.
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

  /// Values of FileType.
  enum FileTypes
  {
    FILE_TYPE_BINARY = 0,
    FILE_TYPE_ASCII = 1
  };

  /// Values of Organisation.
  enum Organisations
  {
    ORGANISATION_AUTOMATIC = 0,
    ORGANISATION_ORGANISED = 1,
    ORGANISATION_LIST = 2
  };

  /// Values of Precision.
  enum Precisions
  {
    PRECISION_SINGLE = 0,
    PRECISION_DOUBLE = 1
  };

  ///@{
  /**
   * Binary or text. Default FILE_TYPE_BINARY.
   */
  vtkSetClampMacro(FileType, int, FILE_TYPE_BINARY, FILE_TYPE_ASCII);
  vtkGetMacro(FileType, int);
  void SetFileTypeToBinary() { this->SetFileType(FILE_TYPE_BINARY); }
  void SetFileTypeToASCII() { this->SetFileType(FILE_TYPE_ASCII); }
  ///@}

  ///@{
  /**
   * Whether points stand in rows and columns, see the class. Default ORGANISATION_AUTOMATIC.
   */
  vtkSetClampMacro(Organisation, int, ORGANISATION_AUTOMATIC, ORGANISATION_LIST);
  vtkGetMacro(Organisation, int);
  void SetOrganisationToAutomatic() { this->SetOrganisation(ORGANISATION_AUTOMATIC); }
  void SetOrganisationToOrganised() { this->SetOrganisation(ORGANISATION_ORGANISED); }
  void SetOrganisationToList() { this->SetOrganisation(ORGANISATION_LIST); }
  ///@}

  ///@{
  /**
   * Type of x, y and z. Default PRECISION_SINGLE; PCL's own point types do not take doubles.
   */
  vtkSetClampMacro(Precision, int, PRECISION_SINGLE, PRECISION_DOUBLE);
  vtkGetMacro(Precision, int);
  void SetPrecisionToSingle() { this->SetPrecision(PRECISION_SINGLE); }
  void SetPrecisionToDouble() { this->SetPrecision(PRECISION_DOUBLE); }
  ///@}

protected:
  vtkAvianLidarPCDWriter();
  ~vtkAvianLidarPCDWriter() override;

  void WriteCloud(vtkPointSet* input) override;

  int FileType;
  int Organisation;
  int Precision;

private:
  vtkAvianLidarPCDWriter(const vtkAvianLidarPCDWriter&) = delete;
  void operator=(const vtkAvianLidarPCDWriter&) = delete;
};

#endif
