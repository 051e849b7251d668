// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarTracker
 * @brief Tracks birds in point clouds that come one after the other.
 *
 * Each execution takes one cloud, a whole scan. The points are grouped into clusters. Clusters are
 * assigned to tracks one to one by least cost. Clusters without a track begin new tracks. Kalman
 * filters follow the motion (Bar-Shalom, Li and Kirubarajan, Estimation with Applications to
 * Tracking and Navigation, 2001). The filter keeps the tracks as its memory. Method, times and
 * limits: Documentation/guide/tracks.md.
 *
 * - Input port 0: vtkPolyData, points in metres. Optional: point arrays `is_clutter` (points with a
 *   value other than 0 are left out), `timestamp`, `distance_std_error`; field data `position`,
 *   `half_beamwidth`.
 * - Output port 0, tracks: vtkPolyData, a vertex for each track of one position, then a polyline
 *   for each other track. Vertices and polylines are in the order of `track_id`. Point arrays:
 *   `time`, `velocity` (0 at the first position), `position_covariance`, `number_of_echoes`. Cell
 *   arrays: `track_id`, `confirmed`, `ended`, `hits`.
 * - Output port 1, points: the input with `track_id` and `track_confirmed`.
 * - Field data of both ports: `time` and the settings in snake case.
 *
 * The time of a cloud is DATA_TIME_STEP, else the field data `TimeValue`, else the start of its
 * `revolution`, else 1 s after the cloud before. A cloud with the time of the last cloud replaces
 * the last cloud. An earlier time empties the memory, with a warning. Timestamps are used only if
 * all timestamps are later than the times of the cloud before. Otherwise a warning is given.
 *
 * Bad settings, points or arrays give an error and empty outputs. After an error, the memory is
 * unchanged. The tracks have the same bits for any order of the points. On port 0, rank 0 has the
 * tracks of all ranks. On port 1, each rank has its own points.
 *
 * @code
 * tracker->SetInputConnection(echoes->GetOutputPort(0));
 * for (int scan = 0; scan < 30; ++scan)
 *   tracker->UpdateTimeStep(2.0 * scan);
 * @endcode
 *
 * @sa vtkAvianLidarClutterFilter, vtkAvianLidarEchoFilter, vtkAvianLidarTracks
 */
#ifndef vtkAvianLidarTracker_h
#define vtkAvianLidarTracker_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkPolyData;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarTracker : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarTracker* New();
  vtkTypeMacro(vtkAvianLidarTracker, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum MotionModels
  {
    MOTION_CONSTANT_VELOCITY = 0,
    MOTION_COORDINATED_TURN = 1
  };

  /// Largest gap between points of a cluster, m, 0 to 1000; see also ClusterAngle. Default 1.5.
  vtkAvianLidarPropertyMacro(ClusterDistance, double, 1.5);

  /// Largest gap between points of a cluster as an angle at the sensor, deg, 0 to 20. Default 0.6.
  vtkAvianLidarPropertyMacro(ClusterAngle, double, 0.6);

  /// Standard error of ranges for points without `distance_std_error`, m, 0.001 to 1000. Default
  /// 0.5.
  vtkAvianLidarPropertyMacro(RangeError, double, 0.5);

  /// Half of the beam's divergence for clouds without the field data `half_beamwidth`, rad, 0 to 1.
  /// Default 0.0056.
  vtkAvianLidarPropertyMacro(HalfBeamwidth, double, 0.0056);

  /// Position of the sensor, m, for clouds without the field data `position`. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(SensorPosition, 3, 0.0, 0.0, 0.0);

  /// Rms distance of echoes from the target's centre along each axis, m, 0.001 to 1000. Default 0.2
  /// (assumed).
  vtkAvianLidarPropertyMacro(TargetExtent, double, 0.2);

  ///@{
  /// Model of the birds' motion between scans. Default MOTION_COORDINATED_TURN.
  vtkAvianLidarPropertyMacro(MotionModel, int, MOTION_COORDINATED_TURN);
  void SetMotionModelToConstantVelocity() { this->SetMotionModel(MOTION_CONSTANT_VELOCITY); }
  void SetMotionModelToCoordinatedTurn() { this->SetMotionModel(MOTION_COORDINATED_TURN); }
  ///@}

  /// Power spectral density of the acceleration, m2/s3, 0 to 1e6. Default 10.
  vtkAvianLidarPropertyMacro(AccelerationDensity, double, 10.0);

  /// Power spectral density of the turn rate's change, deg2/s3, 0 to 1e6. Default 40.
  vtkAvianLidarPropertyMacro(TurnRateDensity, double, 40.0);

  /// Largest speed over ground of a new track, m/s, 0.1 to 1000. Default 25 (assumed).
  vtkAvianLidarPropertyMacro(MaximumSpeed, double, 25.0);

  /// Largest rate of climb or descent of a new track, m/s, 0.1 to 1000. Default 5 (assumed).
  vtkAvianLidarPropertyMacro(MaximumClimbRate, double, 5.0);

  /// Largest turn rate of a new track, deg/s, 0 to 360. Default 40 (assumed).
  vtkAvianLidarPropertyMacro(MaximumTurnRate, double, 40.0);

  /// Probability that a track's own cluster lies in the gate (the region around the track's
  /// predicted position), 1, 0.5 to 0.999999. Default 0.99.
  vtkAvianLidarPropertyMacro(GateProbability, double, 0.99);

  /// Number of hits (scans with a cluster of the track) in the last ConfirmScans scans that confirm
  /// a track, 1 to ConfirmScans. Default 3.
  vtkAvianLidarPropertyMacro(ConfirmHits, int, 3);

  /// Number of the last scans in which ConfirmHits hits confirm a track, 1 to 32. Default 4.
  vtkAvianLidarPropertyMacro(ConfirmScans, int, 4);

  /// Least speed at which a track is confirmed, m/s, 0 to 1000. Default 0.
  vtkAvianLidarPropertyMacro(MinimumSpeed, double, 0.0);

  /// Number of successive scans without a cluster after which a confirmed track ends, 1 to 1000.
  /// Default 3.
  vtkAvianLidarPropertyMacro(MaximumMisses, int, 3);

  /// Time without a cluster after which any track ends, s, 0.001 to 1e9. Default 30.
  vtkAvianLidarPropertyMacro(MaximumPause, double, 30.0);

  /// Time for which an ended track is kept in the output, s, 0 to 1e9. Default 60.
  vtkAvianLidarPropertyMacro(KeepTime, double, 60.0);

  /// Largest number of positions in a track, 1 to 1,000,000. Default 200.
  vtkAvianLidarPropertyMacro(HistoryLength, int, 200);

  /// Empty the memory: the next cloud counts as the first cloud, and ids begin at 0.
  void Reset();

  /// Controller of the processes that may work together; null: this process works alone. Default:
  /// the global controller.
  vtkAvianLidarControllerMacro();

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarTracker();
  ~vtkAvianLidarTracker() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarTracker(const vtkAvianLidarTracker&) = delete;
  void operator=(const vtkAvianLidarTracker&) = delete;

  void CheckSettings() const;
  void FillOutputs(bool hasTracks, vtkPolyData* input, const int* trackOfPoint,
    vtkInformationVector* outputVector) const;

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
