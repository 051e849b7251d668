// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTracker.h"

#include "Figures.h"
#include "Hash.h"
#include "Tracker.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarGather.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarScanStream.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkMultiProcessStream.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Vec3;

constexpr Arrays::Name HalfBeamwidthName{ "half_beamwidth", "rad" };
constexpr Arrays::Name SensorPositionName{ "sensor_position", "m" };
/// Prefix of errors.
constexpr char TrackerPrefix[] = "Tracker: ";
/// Largest coordinate of a point, m.
constexpr double LargestCoordinate = 1e9;

bool IsNear(const double place[3])
{
  return std::all_of(place, place + 3, [](double x) { return std::fabs(x) <= LargestCoordinate; });
}

/// Values that hold for a whole cloud.
struct CloudFacts
{
  vtkIdType Points = 0;
  double Time = 0.0;                    // time of the cloud, s
  double Sensor[3] = { 0.0, 0.0, 0.0 }; // position of the sensor, m
  double HalfBeamwidth = 0.0;           // half of the beam's divergence, rad
};

void ReadFacts(const vtkAvianLidarScanStream& stream, vtkPolyData* cloud, CloudFacts& facts)
{
  facts.Points = cloud->GetNumberOfPoints();
  facts.Time = stream.TimeOf(cloud);
  vtkAvianLidarScanStream::ReadPosition(cloud, facts.Sensor);
  vtkAvianLidarRequire(IsNear(facts.Sensor)
      ? ""
      : "field data 'position' is too far away, expected x, y and z up to 1e9 m");
  Arrays::ReadFieldValue(cloud->GetFieldData(), HalfBeamwidthName, facts.HalfBeamwidth);
  vtkAvianLidarRequire(avianlidar::rangeError(
    "field data 'half_beamwidth'", facts.HalfBeamwidth, 0.0, 1.0, "0 to 1 rad"));
}

/// Sets `facts` on all ranks to the facts of the first rank with points. @return number of points
/// of the ranks before this rank
vtkIdType Share(const vtkAvianLidarRanks& ranks, CloudFacts& facts)
{
  vtkMultiProcessStream mine;
  mine << static_cast<long long>(facts.Points) << facts.Time << facts.Sensor[0] << facts.Sensor[1]
       << facts.Sensor[2] << facts.HalfBeamwidth;
  const double own[] = { facts.Time, facts.Sensor[0], facts.Sensor[1], facts.Sensor[2],
    facts.HalfBeamwidth };
  const std::optional<std::uint64_t> known = facts.Points > 0
    ? std::optional<std::uint64_t>(avianlidar::hashOf(own, sizeof own, 0))
    : std::nullopt;
  vtkAvianLidarRequire(ranks.Same(known) ? ""
                                         : "the ranks have clouds of different times, positions or "
                                           "beam widths in field data, expected "
                                           "one scan");
  vtkIdType before = 0;
  bool isFirst = true;
  int rank = 0;
  for (vtkMultiProcessStream& stream : ranks.Gather(mine))
  {
    long long points = 0;
    CloudFacts read;
    stream >> points >> read.Time >> read.Sensor[0] >> read.Sensor[1] >> read.Sensor[2] >>
      read.HalfBeamwidth;
    before += rank++ < ranks.Rank() ? points : 0;
    if (isFirst && points > 0)
    {
      isFirst = false;
      facts = read;
    }
  }
  return before;
}

void CheckArrays(vtkPolyData* cloud)
{
  for (const Arrays::Name& name :
    { Arrays::IsClutter, Arrays::Timestamp, Arrays::DistanceStdError })
  {
    Arrays::RequireNumeric(cloud->GetPointData(), name, "point array");
    Arrays::RequireShape(
      cloud->GetPointData()->GetArray(name.name), "point array", 1, cloud->GetNumberOfPoints());
  }
}

/// Points that are not clutter.
struct Targets
{
  std::vector<avianlidar::CloudPoint> Points;
  std::vector<vtkIdType> Indices; // indices of the points in the cloud
  bool AreTimed = false;          // whether points have times; otherwise all times are 0
};

Targets ReadTargets(vtkPolyData* cloud, double rangeError)
{
  Targets targets;
  vtkPointData* arrays = cloud->GetPointData();
  vtkDataArray* clutter = arrays->GetArray(Arrays::IsClutter.name);
  vtkDataArray* times = arrays->GetArray(Arrays::Timestamp.name);
  vtkDataArray* errors = arrays->GetArray(Arrays::DistanceStdError.name);
  targets.AreTimed = times != nullptr;
  for (vtkIdType i = 0; i < cloud->GetNumberOfPoints(); ++i)
  {
    if (clutter && clutter->GetComponent(i, 0) != 0.0)
    {
      continue;
    }
    double p[3];
    cloud->GetPoint(i, p);
    const avianlidar::CloudPoint point{ { p[0], p[1], p[2] },
      times ? times->GetComponent(i, 0) / 1e6 : 0.0,
      errors ? errors->GetComponent(i, 0) : rangeError };
    if (!IsNear(p) || !std::isfinite(point.time) ||
      !(point.rangeError >= 0.0 && point.rangeError <= LargestCoordinate))
    {
      vtkAvianLidarRequire("point " + std::to_string(i) +
        ": its coordinates, 'timestamp' or 'distance_std_error' are not finite, expected "
        "coordinates up to 1e9 m and errors from 0 to 1e9 m");
    }
    targets.Points.push_back(point);
    targets.Indices.push_back(i);
  }
  return targets;
}

/// Adds tracks of one position first, because VTK puts vertices before lines.
void AddCells(const std::vector<avianlidar::Track>& tracks, vtkPolyData* output)
{
  const auto cells = static_cast<vtkIdType>(tracks.size());
  std::vector<const avianlidar::Track*> order;
  vtkIdType points = 0;
  for (const avianlidar::Track& track : tracks)
  {
    order.push_back(&track);
    points += static_cast<vtkIdType>(track.positions.size());
  }
  const vtkIdType vertices = std::stable_partition(order.begin(), order.end(),
                               [](const auto* track) { return track->positions.size() == 1; }) -
    order.begin();
  auto places = Arrays::MakePoints(points);
  auto times = Arrays::Make<vtkDoubleArray>(Arrays::Time, points);
  auto velocities = Arrays::Make<vtkDoubleArray>(Arrays::Velocity, points, 3);
  auto covariances = Arrays::Make<vtkDoubleArray>(Arrays::PositionCovariance, points, 6);
  auto echoes = Arrays::Make<vtkIntArray>(Arrays::NumberOfEchoes, points);
  auto ids = Arrays::Make<vtkIntArray>(Arrays::TrackId, cells);
  auto confirmed = Arrays::Make<vtkUnsignedCharArray>(Arrays::Confirmed, cells);
  auto ended = Arrays::Make<vtkUnsignedCharArray>(Arrays::Ended, cells);
  auto hits = Arrays::Make<vtkIntArray>(Arrays::Hits, cells);
  vtkNew<vtkTypeInt64Array> offsets; // offsets of the lines
  Arrays::SetTuples(offsets.Get(), cells - vertices + 1);
  vtkNew<vtkTypeInt64Array> pointsOfLines;
  Arrays::SetTuples(pointsOfLines.Get(), points - vertices);
  std::iota(pointsOfLines->GetPointer(0), pointsOfLines->GetPointer(points - vertices), vertices);
  offsets->SetValue(0, 0);
  vtkIdType point = 0;
  for (vtkIdType cell = 0; cell < cells; ++cell)
  {
    const avianlidar::Track& track = *order[static_cast<std::size_t>(cell)];
    for (const avianlidar::TrackPosition& position : track.positions)
    {
      places->SetPoint(point, &position.position[0]);
      times->SetValue(point, position.time);
      velocities->SetTypedTuple(point, &position.velocity[0]);
      covariances->SetTypedTuple(point, position.covariance.data());
      echoes->SetValue(point, position.echoes);
      ++point;
    }
    if (cell >= vertices)
    {
      offsets->SetValue(cell - vertices + 1, point - vertices);
    }
    ids->SetValue(cell, track.id);
    confirmed->SetValue(cell, track.confirmed);
    ended->SetValue(cell, track.ended);
    hits->SetValue(cell, track.hits);
  }
  output->SetPoints(places);
  output->SetVerts(vtkAvianLidarMakeCells(vertices, 1));
  vtkNew<vtkCellArray> lines;
  lines->SetData(offsets, pointsOfLines);
  output->SetLines(lines);
  for (vtkDataArray* array : std::vector<vtkDataArray*>{ times, velocities, covariances, echoes })
  {
    output->GetPointData()->AddArray(array);
  }
  for (vtkDataArray* array : std::vector<vtkDataArray*>{ ids, confirmed, ended, hits })
  {
    output->GetCellData()->AddArray(array);
  }
}
}

//------------------------------------------------------------------------------
struct vtkAvianLidarTracker::vtkInternals
{
  // A property that is a number.
  struct Setting
  {
    const char* Property;
    Arrays::Name Field;
    std::variant<double vtkAvianLidarTracker::*, int vtkAvianLidarTracker::*> Member;
    double Least;
    double Most;

    double ValueOf(const vtkAvianLidarTracker& tracker) const
    {
      return std::visit(
        [&](auto member) { return static_cast<double>(tracker.*member); }, this->Member);
    }
  };
  static const std::vector<Setting>& Settings();

  // State of the memory after a cloud.
  struct State
  {
    avianlidar::Tracker Tracker;
    vtkAvianLidarScanStream Stream;
    double LastPoint = 0.0; // latest time of a point, s
    bool HasWarned = false;
  };
  State Before;     // state before the last cloud
  State After;      // state after the last cloud
  CloudFacts Facts; // facts of the present cloud

  // Adds the clouds that were tracked before.
  void AddMemoryTo(vtkAvianLidarRanks::Settings& settings) const
  {
    const bool begun = this->After.Stream.Begun();
    settings.Add("time of the cloud before", begun ? this->After.Stream.Time() : -1e300);
    settings.Add("number of tracks", this->After.Tracker.tracks().size());
  }

  static avianlidar::TrackerSettings SettingsOf(const vtkAvianLidarTracker& self);
  // Updates the tracks. @return track of each point of the cloud, or -1
  std::vector<int> Track(vtkAvianLidarTracker* self, vtkPolyData* input, vtkPolyData* cloud,
    const vtkAvianLidarRanks& ranks);
};

//------------------------------------------------------------------------------
const std::vector<vtkAvianLidarTracker::vtkInternals::Setting>& vtkAvianLidarTracker::vtkInternals::
  Settings()
{
  using Self = vtkAvianLidarTracker;
  static const std::vector<Setting> all = { { "ClusterDistance", { "cluster_distance", "m" },
                                              &Self::ClusterDistance, 0.0, 1000.0 },
    { "ClusterAngle", { "cluster_angle", "deg" }, &Self::ClusterAngle, 0.0, 20.0 },
    { "RangeError", { "range_error", "m" }, &Self::RangeError, 0.001, 1000.0 },
    { "HalfBeamwidth", HalfBeamwidthName, &Self::HalfBeamwidth, 0.0, 1.0 },
    { "TargetExtent", { "target_extent", "m" }, &Self::TargetExtent, 0.001, 1000.0 },
    { "MotionModel", { "motion_model", "1" }, &Self::MotionModel, 0.0, 1.0 },
    { "AccelerationDensity", { "acceleration_density", "m2/s3" }, &Self::AccelerationDensity, 0.0,
      1e6 },
    { "TurnRateDensity", { "turn_rate_density", "deg2/s3" }, &Self::TurnRateDensity, 0.0, 1e6 },
    { "MaximumSpeed", { "maximum_speed", "m/s" }, &Self::MaximumSpeed, 0.1, 1000.0 },
    { "MaximumClimbRate", { "maximum_climb_rate", "m/s" }, &Self::MaximumClimbRate, 0.1, 1000.0 },
    { "MaximumTurnRate", { "maximum_turn_rate", "deg/s" }, &Self::MaximumTurnRate, 0.0, 360.0 },
    { "GateProbability", { "gate_probability", "1" }, &Self::GateProbability, 0.5, 0.999999 },
    { "ConfirmHits", { "confirm_hits", "1" }, &Self::ConfirmHits, 1.0, 32.0 },
    { "ConfirmScans", { "confirm_scans", "1" }, &Self::ConfirmScans, 1.0, 32.0 },
    { "MinimumSpeed", { "minimum_speed", "m/s" }, &Self::MinimumSpeed, 0.0, 1000.0 },
    { "MaximumMisses", { "maximum_misses", "1" }, &Self::MaximumMisses, 1.0, 1000.0 },
    { "MaximumPause", { "maximum_pause", "s" }, &Self::MaximumPause, 0.001, 1e9 },
    { "HistoryLength", { "history_length", "1" }, &Self::HistoryLength, 1.0, 1e6 },
    { "KeepTime", { "keep_time", "s" }, &Self::KeepTime, 0.0, 1e9 } };
  return all;
}

//------------------------------------------------------------------------------
avianlidar::TrackerSettings vtkAvianLidarTracker::vtkInternals::SettingsOf(
  const vtkAvianLidarTracker& self)
{
  constexpr double degree = avianlidar::RadiansPerDegree;
  avianlidar::TrackerSettings s;
  s.targetExtent = self.TargetExtent;
  s.gate = avianlidar::normalDistanceSquare(self.GateProbability);
  // The errors are chosen so that the gate of a new track covers the largest speed.
  s.motion.accelerationDensity = self.AccelerationDensity;
  s.motion.speedError = self.MaximumSpeed / std::sqrt(s.gate);
  s.motion.climbError = self.MaximumClimbRate / std::sqrt(s.gate);
  if (self.MotionModel == MOTION_COORDINATED_TURN)
  {
    s.motion.turnRateDensity = self.TurnRateDensity * degree * degree;
    s.motion.turnRateError = self.MaximumTurnRate * degree / std::sqrt(s.gate);
  }
  s.confirmHits = self.ConfirmHits;
  s.confirmScans = self.ConfirmScans;
  s.minimumSpeed = self.MinimumSpeed;
  s.maximumMisses = self.MaximumMisses;
  s.maximumPause = self.MaximumPause;
  s.historyLength = static_cast<std::size_t>(self.HistoryLength);
  s.keepTime = self.KeepTime;
  return s;
}

//------------------------------------------------------------------------------
std::vector<int> vtkAvianLidarTracker::vtkInternals::Track(vtkAvianLidarTracker* self,
  vtkPolyData* input, vtkPolyData* cloud, const vtkAvianLidarRanks& ranks)
{
  const CloudFacts& facts = this->Facts;
  Targets targets = ReadTargets(cloud, self->RangeError);
  const double time = facts.Time;
  const bool isFirst = !this->After.Stream.Begun();
  const bool isLater = !isFirst && time > this->After.Stream.Time();
  const bool isEarlier = !isFirst && time < this->After.Stream.Time();
  State next = isEarlier ? State{} : isLater ? this->After : this->Before;

  // The times of points are used if all times are later than the last cloud.
  const auto [least, most] = std::minmax_element(targets.Points.begin(), targets.Points.end(),
    [](const auto& a, const auto& b) { return a.time < b.time; });
  const bool hasTimes = targets.AreTimed && !targets.Points.empty();
  const bool goesOn = hasTimes && (!next.Stream.Begun() || least->time > next.LastPoint);
  const double last = goesOn ? most->time : time;
  if (!goesOn)
  {
    for (avianlidar::CloudPoint& point : targets.Points)
    {
      point.time = time;
    }
  }
  const bool areOdd = hasTimes && !goesOn && !next.HasWarned;
  next.LastPoint = targets.Points.empty() ? next.LastPoint : last;
  next.HasWarned = next.HasWarned || areOdd;
  next.Stream.Accept(input, time);

  avianlidar::TrackerSettings settings = SettingsOf(*self);
  settings.halfBeamwidth = facts.HalfBeamwidth;
  const Vec3 sensor(facts.Sensor[0], facts.Sensor[1], facts.Sensor[2]);
  const avianlidar::Clusters clusters = avianlidar::findClusters(targets.Points, sensor,
    self->ClusterDistance, self->ClusterAngle * avianlidar::RadiansPerDegree);
  vtkAvianLidarAbort::StopIfWanted(self);
  const std::vector<int> ids =
    next.Tracker.update(clusters.all, sensor, time, settings, vtkAvianLidarAbort::KeepGoing(self));
  std::vector<int> trackOfPoint(static_cast<std::size_t>(cloud->GetNumberOfPoints()), -1);
  for (std::size_t i = 0; i < targets.Indices.size(); ++i)
  {
    trackOfPoint[static_cast<std::size_t>(targets.Indices[i])] = ids[clusters.ofPoint[i]];
  }
  ranks.Meet(); // before the memory changes
  if (isLater || isEarlier)
  {
    this->Before = isLater ? std::move(this->After) : State{};
  }
  this->After = std::move(next);
  if (isEarlier && ranks.Rank() == 0)
  {
    vtkWarningWithObjectMacro(self,
      << "Tracker: the cloud has an earlier time than the cloud before: all tracks are removed.");
  }
  if (areOdd && ranks.Rank() == 0)
  {
    vtkWarningWithObjectMacro(self,
      << "Tracker: not all values of 'timestamp' are later than the times of the cloud before: the "
         "time of the cloud is used. Expected are whole scans with rising timestamps.");
  }
  return trackOfPoint;
}

vtkStandardNewMacro(vtkAvianLidarTracker);
vtkAvianLidarCxxControllerMacro(vtkAvianLidarTracker);

//------------------------------------------------------------------------------
vtkAvianLidarTracker::vtkAvianLidarTracker()
  : Internals(new vtkInternals)
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarTracker::~vtkAvianLidarTracker() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarTracker::Reset()
{
  *this->Internals = vtkInternals();
  this->Modified();
}

//------------------------------------------------------------------------------
int vtkAvianLidarTracker::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarTracker::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkAvianLidarRanks(this->Controller, request, outputVector).RequestPiece(inputVector[0]);
  return 1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarTracker::CheckSettings() const
{
  for (const vtkInternals::Setting& setting : vtkInternals::Settings())
  {
    std::ostringstream expected;
    expected << setting.Least << " to " << avianlidar::figures(setting.Most, 6) << " "
             << setting.Field.unit;
    vtkAvianLidarRequire(avianlidar::rangeError(
      setting.Property, setting.ValueOf(*this), setting.Least, setting.Most, expected.str()));
  }
  vtkAvianLidarRequire(IsNear(this->SensorPosition)
      ? ""
      : "SensorPosition has a number that is not finite or beyond 1e9, expected metres");
  vtkAvianLidarRequire(avianlidar::rangeError(
    "ConfirmHits", this->ConfirmHits, 1, this->ConfirmScans, "at most ConfirmScans"));
}

//------------------------------------------------------------------------------
int vtkAvianLidarTracker::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks)
    {
      vtkPolyData* input = vtkPolyData::GetData(inputVector[0]);
      CloudFacts& facts = this->Internals->Facts;
      facts = {};
      std::copy(this->SensorPosition, this->SensorPosition + 3, facts.Sensor);
      facts.HalfBeamwidth = this->HalfBeamwidth;
      vtkAvianLidarWithin(TrackerPrefix,
        [&]()
        {
          this->CheckSettings();
          ReadFacts(this->Internals->After.Stream, input, facts);
          CheckArrays(input);
        });
      vtkAvianLidarRanks::Settings settings;
      for (const vtkInternals::Setting& setting : vtkInternals::Settings())
      {
        settings.Add(setting.Property, setting.ValueOf(*this));
      }
      for (const double coordinate : this->SensorPosition)
      {
        settings.Add("SensorPosition", coordinate);
      }
      this->Internals->AddMemoryTo(settings);
      ranks.AgreeOn(settings);
      const vtkIdType first = Share(ranks, facts); // first point of this rank
      const vtkSmartPointer<vtkPolyData> cloud = vtkAvianLidarGather::Points(ranks, input);
      const std::vector<int> trackOfPoint = vtkAvianLidarWithin(
        TrackerPrefix, [&]() { return this->Internals->Track(this, input, cloud, ranks); });
      const bool isOther = ranks.Alone() && ranks.Piece() > 0;
      this->FillOutputs(
        ranks.Piece() == 0, input, isOther ? nullptr : trackOfPoint.data() + first, outputVector);
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarTracker::FillOutputs(bool hasTracks, vtkPolyData* input, const int* trackOfPoint,
  vtkInformationVector* outputVector) const
{
  const CloudFacts& facts = this->Internals->Facts;
  vtkPolyData* tracks = vtkPolyData::GetData(outputVector, 0);
  vtkPolyData* points = vtkPolyData::GetData(outputVector, 1);
  std::map<int, bool> isConfirmed;
  for (const avianlidar::Track& track : this->Internals->After.Tracker.tracks())
  {
    isConfirmed[track.id] = track.confirmed;
  }
  if (hasTracks)
  {
    AddCells(this->Internals->After.Tracker.tracks(), tracks);
  }
  points->GetFieldData()->ShallowCopy(input->GetFieldData());
  if (trackOfPoint)
  {
    points->ShallowCopy(input);
    const vtkIdType size = input->GetNumberOfPoints();
    auto ids = Arrays::Make<vtkIntArray>(Arrays::TrackId, size);
    auto confirmed = Arrays::Make<vtkUnsignedCharArray>(Arrays::TrackConfirmed, size);
    for (vtkIdType i = 0; i < size; ++i)
    {
      ids->SetValue(i, trackOfPoint[i]);
      confirmed->SetValue(i, trackOfPoint[i] >= 0 && isConfirmed[trackOfPoint[i]]);
    }
    points->GetPointData()->AddArray(ids);
    points->GetPointData()->AddArray(confirmed);
  }
  const double time = this->Internals->After.Stream.Time();
  for (vtkPolyData* output : { tracks, points })
  {
    vtkFieldData* fields = output->GetFieldData();
    for (const vtkInternals::Setting& setting : vtkInternals::Settings())
    {
      std::holds_alternative<int vtkAvianLidarTracker::*>(setting.Member)
        ? Arrays::SetFieldInteger(fields, setting.Field, static_cast<int>(setting.ValueOf(*this)))
        : Arrays::SetFieldValue(fields, setting.Field, setting.ValueOf(*this));
    }
    Arrays::SetFieldValue(fields, HalfBeamwidthName, facts.HalfBeamwidth);
    Arrays::SetFieldValue(fields, Arrays::Time, time);
    Arrays::SetFieldVector(fields, SensorPositionName, facts.Sensor);
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarTracker::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  os << indent << "Controller: " << this->Controller << "\n";
  for (const vtkInternals::Setting& setting : vtkInternals::Settings())
  {
    os << indent << setting.Property << ": " << setting.ValueOf(*this) << " " << setting.Field.unit
       << "\n";
  }
  os << indent << "SensorPosition: " << this->SensorPosition[0] << " " << this->SensorPosition[1]
     << " " << this->SensorPosition[2] << "\n";
}
