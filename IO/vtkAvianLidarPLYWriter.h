// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarPLYWriter
 * @brief Writes echoes as the points of a PLY file, and polygons as its faces.
 *
 * Input port 0 is a vtkPointSet. The element `vertex` has `x`, `y`, `z` (m), `intensity` (float),
 * then every other numeric point array in the type of the array (64-bit integers as doubles, exact
 * up to 2^53). An array of several components becomes `name_0`, `name_1`, ..., and `rgb` becomes
 * `red`, `green`, `blue`. Units and field data become JSON in comments, and
 * vtkAvianLidarPointCloudReader reads these comments. Polygons become the element `face`.
 *
 * An array is left out with a warning if another property already has its name. Triangle strips
 * give an error. Coordinates are rounded as in vtkAvianLidarPCDWriter.
 *
 * Example: `writer->SetFileName("echoes.ply"); writer->Write();` Documentation:
 * reference/formats.md. Source: G. Turk, "The PLY Polygon File Format", 1994.
 *
 * @sa vtkAvianLidarCloudWriter, vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarPLYWriter_h
#define vtkAvianLidarPLYWriter_h

#include "vtkAvianLidarCloudWriter.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarPLYWriter : public vtkAvianLidarCloudWriter
{
public:
  static vtkAvianLidarPLYWriter* New();
  vtkTypeMacro(vtkAvianLidarPLYWriter, vtkAvianLidarCloudWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum FileTypes
  {
    FILE_TYPE_BINARY = 0,
    FILE_TYPE_ASCII = 1
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
  /** Precision of x, y and z. PRECISION_AUTOMATIC: double if single precision moves a coordinate
   * by more than 1 mm, with a warning. Default PRECISION_SINGLE. */
  vtkAvianLidarLimitedMacro(Precision, PRECISION_SINGLE, PRECISION_AUTOMATIC, PRECISION_SINGLE);
  void SetPrecisionToSingle() { this->SetPrecision(PRECISION_SINGLE); }
  void SetPrecisionToDouble() { this->SetPrecision(PRECISION_DOUBLE); }
  void SetPrecisionToAutomatic() { this->SetPrecision(PRECISION_AUTOMATIC); }
  ///@}

protected:
  vtkAvianLidarPLYWriter() = default;
  ~vtkAvianLidarPLYWriter() override = default;

  void WriteCloud(vtkPointSet* input) override;

private:
  vtkAvianLidarPLYWriter(const vtkAvianLidarPLYWriter&) = delete;
  void operator=(const vtkAvianLidarPLYWriter&) = delete;
};

#endif
