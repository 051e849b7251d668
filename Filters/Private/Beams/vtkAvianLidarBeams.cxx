// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBeams.h"

#include "Hash.h"
#include "ScanPattern.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRequire.h"

#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeUInt64Array.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Vec3;

/// Prefix of all errors.
constexpr char BeamsPort[] = "Input port 0 (beams), ";

[[noreturn]] void FailAt(vtkIdType beam, const std::string& what)
{
  throw std::runtime_error("beam " + std::to_string(beam) + ": " + what);
}

/// Read the sensor's up direction from field data `orientation`, if the beams are not round.
void ReadUp(vtkFieldData* fields, avianlidar::Sensor& sensor)
{
  const char* const name = Arrays::Orientation.name;
  if (sensor.hasRoundBeam() || !fields || !fields->GetAbstractArray(name))
  {
    return;
  }
  Arrays::RequireNumeric(fields, Arrays::Orientation, "field data");
  vtkDataArray* angles = fields->GetArray(name);
  Arrays::RequireShape(angles, "field data", 3, 1);
  Vec3 a;
  angles->GetTuple(0, &a.x);
  if (!avianlidar::isFinite(a))
  {
    throw std::runtime_error(std::string("field data '") + name +
      "' is not finite, expected yaw, pitch and roll in degrees");
  }
  sensor.up = avianlidar::rotationOf(a.x, a.y, a.z)[2];
}

/// Read one of two choices. Without the array, `choice` is kept. @param words meaning of 0 and of 1
template <class Choice>
void ReadChoice(vtkFieldData* fields, const Arrays::Name& name, const std::string& words,
  Choice& choice, double most = 1.0)
{
  double value = static_cast<double>(choice);
  Arrays::ReadFieldValue(fields, name, value);
  if (value < 0.0 || value > most || value != std::floor(value))
  {
    throw std::runtime_error(std::string("field data '") + name.name + "' is neither " + words);
  }
  choice = static_cast<Choice>(static_cast<int>(value));
}

/// Read the samples of the pulse.
void ReadPulse(vtkFieldData* fields, avianlidar::Sensor& sensor)
{
  vtkDataArray* arrays[2];
  int place = 0;
  for (const Arrays::Name& name : { Arrays::PulseTimes, Arrays::PulsePowers })
  {
    Arrays::RequireNumeric(fields, name, "field data");
    arrays[place] = fields->GetArray(name.name);
    vtkAvianLidarRequire(arrays[place] ? ""
                                       : std::string("field data '") + name.name +
          "' is missing, expected one number for each sample of the pulse");
    Arrays::RequireShape(arrays[place++], "field data", 1, arrays[0]->GetNumberOfTuples());
  }
  for (vtkIdType i = 0; i < arrays[0]->GetNumberOfTuples(); ++i)
  {
    sensor.pulseSamples.push_back(arrays[0]->GetComponent(i, 0));
    sensor.pulseSamples.push_back(arrays[1]->GetComponent(i, 0));
  }
}

avianlidar::Sensor ReadSensor(vtkFieldData* fields)
{
  using avianlidar::NeededOf;
  avianlidar::Sensor sensor;
  const auto require = [](bool isThere, const char* name)
  {
    vtkAvianLidarRequire(isThere ? ""
                                 : std::string("field data '") + name +
          "' is missing or not a finite number; expected one value"
          " (vtkAvianLidarBeamSource writes it)");
  };
  const auto readNumbers = [&](NeededOf of)
  {
    for (const avianlidar::SensorField& field : avianlidar::sensorFields())
    {
      const bool isThere = fields && fields->GetAbstractArray(field.name);
      if (field.neededOf == of && (isThere || of != NeededOf::None))
      {
        require(Arrays::GetFieldValue(fields, { field.name, field.unit }, sensor.*field.member),
          field.name);
      }
    }
  };
  readNumbers(NeededOf::All);
  readNumbers(NeededOf::None);
  double profile = 0.0;
  require(Arrays::GetFieldValue(fields, Arrays::BeamProfile, profile), Arrays::BeamProfile.name);
  ReadChoice(fields, Arrays::BeamProfile, "0 (uniform) nor 1 (Gaussian)", sensor.beamProfile);
  ReadChoice(fields, Arrays::BeamOutline, "0 (ellipse) nor 1 (rectangle)", sensor.beamOutline);
  ReadUp(fields, sensor);
  ReadChoice(
    fields, Arrays::ReceiverModel, "0 (energy limits) nor 1 (photons)", sensor.receiverModel);
  ReadChoice(
    fields, Arrays::ThresholdLaw, "0 (fixed) nor 1 (follows the air)", sensor.thresholdLaw);
  if (sensor.receiverModel == avianlidar::ReceiverModel::Photons)
  {
    readNumbers(NeededOf::Photons);
  }
  ReadChoice(fields, Arrays::PulseShape, "0 (rectangle) nor 1 (Gaussian) nor 2 (samples)",
    sensor.pulseShape, 2.0);
  if (sensor.pulseShape == avianlidar::PulseShape::Samples)
  {
    ReadPulse(fields, sensor);
  }
  vtkAvianLidarRequire(avianlidar::checkSensor(sensor), "field data: ");
  return sensor;
}

/// Number of the revolution; 0 without field data `revolution`.
std::int32_t ReadRevolution(vtkFieldData* fields)
{
  double value = 0.0;
  if (fields && fields->GetAbstractArray(Arrays::Revolution.name))
  {
    Arrays::RequireShape(fields->GetArray(Arrays::Revolution.name), "field data", 1, 1);
    if (!Arrays::GetFieldValue(fields, Arrays::Revolution, value) || !Arrays::IsInt(value))
    {
      throw std::runtime_error(
        "field data 'revolution' is not a whole number from -2^31 to 2^31 - 1");
    }
  }
  return static_cast<std::int32_t>(value);
}

/// An optional point array of one component.
vtkDataArray* FindScalar(vtkPolyData* input, const Arrays::Name& name)
{
  Arrays::RequireNumeric(input->GetPointData(), name, "point array");
  vtkDataArray* array = input->GetPointData()->GetArray(name.name);
  Arrays::RequireShape(array, "point array", 1, input->GetNumberOfPoints());
  return array;
}

/// An optional point array of one component. Throws unless all values are finite or, if `whole`,
/// whole numbers that an int holds.
vtkDataArray* FindNumbers(vtkPolyData* input, const Arrays::Name& name, bool whole)
{
  vtkDataArray* array = FindScalar(input, name);
  for (vtkIdType i = 0; array && i < input->GetNumberOfPoints(); ++i)
  {
    const double value = array->GetComponent(i, 0);
    if (!(whole ? Arrays::IsInt(value) : std::isfinite(value)))
    {
      FailAt(i,
        std::string("point array '") + name.name +
          (whole ? "' is not a whole number of 32 bits" : "' is not finite"));
    }
  }
  return array;
}

/// Unit vectors of an array of directions; empty if the array is missing and not `needed`.
std::vector<Vec3> ReadDirections(vtkPolyData* input, const Arrays::Name& name, bool needed)
{
  const std::string array = std::string("point array '") + name.name + "'";
  vtkDataArray* given = input->GetPointData()->GetArray(name.name);
  Arrays::RequireNumeric(input->GetPointData(), name, "point array");
  if (needed && !given)
  {
    throw std::runtime_error(array +
      " is missing, expected 3 numbers per beam, as in the output Beams of a beam source (in "
      "ParaView: Edit > Change Input > Beams)");
  }
  const vtkIdType count = input->GetNumberOfPoints();
  Arrays::RequireShape(given, "point array", 3, count);
  std::vector<Vec3> directions;
  for (vtkIdType i = 0; given && i < count; ++i)
  {
    Vec3 d;
    given->GetTuple(i, &d.x);
    const bool zero = d.x == 0.0 && d.y == 0.0 && d.z == 0.0;
    if (zero || !avianlidar::isFinite(d))
    {
      FailAt(i, array + (zero ? " is zero" : " is not finite") + ", expected any length above 0");
    }
    directions.push_back(avianlidar::unitVector(d));
  }
  return directions;
}

/// An optional point array of several components.
template <std::size_t Size>
std::vector<std::array<double, Size>> ReadTuples(vtkPolyData* input, const Arrays::Name& name)
{
  vtkDataArray* given = input->GetPointData()->GetArray(name.name);
  Arrays::RequireNumeric(input->GetPointData(), name, "point array");
  Arrays::RequireShape(given, "point array", Size, input->GetNumberOfPoints());
  std::vector<std::array<double, Size>> tuples(given ? given->GetNumberOfTuples() : 0);
  for (std::size_t i = 0; i < tuples.size(); ++i)
  {
    given->GetTuple(static_cast<vtkIdType>(i), tuples[i].data());
  }
  return tuples;
}

void ReadOrigins(vtkPolyData* input, avianlidar::ScanBeams& beams)
{
  for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
  {
    Vec3 p;
    input->GetPoint(i, &p.x);
    const std::string wrong = avianlidar::checkPosition(p);
    if (!wrong.empty())
    {
      FailAt(i, wrong);
    }
    beams.origins.push_back(p);
  }
}

/// A run of `count` consecutive ids, from `first` on. The ids of a sensor's beams are one run. The
/// ids of the columns of one rank are a few runs.
struct IdRun
{
  std::uint64_t first;
  std::uint64_t count;
};

/// Ascending runs of ids. The ids may have any order. An id that occurs twice begins a new run.
std::vector<IdRun> RunsOf(std::vector<std::uint64_t> ids)
{
  std::sort(ids.begin(), ids.end());
  std::vector<IdRun> runs;
  for (const std::uint64_t id : ids)
  {
    if (runs.empty() || id != runs.back().first + runs.back().count)
    {
      runs.push_back({ id, 0 });
    }
    ++runs.back().count;
  }
  return runs;
}

/// An error text if an id is in two of the runs, else an empty string.
std::string RepeatedIdError(std::vector<IdRun> runs)
{
  std::sort(
    runs.begin(), runs.end(), [](const IdRun& a, const IdRun& b) { return a.first < b.first; });
  const auto twice = std::adjacent_find(runs.begin(), runs.end(),
    [](const IdRun& a, const IdRun& b) { return b.first < a.first + a.count; });
  return twice == runs.end() ? std::string()
                             : "point array 'beam_id' holds " + std::to_string((twice + 1)->first) +
      " twice; expected the beams of one sensor (use one echo filter for each sensor instead of "
      "appending beams)";
}

void ReadIds(vtkPolyData* input, avianlidar::ScanBeams& beams)
{
  vtkDataArray* ids = FindScalar(input, Arrays::BeamId);
  for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
  {
    const double id = ids ? ids->GetComponent(i, 0) : static_cast<double>(i);
    if (!(id >= 0.0) || id > 9007199254740992.0 || id != std::floor(id))
    {
      FailAt(i, "point array 'beam_id' is not a whole number from 0 to 2^53");
    }
    beams.ids.push_back(static_cast<std::uint64_t>(id));
  }
  vtkAvianLidarRequire(RepeatedIdError(RunsOf(beams.ids)));
}

std::uint64_t HashOf(const avianlidar::Sensor& sensor, std::int32_t revolution)
{
  std::vector<double> values = { static_cast<double>(sensor.beamProfile),
    static_cast<double>(sensor.beamOutline), sensor.up.x, sensor.up.y, sensor.up.z,
    static_cast<double>(sensor.receiverModel), static_cast<double>(sensor.thresholdLaw),
    static_cast<double>(revolution) };
  for (const avianlidar::SensorField& field : avianlidar::sensorFields())
  {
    values.push_back(sensor.*field.member);
  }
  values.push_back(static_cast<double>(sensor.pulseShape));
  values.insert(values.end(), sensor.pulseSamples.begin(), sensor.pulseSamples.end());
  return avianlidar::hashOf(values.data(), values.size() * sizeof(double), 0);
}

/// Hash of everything that is read for each beam, except the origin.
std::uint64_t HashOf(vtkPolyData* input)
{
  std::uint64_t hash = 0;
  for (const auto& array : { Arrays::Direction, Arrays::ReportedDirection, Arrays::BeamId,
         Arrays::LaserId, Arrays::Azimuth, Arrays::VerticalAngle, Arrays::Timestamp,
         Arrays::SensorPosition, Arrays::SensorOrientation })
  {
    vtkAbstractArray* any = input->GetPointData()->GetAbstractArray(array.name);
    const std::int64_t type = any ? any->GetDataType() : -1; // an array of text changes the hash
    hash = vtkAvianLidarContent::HashOf(
      vtkDataArray::SafeDownCast(any), avianlidar::hashOf(&type, sizeof(type), hash));
  }
  return hash;
}
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeams::AzimuthOf(const Vec3& d)
{
  const double degrees = std::atan2(d.x, d.y) * 180.0 / avianlidar::Pi;
  const double azimuth = 100.0 * (degrees < 0.0 ? degrees + 360.0 : degrees);
  return azimuth < 36000.0 ? azimuth : 0.0; // a tiny negative angle is rounded to a full circle
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeams::ElevationOf(const Vec3& d)
{
  return std::atan2(d.z, std::hypot(d.x, d.y)) * 180.0 / avianlidar::Pi;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::Read(vtkPolyData* input)
{
  vtkAvianLidarWithin(BeamsPort, [&]() { this->ReadAll(input); });
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::ReadAll(vtkPolyData* input)
{
  const bool isEmpty = input->GetNumberOfPoints() == 0;
  const vtkAvianLidarContent::State state = vtkAvianLidarContent::StateOf(input);
  const bool untouched = state == this->ReadFrom;
  vtkPoints* points = input->GetPoints();
  const std::uint64_t origins = untouched
    ? this->Origins
    : vtkAvianLidarContent::HashOf(points ? points->GetData() : nullptr, 0);
  const std::uint64_t content = untouched ? this->Content : HashOf(input);
  const bool known = !this->ReadFrom.empty() && content == this->Content &&
    static_cast<std::size_t>(input->GetNumberOfPoints()) == this->beams.size();
  this->ReadFrom.clear(); // empty after an error
  if (!known || isEmpty)
  {
    *this = vtkAvianLidarBeams{};
    this->ReadBeams(input);
  }
  else if (origins != this->Origins) // a sensor that only moves is read faster
  {
    this->beams.origins.clear();
    ReadOrigins(input, this->beams);
  }
  if (!known || isEmpty || origins != this->Origins)
  {
    this->beams.checksum = avianlidar::checksumOf(this->beams);
    this->Content = content;
    this->Origins = origins;
  }
  try
  {
    this->sensor = ReadSensor(input->GetFieldData());
  }
  catch (const std::runtime_error&)
  {
    if (!isEmpty)
    {
      throw;
    }
    this->sensor = {}; // a piece without beams needs no sensor
  }
  if (!isEmpty)
  {
    this->displayLength = vtkAvianLidarBeams{}.displayLength;
    Arrays::ReadFieldValue(input->GetFieldData(), Arrays::DisplayLength, this->displayLength);
    vtkAvianLidarRequire(avianlidar::checkDisplayLength(this->displayLength), "field data: ");
    this->revolution = ReadRevolution(input->GetFieldData());
    this->ReadFrom = state;
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::RequireTimes(const std::string& what) const
{
  vtkAvianLidarRequire(this->isTimed || this->beams.size() == 0
      ? ""
      : "point array 'timestamp' is missing, expected the time in microseconds at which each beam "
        "meets " +
        what,
    BeamsPort);
}

//------------------------------------------------------------------------------
std::uint64_t vtkAvianLidarBeams::Hash() const
{
  const std::uint64_t parts[] = { this->beams.checksum, HashOf(this->sensor, this->revolution) };
  return avianlidar::hashOf(parts, sizeof(parts), 0);
}

//------------------------------------------------------------------------------
std::uint64_t vtkAvianLidarBeams::HashOfAll() const
{
  const std::uint64_t parts[] = { this->Hash(), this->Content, this->Origins };
  return avianlidar::hashOf(parts, sizeof(parts), 0);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::CheckRanks(const vtkAvianLidarRanks& ranks)
{
  const std::vector<std::uint64_t>& ids = this->beams.ids;
  this->total = static_cast<std::uint64_t>(ranks.Sum(static_cast<double>(ids.size())));
  if (ranks.Alone())
  {
    return;
  }
  std::optional<std::uint64_t> mine;
  if (!ids.empty())
  {
    mine = HashOf(this->sensor, this->revolution);
  }
  const bool oneSensor = ranks.Same(mine);
  const bool checked = ranks.All(this->checkedWith == ranks.Group());
  vtkAvianLidarRequire(oneSensor ? ""
                                 : "the ranks have beams of different sensors or revolutions "
                                   "in field data, expected those of one",
    BeamsPort);
  if (!checked)
  {
    this->CompareIds(ranks);
  }
  this->checkedWith = ranks.Group();
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::CompareIds(const vtkAvianLidarRanks& ranks) const
{
  vtkNew<vtkTypeUInt64Array> mine;
  for (const IdRun& run : RunsOf(this->beams.ids))
  {
    mine->InsertNextValue(run.first);
    mine->InsertNextValue(run.count);
  }
  vtkNew<vtkTypeUInt64Array> all;
  ranks.Gather(mine, all);
  std::vector<IdRun> runs;
  for (vtkIdType i = 0; i < all->GetNumberOfValues(); i += 2)
  {
    runs.push_back({ all->GetValue(i), all->GetValue(i + 1) });
  }
  vtkAvianLidarRequire(RepeatedIdError(std::move(runs)), BeamsPort);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::ReadBeams(vtkPolyData* input)
{
  const vtkIdType count = input->GetNumberOfPoints();
  if (count == 0)
  {
    return;
  }
  this->beams.directions = ReadDirections(input, Arrays::Direction, true);
  ReadOrigins(input, this->beams);
  this->reportedDirections = ReadDirections(input, Arrays::ReportedDirection, false);
  this->sensorPositions = ReadTuples<3>(input, Arrays::SensorPosition);
  this->sensorOrientations = ReadTuples<4>(input, Arrays::SensorOrientation);
  ReadIds(input, this->beams);
  vtkDataArray* laser = FindNumbers(input, Arrays::LaserId, true);
  vtkDataArray* azimuth = FindNumbers(input, Arrays::Azimuth, false);
  vtkDataArray* vertical = FindNumbers(input, Arrays::VerticalAngle, false);
  vtkDataArray* timestamp = FindNumbers(input, Arrays::Timestamp, false);
  this->isTimed = timestamp != nullptr;
  for (vtkIdType i = 0; i < count; ++i)
  {
    const Vec3& d = this->ReportedDirection(static_cast<std::size_t>(i));
    this->laserIds.push_back(laser ? static_cast<int>(laser->GetComponent(i, 0)) : 0);
    this->azimuths.push_back(azimuth ? azimuth->GetComponent(i, 0) : AzimuthOf(d));
    this->verticalAngles.push_back(vertical ? vertical->GetComponent(i, 0) : ElevationOf(d));
    this->timestamps.push_back(timestamp ? timestamp->GetComponent(i, 0) : 0.0);
    this->beams.times.push_back(1e-6 * this->timestamps.back());
  }
}
