// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarPLYWriter
 * @brief Writes echoes as the points of a PLY file.
 *
 * The element `vertex` has the properties `x`, `y`, `z` (m), `intensity` (0 to 255, float), then
 * every other numeric point array of its own type: `name_0`, `name_1`, ... where it has several
 * components, `red`, `green`, `blue` for `rgb` (three unsigned chars). Integers of 64 bits are
 * written as doubles, exact up to 2^53: PLY has none. Units and field data, the sensor's place
 * among them, stand as JSON in comments (one that begins with a plus sign continues the one before:
 * VTK and others do not take long lines), which vtkAvianLidarPointCloudReader reads back. Polygons
 * become the element `face`: ParaView, which takes a writer by the ending of the name, saves meshes
 * by this one; triangle strips are an error. An array of one component whose name another property
 * has (blanks of names become underscores) is left out with a warning, of several it is an error. A
 * file is written as a whole or not at all, see vtkAvianLidarCloudWriter.
 *
 * **Rounding.** As vtkAvianLidarPCDWriter has it. ASCII has the shortest digits that give the same
 * numbers back.
 *
 * Source: G. Turk, "The PLY Polygon File Format", 1994.
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

  /// Values of FileType.
  enum FileTypes
  {
    FILE_TYPE_BINARY = 0,
    FILE_TYPE_ASCII = 1
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
   * Type of x, y and z. Default PRECISION_SINGLE.
   */
  vtkSetClampMacro(Precision, int, PRECISION_SINGLE, PRECISION_DOUBLE);
  vtkGetMacro(Precision, int);
  void SetPrecisionToSingle() { this->SetPrecision(PRECISION_SINGLE); }
  void SetPrecisionToDouble() { this->SetPrecision(PRECISION_DOUBLE); }
  ///@}

protected:
  vtkAvianLidarPLYWriter();
  ~vtkAvianLidarPLYWriter() override;

  void WriteCloud(vtkPointSet* input) override;

  int FileType;
  int Precision;

private:
  vtkAvianLidarPLYWriter(const vtkAvianLidarPLYWriter&) = delete;
  void operator=(const vtkAvianLidarPLYWriter&) = delete;
};

#endif
