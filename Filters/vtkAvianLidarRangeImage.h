// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarRangeImage
 * @brief The scan as an image, azimuth by elevation: the strongest return of every beam; with a
 * beam report its status and cost.
 *
 * - Input port 0: vtkPolyData, echoes with `beam_id`, `distance_m`, `energy`, `energy_received` and
 *   `object_id`; there may be none.
 * - Input port 1: vtkPolyData, the beams with `azimuth` and `vertical_angle`, or `direction`, and,
 *   optionally, `beam_id` and, for a tilted sensor, `laser_id`: output 0 of the beam source, or
 *   output 1 of the echo filter (the beam report).
 * - Output port 0: vtkImageData, a point per column and row (upwards), with `distance_m`, `energy`
 *   (NaN without echo), `object_id` (int, -1), and of a beam report `status`, `skipped`,
 *   `candidates`, `nodes_visited`, `rays_traced` (-1 without a beam), `skipped_bound` (NaN). Field
 *   data: `column_azimuths`, `row_elevations`, and the limits of the receiver.
 *
 * Columns and rows are the distinct azimuths and elevations, to 1e-4 degrees, of the sensor's whole
 * scan if the beams come from a vtkAvianLidarBeamSource through the pipeline, else of the beams
 * given. Rows of a tilted sensor are channels. Grids, spacing and maps:
 * Documentation/guide/clouds.md.
 *
 * The size is known before execution, from the beam source or from Columns and Rows (then with
 * origin 0 and spacing 1 until the data come). MPI ranks share echoes and beams; each makes one
 * sub-extent.
 *
 * Missing or bad arrays, an echo of no beam, a `beam_id` twice, and beams that form no grid or
 * another than announced are an error that names array and port, with an empty image. No beams: an
 * image of the announced size without echoes.
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

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <string>

class vtkMultiProcessController;
class vtkPolyData;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarRangeImage : public vtkImageAlgorithm
{
public:
  static vtkAvianLidarRangeImage* New();
  vtkTypeMacro(vtkAvianLidarRangeImage, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Columns of the image for beams that come from no beam source; 0, the default: automatic. */
  vtkSetClampMacro(Columns, int, 0, VTK_INT_MAX);
  vtkGetMacro(Columns, int);
  ///@}

  ///@{
  /** Rows of the image for beams that come from no beam source; 0, the default: automatic. */
  vtkSetClampMacro(Rows, int, 0, VTK_INT_MAX);
  vtkGetMacro(Rows, int);
  ///@}

  ///@{
  /** Processes that may work together; null: this one alone. Default: the global controller. */
  void SetController(vtkMultiProcessController* controller);
  vtkGetObjectMacro(Controller, vtkMultiProcessController);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarRangeImage();
  ~vtkAvianLidarRangeImage() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int Columns = 0;
  int Rows = 0;
  vtkMultiProcessController* Controller = nullptr;

private:
  vtkAvianLidarRangeImage(const vtkAvianLidarRangeImage&) = delete;
  void operator=(const vtkAvianLidarRangeImage&) = delete;

  bool SizeIsGiven() const { return this->Columns > 0 && this->Rows > 0; }
  std::string MakeImage(
    vtkPolyData* echoes, vtkPolyData* input, vtkInformation* beamsInfo, vtkInformation* info);
};

#endif
