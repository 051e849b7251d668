// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSequenceReader
 * @brief Reads a labelled sequence of scans, as `avianlidar sequence` writes it, as one time
 * series.
 *
 * FileName is the `times.txt` (s, rising) of a sequence in SemanticKITTI's layout, with `velodyne`,
 * `labels`, `boxes`, `poses.txt` and `calib.txt` beside it. Each scan is a time step; any other
 * time gives the last scan before that time, or else the first.
 *
 * - Output port 0, points: vtkPolyData as vtkAvianLidarPointCloudReader reads a scan; active
 *   scalars are `semantic_label`, if there are labels.
 * - Output port 1, boxes: vtkPolyData, six quadrilaterals each, with the cell arrays `object`
 *   (class, text) and `object_id`; empty without a file of boxes.
 *
 * Poses and the line `Tr:` transform points to the frame of the poses: east, north and up of the
 * scene's origin for this project's sequences. Without `poses.txt` x is right and y forward.
 *
 * Errors name the file and the fault, and leave empty outputs. Piece 0 has the whole output.
 *
 * Example: `reader->SetFileName("sequences/00/times.txt");` Documentation: guide/sequences.md.
 *
 * @sa vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarSequenceReader_h
#define vtkAvianLidarSequenceReader_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <vector> // For the times

class VTKAVIANLIDAR_EXPORT vtkAvianLidarSequenceReader : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarSequenceReader* New();
  vtkTypeMacro(vtkAvianLidarSequenceReader, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The `times.txt`. After a change on disk call Modified(). Default: none, which is an error. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /// 1 if a file is a `times.txt` with a folder `velodyne` beside it, else 0.
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
