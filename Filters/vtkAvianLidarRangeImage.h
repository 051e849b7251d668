// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarRangeImage
 * @brief Makes an image of a scan, azimuth by elevation, from the strongest return of each beam.
 *
 * - Input port 0, echoes: vtkPolyData with `beam_id`, `distance_m`, `energy`, `energy_received` and
 *   `object_id`, or without points.
 * - Input port 1, beams: vtkPolyData, output 0 of the beam source or output 1 of the echo filter
 *   (the beam report). Required arrays are `azimuth` and `vertical_angle`, or `direction`.
 *   `beam_id` and, for a tilted sensor, `laser_id` are optional.
 * - Output port 0: vtkImageData, a point per column and row (rows upwards), with `distance_m` and
 *   `energy` (NaN without an echo) and `object_id` (int, -1 without an echo). A beam report adds
 *   `status`, `skipped`, `candidates`, `nodes_visited`, `rays_traced` (-1 without a beam) and
 *   `skipped_bound` (NaN without a beam). Field data: `column_azimuths`, `row_elevations`, and the
 *   limits of the receiver.
 *
 * Columns are the distinct azimuths of the beams. Rows are the distinct elevations. Angles that
 * differ by at most 1e-4 degrees count as equal. If the beams come from a vtkAvianLidarBeamSource
 * through the pipeline, columns and rows are taken from the sensor's whole scan, and otherwise from
 * the given beams. Rows of a tilted sensor are channels. For grids, spacing and maps see
 * Documentation/guide/clouds.md.
 *
 * Before execution, the size of the image comes from the beam source, or from Columns and Rows with
 * origin 0 and spacing 1. MPI ranks share echoes and beams. Each rank makes one sub-extent.
 *
 * An error names array and port, and the image is then empty. Errors are missing or bad arrays, an
 * echo without its beam, a `beam_id` that two beams have, beams that do not form a grid, and a grid
 * whose size differs from the size before execution. Without beams the image has the size given
 * before execution and no echoes.
 *
 * @code
 * image->SetInputConnection(0, echoes->GetOutputPort(0));
 * image->SetInputConnection(1, echoes->GetOutputPort(1));
 * @endcode
 *
 * @sa vtkAvianLidarBeamSource, vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarRangeImage_h
#define vtkAvianLidarRangeImage_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkImageAlgorithm.h"

class vtkPolyData;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarRangeImage : public vtkImageAlgorithm
{
public:
  static vtkAvianLidarRangeImage* New();
  vtkTypeMacro(vtkAvianLidarRangeImage, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Number of columns, 0 or more, for beams that are not from a beam source. Default 0: automatic.
  vtkAvianLidarLimitedMacro(Columns, 0, VTK_INT_MAX, 0);

  /// Number of rows, 0 or more, for beams that are not from a beam source. Default 0: automatic.
  vtkAvianLidarLimitedMacro(Rows, 0, VTK_INT_MAX, 0);

  /// Controller of the processes that may work together; null: this process works alone. Default:
  /// the global controller.
  vtkAvianLidarControllerMacro();

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarRangeImage();
  ~vtkAvianLidarRangeImage() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarRangeImage(const vtkAvianLidarRangeImage&) = delete;
  void operator=(const vtkAvianLidarRangeImage&) = delete;

  bool SizeIsGiven() const { return this->Columns > 0 && this->Rows > 0; }
  void MakeImage(
    vtkPolyData* echoes, vtkPolyData* input, vtkInformation* beamsInfo, vtkInformation* info);
};

#endif
