// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSequenceReader
 * @brief Reads a labelled sequence of scans, such as `avianlidar sequence` writes, as a time
 * series.
 *
 * FileName is the `times.txt` (s, rising) of a sequence in SemanticKITTI's layout, with `velodyne`,
 * `labels`, `boxes`, `poses.txt` and `calib.txt` beside it. Each scan is a time step. Any other
 * time gives the last scan before this time, or the first scan if no scan is earlier.
 *
 * - Output port 0, points: vtkPolyData with the arrays of vtkAvianLidarPointCloudReader. The active
 *   scalars are `semantic_label` if the scan has labels, else `intensity`.
 * - Output port 1, boxes: vtkPolyData with six quadrilaterals for each box and the cell arrays
 *   `object` (class, text) and `object_id`. The output is empty if the scan has no file of boxes.
 *
 * The poses and the line `Tr:` of `calib.txt` transform points to the frame of the poses. In this
 * project's sequences this frame is east, north and up of the scene's origin, m. Without
 * `poses.txt` points are in the sensor's frame, with x right and y forward.
 *
 * Errors name the file and the fault. The outputs are empty after an error. Piece 0 has the whole
 * output.
 *
 * Example: `reader->SetFileName("sequences/00/times.txt");` Documentation: guide/sequences.md.
 *
 * @sa vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarSequenceReader_h
#define vtkAvianLidarSequenceReader_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarSequenceReader : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarSequenceReader* New();
  vtkTypeMacro(vtkAvianLidarSequenceReader, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of `times.txt`. Call Modified() if a file of the sequence changes. Default: no path, which
   * gives an error.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /// Returns 1 if the file is a `times.txt` and its folder has a folder `velodyne`, else 0.
  static int CanReadFile(VTK_FILEPATH const char* fileName);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarSequenceReader();
  ~vtkAvianLidarSequenceReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  char* FileName = nullptr;

private:
  vtkAvianLidarSequenceReader(const vtkAvianLidarSequenceReader&) = delete;
  void operator=(const vtkAvianLidarSequenceReader&) = delete;
};

#endif
