// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCloudWriter
 * @brief What the writers of point clouds have in common: a file that is there as a whole or not at
 * all.
 *
 * **Input** (port 0): a vtkPointSet. Write() returns 1 if the file was written, else 0.
 *
 * Bytes go to a part in the same folder (the name with .avianpart and a digit), which takes the
 * name FileName at the end: whatever goes wrong, nothing half-written is left and a file that had
 * the name stays as it was. A file that is replaced keeps its permissions, a link stays a link. The
 * part of a process that was killed stays until the file is written again. **Errors**: no file
 * name, an input whose producer failed, a file that cannot be opened, written to its end (the disk
 * is full) or given its name, an array or a field that is missing or of another kind or shape than
 * said, a value that is not finite or no whole number where one is said: a message that names file
 * and reason. After an abort (vtkAlgorithm::SetAbortExecute() from an observer of its progress)
 * nothing is left either. Points are taken one after the other; no copy of the cloud is made.
 *
 * @sa vtkAvianLidarLASWriter vtkAvianLidarPCDWriter vtkAvianLidarPLYWriter vtkAvianLidarKITTIWriter
 * vtkAvianLidarGeoJSONWriter vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarCloudWriter_h
#define vtkAvianLidarCloudWriter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkWriter.h"

class vtkPointSet;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarCloudWriter : public vtkWriter
{
public:
  vtkTypeMacro(vtkAvianLidarCloudWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The file to write. Default: none, which is an error.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * For writers that make FileName of another name, as ParaView's do for every step of a series:
   * the name as it was given. They put a slash before names without a folder, which would then be
   * files of the root folder: SetMadeFileName() sets FileName without it. Default: none.
   */
  vtkSetFilePathMacro(GivenFileName);
  vtkGetFilePathMacro(GivenFileName);
  void SetMadeFileName(VTK_FILEPATH const char* name);
  ///@}

protected:
  vtkAvianLidarCloudWriter();
  ~vtkAvianLidarCloudWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

  /// Writes the input to FileName; what is wrong is an exception.
  virtual void WriteCloud(vtkPointSet* input) = 0;

  char* FileName;
  char* GivenFileName;

private:
  vtkAvianLidarCloudWriter(const vtkAvianLidarCloudWriter&) = delete;
  void operator=(const vtkAvianLidarCloudWriter&) = delete;
};

#endif
