// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCloudWriter
 * @brief Base class for writing a point cloud to a file, as a whole or not at all.
 *
 * Input port 0 is a vtkPointSet. Write() returns 1 if the file was written, else 0.
 *
 * The writer writes to a temporary file in the same folder (FileName with .avianpart and a number)
 * and renames this file at the end. After an error, an abort or a full disk the old file is
 * unchanged. The new file has the permissions of the old file. If FileName is a symbolic link, the
 * target of the link is replaced (Documentation/evidence/reliability.md). Points are written one
 * after the other, without a copy of the cloud.
 *
 * An error names the file and the reason. Reasons are a missing file name, an input whose producer
 * failed, a file that cannot be written, and a point array or field data array that is missing or
 * has a type, shape or range that the format cannot hold.
 *
 * @sa vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarCloudWriter_h
#define vtkAvianLidarCloudWriter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkWriter.h"

#include <string> // For std::string

class vtkPointSet;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarCloudWriter : public vtkWriter
{
public:
  vtkTypeMacro(vtkAvianLidarCloudWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Name of the file to write. Default: no name, which gives an error. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * File name as the user gave it. ParaView derives FileName from this name for each time step.
   * SetMadeFileName() sets FileName without the slash that ParaView puts before names without a
   * folder. Default: no name.
   */
  vtkSetFilePathMacro(GivenFileName);
  vtkGetFilePathMacro(GivenFileName);
  void SetMadeFileName(VTK_FILEPATH const char* name);
  ///@}

protected:
  vtkAvianLidarCloudWriter() = default;
  ~vtkAvianLidarCloudWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

  /// Writes the input to FileName. Throws an exception on an error.
  virtual void WriteCloud(vtkPointSet* input) = 0;

  /// Gives a warning that begins with FileName and continues with the text.
  void Warn(const std::string& text);

  char* FileName = nullptr;
  char* GivenFileName = nullptr;

private:
  vtkAvianLidarCloudWriter(const vtkAvianLidarCloudWriter&) = delete;
  void operator=(const vtkAvianLidarCloudWriter&) = delete;
};

#endif
