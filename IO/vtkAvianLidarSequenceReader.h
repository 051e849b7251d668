// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSequenceReader
 * @brief Reads a labelled sequence of scans, as `avianlidar sequence` writes it, as one time
 * series.
 *
 * The file is the `times.txt` of a sequence in the layout of SemanticKITTI: a time (s) in each
 * line, rising, for the scans `velodyne/000000.bin`, `000001.bin`, ... beside it, with labels in
 * `labels`. Each scan is a time step (TIME_STEPS, TIME_RANGE); any other time has the last scan
 * before it, or the first.
 *
 * **Output port 0**, points (vtkPolyData): a scan as vtkAvianLidarPointCloudReader reads it. Active
 * scalars are `semantic_label`, where there are labels.
 *
 * **Output port 1**, boxes (vtkPolyData): the boxes of `boxes/000000.txt` about what moves, six
 * quadrilaterals each; empty where there is no such file. Cell data: `object` (the class, a text),
 * `object_id`.
 *
 * **Frame.** The poses of `poses.txt` (3 x 4 numbers in each line) and the line `Tr:` of
 * `calib.txt` carry points from the sensor's frame (x forward, y left, z up) to that of the poses:
 * of this project's sequences metres east, north and up of the scene's origin. Without `poses.txt`
 * points are in the frame of vtkAvianLidarPointCloudReader (x right, y forward).
 *
 * **Errors** name the file and what is wrong: no file name, not there, no times, times that do not
 * rise, no pose for a scan, and all that a scan may have wrong. Outputs are empty then. Pieces: all
 * is piece 0.
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
  /**
   * The `times.txt` of the sequence. Default: none, which is an error. A change of the files on
   * disk is not noticed: call Modified().
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /**
   * Whether a file is a `times.txt` with a folder `velodyne` beside it. 1 or 0.
   */
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
