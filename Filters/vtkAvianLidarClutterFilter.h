// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarClutterFilter
 * @brief Which points of a stream of point clouds are clutter: those where the scans before had
 * echoes, too.
 *
 * **Input port 0**: a scan, any vtkPointSet, m: echoes of vtkAvianLidarEchoFilter, or clouds of any
 * reader. **Input port 1** (optional, vtkPolyData): a table learned before, output port 1 of this
 * class, also from a file.
 *
 * **Output port 0**: a shallow copy of the scan with the point arrays
 *
 * - `clutter_probability` (double, 0 to 1): share of the scans before with an echo in this place
 * - `is_clutter` (unsigned char): 1 where that is ClutterThreshold or more, and in the first WarmUp
 *   scans, in which too little is known; else 0
 *
 * **Output port 1**, the table (vtkPolyData): a vertex in the middle of each cell that is kept, in
 * the order of the cells, with the point arrays `clutter_probability` (double, its persistence,
 * this scan included) and `clutter_cell` (3 ints: azimuth, elevation and range as indices of the
 * cell).
 *
 * Field data of both: `learned_scans` (int, scans in memory, this one included), `position`
 * (3 doubles, m, of the sensor) and the settings, `clutter_window`, `clutter_threshold`,
 * `clutter_range_step` (m), `clutter_azimuth_step`, `clutter_elevation_step` (deg),
 * `clutter_range_tolerance`, `clutter_angular_tolerance`, `clutter_warm_up`, `clutter_learning`.
 *
 * **Method.** Space about the sensor is divided into cells: azimuth index a holds azimuths nearest
 * to a AzimuthStep (clockwise from north, y), elevation index e elevations nearest to
 * e ElevationStep, so that beams at multiples of the steps are in the middle of cells; range index
 * r holds ranges from r RangeStep on. AzimuthStep is made the nearest that divides 360 degrees.
 * Persistence of a cell: weighted share of the scans in which an echo lay in it, where each scan
 * weighs 1 - 1/Window as much as the next one; the sum of the weights is that of the scans there
 * have been. The clutter probability of a point is the largest persistence of the cells around its
 * own, as the scans before this one leave it: up to RangeTolerance cells nearer and farther,
 * AngularTolerance cells to each side, up and down. Cells whose persistence is below a thousandth
 * are forgotten (below 0.5 / Window where Window is beyond 500), so at most 1000 times as many
 * cells are kept as a scan has points (2 Window times).
 *
 * **Time.** The time of a scan, s: `DATA_TIME_STEP` of the data's information, else field data
 * `TimeValue`, else the start of its `revolution` (echoes have it, and `rotation_rate`), else the
 * time before + 1 if it is another cloud or was made anew. Steps of a revolution that sweeps
 * (`steps_per_revolution` above 1) are one scan. A scan of the same time as the last one replaces
 * it: what executes twice is counted once, and a scan is learned when a later one comes. A time
 * before the last one empties the memory, with a warning. So does, in silence, another position of
 * the sensor, another step or Window, another table, or Learning switched on or off. A memory that
 * is empty begins with the table, if there is one.
 *
 * **Position of the sensor**: field data `position` of the scan (echoes have it); without it
 * SensorPosition.
 *
 * **Determinism**: the same bits for any order of the points. **Pieces**: MPI ranks that execute
 * together have one piece each, learn the points of all, and the table is on rank 0. Otherwise the
 * input is asked for as a whole, and of several pieces the first has all.
 *
 * **Bad input**: numbers out of their range, coordinates that are not finite or beyond 1e30 m,
 * field data `position` or `TimeValue` that are not 3 and 1 finite numbers, a table without its
 * arrays or field data, or of other steps: an error that names what it is, with empty outputs; the
 * memory stays. A scan without points is a scan.
 *
 * **What it cannot do**: it has no picture of what an object is. A bird that stays in its cells is
 * clutter after about ClutterThreshold Window scans; what stands still but is perceived in a
 * smaller share of the scans than ClutterThreshold is not. The sensor has to stand still.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarClutterFilter_h
#define vtkAvianLidarClutterFilter_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPassInputTypeAlgorithm.h"

#include <cstdint> // For std::uint64_t
#include <memory>  // For std::unique_ptr
#include <string>
#include <vector>

class vtkDataObject;
class vtkFieldData;
class vtkMultiProcessController;
class vtkPointSet;
class vtkPolyData;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarClutterFilter : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarClutterFilter* New();
  vtkTypeMacro(vtkAvianLidarClutterFilter, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Length of the memory in scans, 1 to 100,000: a scan so long ago weighs 1 / e of the last one.
   * Default 200.
   */
  vtkSetMacro(Window, double);
  vtkGetMacro(Window, double);
  ///@}

  ///@{
  /**
   * From which clutter probability on a point is clutter, above 0 to 1. Default 0.05.
   */
  vtkSetMacro(ClutterThreshold, double);
  vtkGetMacro(ClutterThreshold, double);
  ///@}

  ///@{
  /**
   * Size of the cells: in range, 0.001 to 1000 m, default 1.5 m; in azimuth and elevation, 0.001 to
   * 90 degrees, default 0.375 degrees: those of the sensor `Search905`.
   */
  vtkSetMacro(RangeStep, double);
  vtkGetMacro(RangeStep, double);
  vtkSetMacro(AzimuthStep, double);
  vtkGetMacro(AzimuthStep, double);
  vtkSetMacro(ElevationStep, double);
  vtkGetMacro(ElevationStep, double);
  ///@}

  ///@{
  /**
   * How many cells around a point's own count, in range (errors of ranges, sway) and in angles
   * (jitter of the encoder, steps that are not those of the beams), 0 to 10. Default 1.
   */
  vtkSetMacro(RangeTolerance, int);
  vtkGetMacro(RangeTolerance, int);
  vtkSetMacro(AngularTolerance, int);
  vtkGetMacro(AngularTolerance, int);
  ///@}

  ///@{
  /**
   * In how many first scans all points are clutter, 0 to 100,000: without it a tracker behind would
   * begin with a track for each of them. A table on port 1 counts as the scans that it has learned.
   * Default 5.
   */
  vtkSetMacro(WarmUp, int);
  vtkGetMacro(WarmUp, int);
  ///@}

  ///@{
  /**
   * Where the sensor is, m, for scans without field data `position`. Default (0, 0, 0).
   */
  vtkSetVector3Macro(SensorPosition, double);
  vtkGetVector3Macro(SensorPosition, double);
  ///@}

  ///@{
  /**
   * Are scans learned? If not, the table on port 1 decides alone. Default true.
   */
  vtkSetMacro(Learning, bool);
  vtkGetMacro(Learning, bool);
  vtkBooleanMacro(Learning, bool);
  ///@}

  /**
   * Empty the memory, as for another stream whose times may be any.
   */
  void Forget();

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
  vtkAvianLidarClutterFilter();
  ~vtkAvianLidarClutterFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  double Window = 200.0;
  double ClutterThreshold = 0.05;
  double RangeStep = 1.5;
  double AzimuthStep = 0.375;
  double ElevationStep = 0.375;
  int RangeTolerance = 1;
  int AngularTolerance = 1;
  int WarmUp = 5;
  double SensorPosition[3] = { 0.0, 0.0, 0.0 };
  bool Learning = true;
  vtkMultiProcessController* Controller = nullptr;

private:
  vtkAvianLidarClutterFilter(const vtkAvianLidarClutterFilter&) = delete;
  void operator=(const vtkAvianLidarClutterFilter&) = delete;

  struct Memory;
  std::string CheckProperties() const;
  std::string Advance(vtkDataObject* cloud, vtkPolyData* table, Memory& memory);
  void Classify(
    const Memory& memory, const std::vector<std::uint64_t>& keys, vtkPointSet* output) const;
  void AddSettings(const Memory& memory, vtkFieldData* fields) const;

  std::unique_ptr<Memory> Kept;
};

#endif
