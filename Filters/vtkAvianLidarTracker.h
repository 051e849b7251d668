// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarTracker
 * @brief Tracks of birds from point clouds that come one after the other.
 *
 * Each execution takes one cloud, a scan. Its points are grouped into clusters, each cluster goes
 * to at most one track, each track takes at most one cluster, and what remains begins new tracks.
 *
 * **Input** (port 0): vtkPolyData, a cloud: points in metres, whose vertices do not matter. Point
 * arrays, all optional, one component: `is_clutter` (points where it is not 0 are left out),
 * `timestamp` (us: when a point was measured; else all have the cloud's time), `distance_std_error`
 * (m, of the range; else RangeError). Field data, optional: `position` (m, of the sensor; wins over
 * SensorPosition), `half_beamwidth` (rad; wins over HalfBeamwidth).
 *
 * **Time** of a cloud, s: DATA_TIME_STEP of the input; else field data `TimeValue`; else the start
 * of its `revolution`; else that of the cloud before and 1, unless the data are the same, not
 * modified since. Steps of a revolution that sweeps have the time of its start. A cloud of the same
 * time as the last one replaces it, with the settings of now: nothing is counted twice. A cloud of
 * an earlier time empties the memory, with a warning. Clouds are whole scans: a track without a
 * cluster in a cloud was missed. Timestamps that do not lie after all of the cloud before
 * (timestamps that begin anew in each cloud) are not used, with a warning.
 *
 * **Output port 0** (vtkPolyData), the tracks: a polyline for each through its positions as
 * estimated, a vertex for one with a single position; first the tracks of one position, then the
 * others, by `track_id`. Point arrays: `time` (s), `velocity` (3, m/s; 0 at the first position,
 * when nothing is known), `position_covariance` (6, m2: xx, yy, zz, xy, yz, xz, as VTK's symmetric
 * tensors), `number_of_echoes` (int, points of the cluster). Cell arrays: `track_id` (int, from 0,
 * never used again until the memory is emptied), `confirmed`, `ended` (unsigned char), `hits` (int,
 * scans with a cluster).
 *
 * **Output port 1** (vtkPolyData): the input, with the point arrays `track_id` (int; -1: none) and
 * `track_confirmed` (unsigned char).
 *
 * Field data of both: `time` (s, of the cloud) and the settings in snake case.
 *
 * **Method.** *Clusters*: two points belong together if they are at most ClusterDistance +
 * ClusterAngle times their mean range apart; a cluster is whatever hangs together so. Its position
 * and time are the means. *Errors* of a position: along the line of sight RangeError; across it
 * that of a target that lies anywhere within the beam, half_beamwidth range / 2 along each axis; in
 * all directions TargetExtent; squares are added and divided by the number of points. *Motion*: a
 * Kalman filter of constant velocity with white noise acceleration, or an extended one of a
 * coordinated turn, whose horizontal velocity turns at an unknown rate (textbook forms: Y.
 * Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with Applications to Tracking and Navigation,
 * 2001). A new track's velocity is normal about 0, so wide that its gate reaches what MaximumSpeed
 * and MaximumClimbRate reach. *Gate*: a cluster may belong to a track if the square of its distance
 * from the predicted position, in standard deviations, d2, is at most the quantile GateProbability
 * of chi square of three degrees. *Assignment*: one to one, so that the sum of d2 + ln det S (S:
 * covariance of the difference; minus twice the log likelihood but for a constant) is least; a
 * track without a cluster costs the quantile and the largest ln det S of the scan, no less than any
 * pair. *Life*: a cluster of no track begins one. It is confirmed once ConfirmHits of its last
 * ConfirmScans scans had a cluster. Before, it ends after ConfirmScans - ConfirmHits + 1 misses in
 * a row and is forgotten; then after MaximumMisses, and stays in the output for KeepTime.
 *
 * **Limits.** Positions are means of echoes, which lie on the axes of beams. Two birds in one
 * cluster are one. A bird that crosses the azimuth where revolutions begin may be in one scan
 * twice: the second time begins a track. Memory holds the tracks of the last scans, at most
 * HistoryLength positions each, and those that ended within KeepTime.
 *
 * **Bad input**: settings beyond their range, points or arrays that are not finite or not numbers,
 * arrays without one value per point are an error with empty outputs; the memory is as before. An
 * empty cloud is a scan in which all tracks are missed.
 *
 * **Determinism**: the same bits for any order of the points. On several ranks, each of which has a
 * piece of the cloud, all know all points; rank 0 has the tracks, each its own points.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarTracks (which makes flights to be simulated)
 */
#ifndef vtkAvianLidarTracker_h
#define vtkAvianLidarTracker_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr
#include <string> // For messages

class vtkMultiProcessController;
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

  ///@{
  /**
   * Points of one cluster are at most so far apart: ClusterDistance, m (0 to 1000; default 1.5),
   * and ClusterAngle, deg (0 to 20; default 0.6, more than the diagonal of a grid of 0.375 deg),
   * times their range.
   */
  vtkSetMacro(ClusterDistance, double);
  vtkGetMacro(ClusterDistance, double);
  vtkSetMacro(ClusterAngle, double);
  vtkGetMacro(ClusterAngle, double);
  ///@}

  ///@{
  /**
   * The sensor, for clouds that do not say it: standard error of a range, m (0.001 to 1000; default
   * 0.5); half of the beam's divergence, rad (0 to 1; default 0.0056); position, m (default: the
   * origin).
   */
  vtkSetMacro(RangeError, double);
  vtkGetMacro(RangeError, double);
  vtkSetMacro(HalfBeamwidth, double);
  vtkGetMacro(HalfBeamwidth, double);
  vtkSetVector3Macro(SensorPosition, double);
  vtkGetVector3Macro(SensorPosition, double);
  ///@}

  ///@{
  /**
   * How far echoes lie from the middle of what they belong to, rms along each axis, m. 0.001 to
   * 1000; default 0.2 (assumed).
   */
  vtkSetMacro(TargetExtent, double);
  vtkGetMacro(TargetExtent, double);
  ///@}

  ///@{
  /**
   * How birds move between scans. Default MOTION_COORDINATED_TURN.
   */
  vtkSetMacro(MotionModel, int);
  vtkGetMacro(MotionModel, int);
  void SetMotionModelToConstantVelocity() { this->SetMotionModel(MOTION_CONSTANT_VELOCITY); }
  void SetMotionModelToCoordinatedTurn() { this->SetMotionModel(MOTION_COORDINATED_TURN); }
  ///@}

  ///@{
  /**
   * Power spectral density of the acceleration, m2/s3 (default 10): within t s each component of
   * the velocity changes by the root of this times t, rms. And of the turn rate, deg2/s3 (default
   * 40), of MOTION_COORDINATED_TURN. Both 0 to 1e6.
   */
  vtkSetMacro(AccelerationDensity, double);
  vtkGetMacro(AccelerationDensity, double);
  vtkSetMacro(TurnRateDensity, double);
  vtkGetMacro(TurnRateDensity, double);
  ///@}

  ///@{
  /**
   * What a new track may do: largest speed over ground, m/s (default 25), and climb or descent, m/s
   * (default 5), both 0.1 to 1000: how far its second cluster may be from the first; with
   * MOTION_COORDINATED_TURN largest turn rate, deg/s (0 to 360; default 40). Assumed.
   */
  vtkSetMacro(MaximumSpeed, double);
  vtkGetMacro(MaximumSpeed, double);
  vtkSetMacro(MaximumClimbRate, double);
  vtkGetMacro(MaximumClimbRate, double);
  vtkSetMacro(MaximumTurnRate, double);
  vtkGetMacro(MaximumTurnRate, double);
  ///@}

  ///@{
  /**
   * Share of a track's own clusters that its gate lets in. 0.5 to 0.999999; default 0.99.
   */
  vtkSetMacro(GateProbability, double);
  vtkGetMacro(GateProbability, double);
  ///@}

  ///@{
  /**
   * A track is confirmed once it had a cluster in ConfirmHits of its last ConfirmScans scans (both
   * 1 to 32, the first not above the second; default 3 of 4) and its speed is at least
   * MinimumSpeed, m/s (0 to 1000; default 0): what stands still, as leaves that a clutter filter
   * has left, is no bird on the wing.
   */
  vtkSetMacro(ConfirmHits, int);
  vtkGetMacro(ConfirmHits, int);
  vtkSetMacro(ConfirmScans, int);
  vtkGetMacro(ConfirmScans, int);
  vtkSetMacro(MinimumSpeed, double);
  vtkGetMacro(MinimumSpeed, double);
  ///@}

  ///@{
  /**
   * A confirmed track ends after MaximumMisses scans in a row without a cluster (1 to 1000; default
   * 3), any track once it had none for more than MaximumPause, s (0.001 to 1e9; default 30): what
   * is there after a pause of the data is another bird. It stays in the output for KeepTime, s on
   * the clock of the clouds (0 to 1e9; default 60), and keeps its last HistoryLength positions (1
   * to 1,000,000; default 200).
   */
  vtkSetMacro(MaximumMisses, int);
  vtkGetMacro(MaximumMisses, int);
  vtkSetMacro(MaximumPause, double);
  vtkGetMacro(MaximumPause, double);
  vtkSetMacro(KeepTime, double);
  vtkGetMacro(KeepTime, double);
  vtkSetMacro(HistoryLength, int);
  vtkGetMacro(HistoryLength, int);
  ///@}

  /**
   * Empty the memory: the next cloud is the first one, ids begin at 0.
   */
  void Reset();

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
  vtkAvianLidarTracker();
  ~vtkAvianLidarTracker() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  double ClusterDistance = 1.5;
  double ClusterAngle = 0.6;
  double RangeError = 0.5;
  double HalfBeamwidth = 0.0056;
  double TargetExtent = 0.2;
  double SensorPosition[3] = { 0.0, 0.0, 0.0 };
  int MotionModel = MOTION_COORDINATED_TURN;
  double AccelerationDensity = 10.0;
  double TurnRateDensity = 40.0;
  double MaximumSpeed = 25.0;
  double MaximumClimbRate = 5.0;
  double MaximumTurnRate = 40.0;
  double GateProbability = 0.99;
  int ConfirmHits = 3;
  int ConfirmScans = 4;
  double MinimumSpeed = 0.0;
  int MaximumMisses = 3;
  double MaximumPause = 30.0;
  int HistoryLength = 200;
  double KeepTime = 60.0;
  vtkMultiProcessController* Controller = nullptr;

private:
  vtkAvianLidarTracker(const vtkAvianLidarTracker&) = delete;
  void operator=(const vtkAvianLidarTracker&) = delete;

  std::string CheckSettings() const;
  void FillOutputs(bool hasTracks, vtkPolyData* input, const int* trackOfPoint,
    vtkInformationVector* outputVector) const;

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
