// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCloudWriter
 * @brief Base of the writers of point clouds: a file is written as a whole or not at all.
 *
 * Input port 0 is a vtkPointSet. Write() returns 1 if the file was written, else 0.
 *
 * Bytes go to a temporary file in the same folder (FileName with .avianpart and a digit), which is
 * renamed at the end. After an error, an abort or a full disk the old file stays as it was. A
 * replaced file keeps its permissions, and a link stays a link
 * (Documentation/evidence/reliability.md). Points are written one after the other, without a copy
 * of the cloud.
 *
 * Errors name file and reason: no file name, an input whose producer failed, a file that cannot be
 * written, an array or field that is missing or has a kind, shape or range that the format does not
 * hold.
 *
 * @sa vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarCloudWriter_h
#define vtkAvianLidarCloudWriter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkWriter.h"

#include <string> // For std::string

class vtkPointSet;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarCloudWriter : public vtkWriter
{
public:
  vtkTypeMacro(vtkAvianLidarCloudWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The file to write. Default: none, which is an error. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * Name as the user gave it, for writers that derive FileName from it, such as ParaView's, which
   * do so for each time step. SetMadeFileName() removes the slash that ParaView puts before names
   * without a folder. Default: none.
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

  /// Write the input to FileName. Throws an exception on an error.
  virtual void WriteCloud(vtkPointSet* input) = 0;

  /// Give a warning: FileName and a text.
  void Warn(const std::string& text);

  char* FileName = nullptr;
  char* GivenFileName = nullptr;

private:
  vtkAvianLidarCloudWriter(const vtkAvianLidarCloudWriter&) = delete;
  void operator=(const vtkAvianLidarCloudWriter&) = delete;
};

#endif
