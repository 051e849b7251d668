// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarRangeImage
 * @brief The scan as an image, azimuth by elevation: range, energy and object of the strongest
 * return; of a beam report, status and cost of every beam.
 *
 * **Input port 0** (vtkPolyData): echoes, with the point arrays `beam_id`, `distance_m` (m),
 * `energy` (J), `energy_received` (J) and `object_id`. **Input port 1** (vtkPolyData): the beams of
 * the scan, with the point arrays `azimuth` (0.01 deg) and `vertical_angle` (deg) or, instead of
 * both, `direction`; `beam_id` (else beams are numbered as they come) and, for a tilted sensor,
 * `laser_id`: output 0 of the beam source or output 1 of the echo filter, the beam report. One
 * component each, three for `direction`; any numeric type, identifiers whole numbers, energies and
 * distances finite; anything else is an error that names port, array and point.
 *
 * **Output** (vtkImageData): one point per column (azimuth) and row (elevation, upwards), with the
 * point arrays
 *
 * - `distance_m` (double, m; NaN where there is no echo)
 * - `energy` (double, J; NaN where there is no echo)
 * - `object_id` (int; -1 where there is no echo)
 *
 * of the return of the beam with the largest `energy_received` (of equal ones the nearest). Of the
 * arrays of a beam report those that the beams have: `status`, `skipped` (int), `candidates`,
 * `nodes_visited`, `rays_traced` (vtkIdType; -1 in a cell without a beam), `skipped_bound` (double,
 * J; NaN); of several beams in a cell, of the one whose return it shows, else of the first.
 *
 * **Columns and rows** are the distinct azimuths and elevations, to 1e-4 degrees: of the sensor's
 * whole scan where the beams come from a vtkAvianLidarBeamSource through the pipeline, so the image
 * is of one size while a scan sweeps, and cells whose beam has not been fired have no echo; else
 * (beams of a file, or turned on the way) of the beams that there are. Where they are equally
 * spaced, origin and spacing of the image are in degrees (a sector across north starts at a
 * negative azimuth); where they are not, as with a table of channel elevations, that axis counts
 * from 0 in steps of 1 and a row is a channel. The angles themselves are field data:
 * `column_azimuths` and `row_elevations`, double, in degrees. The beams of a tilted sensor lie on
 * no common azimuths and elevations: then rows are channels, columns count their firings, the axes
 * count, and the field data give the azimuths of the lowest channel and the mean elevation of each.
 * The receiver's limits, `lower_energy_limit` and `upper_energy_limit` (J), are those of the beams.
 *
 * **Size and pieces.** What is downstream learns the size before anything executes: from a
 * vtkAvianLidarBeamSource through the pipeline, else from `Columns` and `Rows`, with origin 0 and
 * spacing 1: those in degrees come with the data, too late for filters that take them from the
 * pipeline. Beams that form another grid are an error that names its size. MPI ranks that execute
 * together have one piece each of echoes and beams, receive those of all, and make one sub-extent
 * each. Otherwise both inputs are asked for as a whole, and the sub-extent that is wanted is cut
 * out.
 *
 * **Bad input**: missing arrays, arrays without one value per point, integers that are none, an
 * echo of no beam, two beams with one `beam_id`, beams that form no grid or one of another size,
 * angles that are not finite are an error that names array and port, with an empty image. There may
 * be no echoes: port 0 has to be connected, but its data may be empty. There may be no beams: then
 * no cell of the announced size has an echo (by `Columns` and `Rows`, origin 0 and spacing 1), and
 * without an announced size the image is empty.
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
  /**
   * Size of the image for beams that come from no vtkAvianLidarBeamSource, or were turned on the
   * way: both at least 1; or 0, the default, for the size that the pipeline announces. Where both
   * are given the grid is that of the beams that there are.
   */
  vtkSetClampMacro(Columns, int, 0, VTK_INT_MAX);
  vtkGetMacro(Columns, int);
  vtkSetClampMacro(Rows, int, 0, VTK_INT_MAX);
  vtkGetMacro(Rows, int);
  ///@}

  ///@{
  /**
   * The processes that may work together. Default: the global controller when the filter was
   * made; null: this process works alone.
   */
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
