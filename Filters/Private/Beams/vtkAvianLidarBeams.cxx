// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBeams.h"

#include "Hash.h"
#include "Scan.h"
#include "ScanPattern.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarIdRuns.h"

#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeUInt64Array.h"

#include <cmath>
#include <optional>
#include <utility>

namespace
{
using avianlidar::Vec3;

/// What is up for the sensor, if its beams are not round and say its orientation.
std::string ReadUp(vtkFieldData* fields, avianlidar::Sensor& sensor)
{
  const char* const name = vtkAvianLidarArrays::Orientation.name;
  if (sensor.hasRoundBeam() || !fields || !fields->GetAbstractArray(name))
  {
    return {};
  }
  vtkDataArray* angles = fields->GetArray(name);
  std::string wrong = vtkAvianLidarArrays::CheckShape(angles, "field data", 3, 1);
  if (wrong.empty())
  {
    Vec3 a;
    angles->GetTuple(0, &a.x);
    wrong = avianlidar::isFinite(a) ? std::string()
                                    : std::string("field data '") + name +
        "' is not finite, expected yaw, pitch and roll in degrees";
    sensor.up = avianlidar::upOf(a.x, a.y, a.z);
  }
  return wrong;
}

std::string ReadSensor(vtkFieldData* fields, avianlidar::Sensor& sensor)
{
  const auto missing = [](const char* name)
  {
    return std::string("field data '") + name +
      "' is missing or not a finite number; expected one value" +
      " (vtkAvianLidarBeamSource writes it)";
  };
  using avianlidar::NeededOf;
  const auto readNumbers = [&](NeededOf of) -> std::string
  {
    for (const avianlidar::SensorField& field : avianlidar::sensorFields())
    {
      const bool isThere = fields && fields->GetAbstractArray(field.name);
      if (field.neededOf == of && (isThere || of != NeededOf::None) &&
        !vtkAvianLidarArrays::GetFieldValue(
          fields, { field.name, field.unit }, sensor.*field.member))
      {
        return missing(field.name);
      }
    }
    return {};
  };
  std::string wrong = readNumbers(NeededOf::All);
  if (!wrong.empty())
  {
    return wrong;
  }
  wrong = readNumbers(NeededOf::None);
  if (!wrong.empty())
  {
    return wrong;
  }
  double profile = 0.0;
  if (!vtkAvianLidarArrays::GetFieldValue(fields, vtkAvianLidarArrays::BeamProfile, profile))
  {
    return missing(vtkAvianLidarArrays::BeamProfile.name);
  }
  if (profile != 0.0 && profile != 1.0)
  {
    return "field data 'beam_profile' is neither 0 (uniform) nor 1 (Gaussian)";
  }
  sensor.beamProfile =
    profile == 0.0 ? avianlidar::BeamProfile::Uniform : avianlidar::BeamProfile::Gaussian;
  double outline = 0.0; // of beams that do not say: round
  wrong = vtkAvianLidarArrays::ReadFieldValue(fields, vtkAvianLidarArrays::BeamOutline, outline);
  if (!wrong.empty() || (outline != 0.0 && outline != 1.0))
  {
    return wrong.empty() ? "field data 'beam_outline' is neither 0 (ellipse) nor 1 (rectangle)"
                         : wrong;
  }
  sensor.beamOutline = static_cast<avianlidar::BeamOutline>(static_cast<int>(outline));
  wrong = ReadUp(fields, sensor);
  if (!wrong.empty())
  {
    return wrong;
  }
  double model = 0.0; // of beams that do not say: the paper's
  wrong = vtkAvianLidarArrays::ReadFieldValue(fields, vtkAvianLidarArrays::ReceiverModel, model);
  if (!wrong.empty() || (model != 0.0 && model != 1.0))
  {
    return wrong.empty()
      ? "field data 'receiver_model' is neither 0 (energy limits) nor 1 (photons)"
      : wrong;
  }
  sensor.receiverModel = static_cast<avianlidar::ReceiverModel>(static_cast<int>(model));
  double law = 1.0; // of beams that do not say
  wrong = vtkAvianLidarArrays::ReadFieldValue(fields, vtkAvianLidarArrays::ThresholdLaw, law);
  if (!wrong.empty() || (law != 0.0 && law != 1.0))
  {
    return wrong.empty() ? "field data 'threshold_law' is neither 0 (fixed) nor 1 (follows the air)"
                         : wrong;
  }
  sensor.thresholdLaw = static_cast<avianlidar::ThresholdLaw>(static_cast<int>(law));
  if (sensor.receiverModel == avianlidar::ReceiverModel::Photons)
  {
    wrong = readNumbers(NeededOf::Photons);
    if (!wrong.empty())
    {
      return wrong;
    }
  }
  wrong = avianlidar::checkSensor(sensor);
  return wrong.empty() ? wrong : "field data: " + wrong;
}

/// The length of rays to look at, if the beams say it.
std::string ReadDisplayLength(vtkFieldData* fields, double& length)
{
  std::string wrong =
    vtkAvianLidarArrays::ReadFieldValue(fields, vtkAvianLidarArrays::DisplayLength, length);
  if (!wrong.empty())
  {
    return wrong;
  }
  wrong = avianlidar::checkDisplayLength(length);
  return wrong.empty() ? wrong : "field data: " + wrong;
}

/// The number of the revolution, if the beams say it.
std::string ReadRevolution(vtkFieldData* fields, std::int32_t& revolution)
{
  if (!fields || !fields->GetAbstractArray(vtkAvianLidarArrays::Revolution.name))
  {
    return {};
  }
  const std::string shape = vtkAvianLidarArrays::CheckShape(
    fields->GetArray(vtkAvianLidarArrays::Revolution.name), "field data", 1, 1);
  if (!shape.empty())
  {
    return shape;
  }
  double value = 0.0;
  const bool number =
    vtkAvianLidarArrays::GetFieldValue(fields, vtkAvianLidarArrays::Revolution, value);
  if (!number || !vtkAvianLidarArrays::IsInt(value))
  {
    return "field data 'revolution' is not a whole number from -2^31 to 2^31 - 1";
  }
  revolution = static_cast<std::int32_t>(value);
  return {};
}

/// An optional point array of one component; an error if it is of another kind.
std::string FindScalar(
  vtkPolyData* input, const vtkAvianLidarArrays::Name& name, vtkDataArray*& array)
{
  array = input->GetPointData()->GetArray(name.name);
  const std::string text =
    vtkAvianLidarArrays::CheckNumeric(input->GetPointData(), name, "point array");
  return text.empty()
    ? vtkAvianLidarArrays::CheckShape(array, "point array", 1, input->GetNumberOfPoints())
    : text;
}

/// The same; an error if a value is not finite or, with `whole`, not a whole number that fits an
/// int.
std::string FindNumbers(
  vtkPolyData* input, const vtkAvianLidarArrays::Name& name, bool whole, vtkDataArray*& array)
{
  const std::string wrong = FindScalar(input, name, array);
  for (vtkIdType i = 0; wrong.empty() && array && i < input->GetNumberOfPoints(); ++i)
  {
    const double value = array->GetComponent(i, 0);
    if (!(whole ? vtkAvianLidarArrays::IsInt(value) : std::isfinite(value)))
    {
      return "beam " + std::to_string(i) + ": point array '" + name.name +
        (whole ? "' is not a whole number of 32 bits" : "' is not finite");
    }
  }
  return wrong;
}

/// Unit vectors of an array of directions. Where it is missing: an error if it is `needed`, else
/// none.
std::string ReadDirections(vtkPolyData* input, const vtkAvianLidarArrays::Name& name, bool needed,
  std::vector<Vec3>& directions)
{
  const std::string array = std::string("point array '") + name.name + "'";
  vtkDataArray* given = input->GetPointData()->GetArray(name.name);
  std::string wrong = vtkAvianLidarArrays::CheckNumeric(input->GetPointData(), name, "point array");
  if (wrong.empty() && needed && !given)
  {
    return array +
      " is missing, expected 3 numbers per beam, as in the output Beams of a beam source (in "
      "ParaView: Edit > Change Input > Beams)";
  }
  const vtkIdType count = input->GetNumberOfPoints();
  wrong = wrong.empty() ? vtkAvianLidarArrays::CheckShape(given, "point array", 3, count) : wrong;
  for (vtkIdType i = 0; wrong.empty() && given && i < count; ++i)
  {
    Vec3 d;
    given->GetTuple(i, &d.x);
    const bool zero = d.x == 0.0 && d.y == 0.0 && d.z == 0.0;
    if (zero || !avianlidar::isFinite(d))
    {
      return "beam " + std::to_string(i) + ": " + array + (zero ? " is zero" : " is not finite") +
        ", expected any length above 0";
    }
    directions.push_back(avianlidar::unitVector(d));
  }
  return wrong;
}

std::string ReadOrigins(vtkPolyData* input, avianlidar::ScanBeams& beams)
{
  for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
  {
    Vec3 p;
    input->GetPoint(i, &p.x);
    const std::string wrong = avianlidar::checkPosition(p);
    if (!wrong.empty())
    {
      return "beam " + std::to_string(i) + ": " + wrong;
    }
    beams.origins.push_back(p);
  }
  return {};
}

std::string ReadIds(vtkPolyData* input, avianlidar::ScanBeams& beams)
{
  vtkDataArray* ids = nullptr;
  const std::string shape = FindScalar(input, vtkAvianLidarArrays::BeamId, ids);
  if (!shape.empty())
  {
    return shape;
  }
  const vtkIdType count = input->GetNumberOfPoints();
  beams.ids.resize(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const double id = ids ? ids->GetComponent(i, 0) : static_cast<double>(i);
    if (!(id >= 0.0) || id > 9007199254740992.0 || id != std::floor(id))
    {
      return "beam " + std::to_string(i) +
        ": point array 'beam_id' is not a whole number from 0 to 2^53";
    }
    beams.ids[i] = static_cast<std::uint64_t>(id);
  }
  return vtkAvianLidarRepeatedIdError(vtkAvianLidarRunsOf(beams.ids));
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
  return avianlidar::hashOf(values.data(), values.size() * sizeof(double), 0);
}

/// Hash of all that is read for each beam.
std::uint64_t HashOf(vtkPolyData* input)
{
  vtkPoints* points = input->GetPoints();
  std::uint64_t hash = vtkAvianLidarContent::HashOf(points ? points->GetData() : nullptr, 0);
  for (const auto& array : { vtkAvianLidarArrays::Direction, vtkAvianLidarArrays::ReportedDirection,
         vtkAvianLidarArrays::BeamId, vtkAvianLidarArrays::LaserId, vtkAvianLidarArrays::Azimuth,
         vtkAvianLidarArrays::VerticalAngle, vtkAvianLidarArrays::Timestamp })
  {
    vtkAbstractArray* any = input->GetPointData()->GetAbstractArray(array.name);
    const std::int64_t type = any ? any->GetDataType() : -1; // text is another state than none
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
  return azimuth < 36000.0 ? azimuth : 0.0; // a tiny negative angle rounds to a full circle
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeams::ElevationOf(const Vec3& d)
{
  return std::atan2(d.z, std::hypot(d.x, d.y)) * 180.0 / avianlidar::Pi;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::Read(vtkPolyData* input)
{
  const vtkAvianLidarContent::State state = vtkAvianLidarContent::StateOf(input);
  const bool untouched = !state.empty() && state == this->ReadFrom;
  const std::uint64_t content = untouched ? this->Content : HashOf(input);
  const bool known = !this->ReadFrom.empty() && content == this->Content;
  if (!known || input->GetNumberOfPoints() == 0)
  {
    *this = vtkAvianLidarBeams{};
    this->problem = this->ReadBeams(input);
    this->beams.checksum = avianlidar::checksumOf(this->beams);
    this->Content = content;
  }
  avianlidar::Sensor read;
  const std::string wrong = ReadSensor(input->GetFieldData(), read);
  if (input->GetNumberOfPoints() == 0)
  {
    // No beams on this piece: nothing to check, nothing to say.
    this->sensor = wrong.empty() ? read : avianlidar::Sensor{};
    return;
  }
  this->sensor = read;
  this->problem = this->problem.empty() ? wrong : this->problem;
  this->displayLength = vtkAvianLidarBeams{}.displayLength;
  const std::string badLength = ReadDisplayLength(input->GetFieldData(), this->displayLength);
  this->problem = this->problem.empty() ? badLength : this->problem;
  this->revolution = 0;
  const std::string badRevolution = ReadRevolution(input->GetFieldData(), this->revolution);
  this->problem = this->problem.empty() ? badRevolution : this->problem;
  this->ReadFrom = this->problem.empty() ? state : vtkAvianLidarContent::State{};
}

//------------------------------------------------------------------------------
std::uint64_t vtkAvianLidarBeams::Hash() const
{
  const std::uint64_t parts[] = { this->beams.checksum, HashOf(this->sensor, this->revolution) };
  return avianlidar::hashOf(parts, sizeof(parts), 0);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::CheckRanks(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  const std::function<std::string(const std::string&)>& inputError)
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
  if (!oneSensor)
  {
    ranks.Together(self,
      [&]()
      {
        return inputError("the ranks have beams of different sensors or revolutions in field data, "
                          "expected those of one");
      });
  }
  else if (!checked)
  {
    this->CompareIds(ranks, self, inputError);
  }
  this->checkedWith = ranks.Group();
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeams::CompareIds(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  const std::function<std::string(const std::string&)>& inputError) const
{
  vtkNew<vtkTypeUInt64Array> mine;
  ranks.Together(self,
    [&]()
    {
      for (const vtkAvianLidarIdRun& run : vtkAvianLidarRunsOf(this->beams.ids))
      {
        mine->InsertNextValue(run.first);
        mine->InsertNextValue(run.count);
      }
    });
  vtkNew<vtkTypeUInt64Array> all;
  ranks.Gather(mine, all);
  ranks.Together(self,
    [&]()
    {
      std::vector<vtkAvianLidarIdRun> runs;
      for (vtkIdType i = 0; i < all->GetNumberOfValues(); i += 2)
      {
        runs.push_back({ all->GetValue(i), all->GetValue(i + 1) });
      }
      return inputError(vtkAvianLidarRepeatedIdError(std::move(runs)));
    });
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeams::ReadBeams(vtkPolyData* input)
{
  vtkDataArray* laser = nullptr;
  vtkDataArray* azimuth = nullptr;
  vtkDataArray* vertical = nullptr;
  vtkDataArray* timestamp = nullptr;
  const vtkIdType count = input->GetNumberOfPoints();
  if (count == 0)
  {
    return {};
  }
  for (const std::string& wrong :
    { ReadDirections(input, vtkAvianLidarArrays::Direction, true, this->beams.directions),
      ReadOrigins(input, this->beams),
      ReadDirections(
        input, vtkAvianLidarArrays::ReportedDirection, false, this->reportedDirections),
      ReadIds(input, this->beams), FindNumbers(input, vtkAvianLidarArrays::LaserId, true, laser),
      FindNumbers(input, vtkAvianLidarArrays::Azimuth, false, azimuth),
      FindNumbers(input, vtkAvianLidarArrays::VerticalAngle, false, vertical),
      FindNumbers(input, vtkAvianLidarArrays::Timestamp, false, timestamp) })
  {
    if (!wrong.empty())
    {
      return wrong;
    }
  }
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
  return {};
}
