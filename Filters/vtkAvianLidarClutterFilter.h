// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarClutterFilter
 * @brief Finds clutter in a stream of point clouds: points where earlier scans had echoes, too.
 *
 * Space around the sensor is divided into cells of range, azimuth and elevation. The persistence of
 * a cell is the weighted share of scans with an echo in the cell. The weight of each scan is
 * 1 - 1/Window times the weight of the next scan. The filter keeps the persistences as its memory.
 * The clutter probability of a point is the largest persistence that the point's cell and the cells
 * around this cell had before the scan of the point. Method, times and limits:
 * Documentation/guide/filters.md. The sensor must stand still.
 *
 * - Input port 0, a scan: any vtkPointSet in metres, such as echoes or the cloud of a reader.
 * - Input port 1, a table (optional): vtkPolyData, the output port 1 of an earlier run, directly or
 *   from a file.
 * - Output port 0: a shallow copy of the scan with the point arrays `clutter_probability` and
 *   `is_clutter`.
 * - Output port 1, the table: vtkPolyData, a vertex in the middle of each cell that has a
 *   persistence, in the order of `clutter_cell`. The point arrays are `clutter_probability` and
 *   `clutter_cell`. Rank 0 has the table of all ranks.
 * - Field data of both output ports: `learned_scans`, `position` and the settings in snake case
 *   with the prefix `clutter_`, such as `clutter_window`.
 *
 * The time of a scan is DATA_TIME_STEP of the input, else the field data `TimeValue`, else the
 * start of its `revolution`, else 1 s after the scan before. A scan with the time of the last scan
 * replaces the last scan. An earlier time empties the memory, with a warning. A change of position,
 * cell size, Window, table or Learning empties the memory without a warning.
 *
 * Bad settings, coordinates beyond 1e30 m, bad field data or a table with cells of another size
 * give an error and empty outputs. After an error, the memory is unchanged. A scan without points
 * counts as a scan. The result has the same bits for any order of the points and any number of
 * ranks.
 *
 * @code
 * clutter->SetInputConnection(echoes->GetOutputPort(0));
 * tracker->SetInputConnection(clutter->GetOutputPort(0));
 * @endcode
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarPointCloudReader, vtkAvianLidarTracker
 */
#ifndef vtkAvianLidarClutterFilter_h
#define vtkAvianLidarClutterFilter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPassInputTypeAlgorithm.h"

#include <cstdint> // For std::uint64_t
#include <memory>  // For std::unique_ptr
#include <string>
#include <vector>

class vtkDataObject;
class vtkFieldData;
class vtkPointSet;
class vtkPolyData;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarClutterFilter : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarClutterFilter* New();
  vtkTypeMacro(vtkAvianLidarClutterFilter, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Number of scans after which the weight of a scan is 1/e, 1 to 100,000. Default 200.
  vtkAvianLidarPropertyMacro(Window, double, 200.0);

  /// Least clutter probability of a point that is clutter, 1, above 0 to 1. Default 0.05.
  vtkAvianLidarPropertyMacro(ClutterThreshold, double, 0.05);

  /// Size of the cells in range, m, 0.001 to 1000. Default 1.5, as for the sensor Search905.
  vtkAvianLidarPropertyMacro(RangeStep, double, 1.5);

  /// Size of the cells in azimuth, deg, 0.001 to 90, adjusted to divide 360. Default 0.375.
  vtkAvianLidarPropertyMacro(AzimuthStep, double, 0.375);

  /// Size of the cells in elevation, deg, 0.001 to 90. Default 0.375.
  vtkAvianLidarPropertyMacro(ElevationStep, double, 0.375);

  /// Number of cells in range on each side of a point's cell that are searched for clutter, 0 to
  /// 10. Default 1.
  vtkAvianLidarPropertyMacro(RangeTolerance, int, 1);

  /// Number of cells in angle on each side of a point's cell that are searched for clutter, 0 to
  /// 10. Default 1.
  vtkAvianLidarPropertyMacro(AngularTolerance, int, 1);

  /// Number of scans at the beginning in which all points are clutter, 0 to 100,000. Scans from
  /// which a table was made count, too. Default 5.
  vtkAvianLidarPropertyMacro(WarmUp, int, 5);

  /// Position of the sensor, m, for scans without the field data `position`. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(SensorPosition, 3, 0.0, 0.0, 0.0);

  /// Whether scans are added to the memory. Otherwise only the table of port 1 is used. Default:
  /// on.
  vtkAvianLidarSwitchMacro(Learning, true);

  /// Empty the memory, for a new stream whose first scan may have any time.
  void Forget();

  /// Controller of the processes that may work together; null: this process works alone. Default:
  /// the global controller.
  vtkAvianLidarControllerMacro();

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarClutterFilter();
  ~vtkAvianLidarClutterFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarClutterFilter(const vtkAvianLidarClutterFilter&) = delete;
  void operator=(const vtkAvianLidarClutterFilter&) = delete;

  struct Memory;
  void CheckProperties() const;
  void Advance(vtkDataObject* cloud, vtkPolyData* table, Memory& memory);
  void Classify(
    const Memory& memory, const std::vector<std::uint64_t>& keys, vtkPointSet* output) const;
  void AddSettings(const Memory& memory, vtkFieldData* fields) const;

  std::unique_ptr<Memory> Kept;
};

#endif
