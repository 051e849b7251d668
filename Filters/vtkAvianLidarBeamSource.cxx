// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBeamSource.h"

#include "Air.h"
#include "AvailableMemory.h"
#include "Figures.h"
#include "PhotonReceiver.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBeamSourceInternals.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanArrays.h"
#include "vtkAvianLidarScanShape.h"
#include "vtkAvianLidarText.h"
#include "vtkAvianLidarTrajectory.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// Length of a lever arm from which on it is probably a place in the scene, m.
constexpr double LongestLeverArm = 50.0;

// The requested piece. A piece that does not exist has no columns.
avianlidar::ScanPart PieceOf(vtkInformation* asked)
{
  avianlidar::ScanPart part;
  if (asked->Has(Pipeline::UPDATE_PIECE_NUMBER()) &&
    asked->Has(Pipeline::UPDATE_NUMBER_OF_PIECES()))
  {
    part.piece = asked->Get(Pipeline::UPDATE_PIECE_NUMBER());
    part.pieces = asked->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
  }
  if (part.piece < 0 || part.pieces < 1 || part.piece >= part.pieces)
  {
    part.piece = VTK_INT_MAX;
    part.pieces = VTK_INT_MAX;
  }
  return part;
}

// Errors of the kernel name values as the field data do, such as "range_gate is 0". The names of
// the properties have the same words, such as "RangeGate is 0".
std::string NameProperties(const std::string& error)
{
  std::string result;
  std::size_t begin = 0;
  while (begin < error.size())
  {
    const std::size_t end = std::min(error.find(' ', begin), error.size());
    std::string word = error.substr(begin, end - begin);
    if (word[0] == '(' && word.find('_') != std::string::npos)
    {
      result += '(';
      word.erase(0, 1);
    }
    bool capital = begin == 0 || word.find('_') != std::string::npos;
    for (const char c : word)
    {
      if (c != '_')
      {
        result += capital ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      }
      capital = c == '_';
    }
    result += end < error.size() ? " " : "";
    begin = end + 1;
  }
  return result;
}
}

vtkStandardNewMacro(vtkAvianLidarBeamSource);

//------------------------------------------------------------------------------
vtkAvianLidarBeamSource::vtkAvianLidarBeamSource()
{
  this->SetNumberOfInputPorts(1);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Set(INPUT_IS_OPTIONAL(), 1);
  return 1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::TakeProperties(const vtkAvianLidarBeamSource& preset)
{
  bool changed = false;
  const auto take = [&changed](auto& member, const auto& value)
  {
    changed = changed || member != value;
    member = value;
  };
  for (int i = 0; i < 3; ++i)
  {
    take(this->Position[i], preset.Position[i]);
    take(this->Orientation[i], preset.Orientation[i]);
  }
  take(this->AzimuthRange[0], preset.AzimuthRange[0]);
  take(this->AzimuthRange[1], preset.AzimuthRange[1]);
  take(this->NumberOfRevolutions, preset.NumberOfRevolutions);
  take(this->StepsPerRevolution, preset.StepsPerRevolution);
  take(this->MotionSeed, preset.MotionSeed);
  take(this->Assumed, preset.Assumed);
  take(this->Description, preset.Description);
  take(this->PulseFileName, preset.PulseFileName);
  take(this->Table, preset.Table);
  for (const vtkInternals::Scalar& scalar : vtkInternals::Scalars())
  {
    take(this->*scalar.property, preset.*scalar.property);
  }
  for (const auto& [name, integer] : vtkInternals::Integers())
  {
    take(this->*integer, preset.*integer);
  }
  for (const auto& [name, table] : vtkInternals::Tables())
  {
    take(this->*table, preset.*table);
  }
  if (changed)
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::TakePreset(const char* name)
{
  vtkNew<vtkAvianLidarBeamSource> preset;
  vtkInternals::ApplyPreset(name, *preset);
  this->TakeProperties(*preset);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetTablesOfPreset(const char* name)
{
  vtkNew<vtkAvianLidarBeamSource> preset;
  try
  {
    if (name && *name)
    {
      vtkInternals::ApplyPreset(name, *preset);
    }
  }
  catch (const std::out_of_range&)
  {
    vtkErrorMacro("TablesOfPreset is \"" << name
                                         << "\", expected the name of a built-in sensor, "
                                            "such as OS1_64.");
    return;
  }
  for (const auto& [array, table] : vtkInternals::Tables())
  {
    const bool ofPulse = table == &vtkAvianLidarBeamSource::PulseTimes ||
      table == &vtkAvianLidarBeamSource::PulsePowers;
    if (table != &vtkAvianLidarBeamSource::ChannelElevations && !ofPulse)
    {
      this->*table = preset->*table;
    }
  }
  this->PrismAxisElevation = preset->PrismAxisElevation;
  this->PrismAxisRotationRate = preset->PrismAxisRotationRate;
  this->PrismLaserRotationRate = preset->PrismLaserRotationRate;
  this->Assumed = preset->Assumed;
  this->Description = preset->Description;
  this->Modified();
}

//------------------------------------------------------------------------------
bool vtkAvianLidarBeamSource::IsGood(const char* what, const std::string& error)
{
  if (!error.empty())
  {
    vtkErrorMacro("" << what << ": " << vtkAvianLidarText(error) << ".");
  }
  return error.empty();
}

//------------------------------------------------------------------------------
bool vtkAvianLidarBeamSource::LoadSensor(const char* fileName)
{
  return this->IsGood("LoadSensor", this->ReadSensor(fileName, false));
}

//------------------------------------------------------------------------------
bool vtkAvianLidarBeamSource::LoadSensorText(const char* text)
{
  return this->IsGood("LoadSensorText",
    this->TakeFile(
      [text]() { return vtkAvianLidarSensorFile::OfText(text ? text : "", "the text"); }, false));
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::ReadSensor(const char* fileName, bool keepPlace)
{
  return this->TakeFile(
    [fileName]() { return vtkAvianLidarSensorFile::Read(fileName ? fileName : ""); }, keepPlace);
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::TakeFile(
  const std::function<vtkAvianLidarSensorFile()>& read, bool keepPlace)
{
  return vtkAvianLidarGuard::ProblemOf(
    [&]()
    {
      vtkNew<vtkAvianLidarBeamSource> loaded;
      if (keepPlace)
      {
        loaded->SetPosition(this->Position);
        loaded->SetOrientation(this->Orientation);
        loaded->SetNumberOfRevolutions(this->NumberOfRevolutions);
        loaded->SetStepsPerRevolution(this->StepsPerRevolution);
        loaded->SetMotionSeed(this->MotionSeed);
      }
      const vtkAvianLidarSensorFile file = read();
      vtkInternals::Apply(file, *loaded);
      vtkAvianLidarWithin(file.file + ": ", [&]() { vtkInternals::RequireProperties(*loaded); });
      this->TakeProperties(*loaded);
    });
}

//------------------------------------------------------------------------------
bool vtkAvianLidarBeamSource::SetBeams(vtkPolyData* beams)
{
  const auto table = beams ? std::make_shared<vtkBeamTable>() : nullptr;
  const auto read = [&]()
  {
    if (beams)
    {
      vtkInternals::ReadTable(beams, *table);
    }
  };
  if (!this->IsGood("SetBeams", vtkAvianLidarGuard::ProblemOf(read)))
  {
    return false;
  }
  this->Table = table;
  this->Modified();
  return true;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetNumberOfChannelElevations(int number)
{
  if (number < 0)
  {
    vtkErrorMacro("NumberOfChannelElevations is " << number << ", expected at least 0.");
    return;
  }
  if (number == this->GetNumberOfChannelElevations())
  {
    return;
  }
  try
  {
    // Memory of the table and of its copies in an execution.
    avianlidar::requireMemory(number, "channel elevations", 4.0 * sizeof(double) * number);
    this->ChannelElevations.resize(number, 0.0);
    this->Modified();
  }
  catch (const std::exception& error)
  {
    vtkErrorMacro("NumberOfChannelElevations is not changed: " << error.what() << ".");
  }
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::GetNumberOfPrisms() const
{
  return static_cast<int>(this->PrismWedgeAngles.size());
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::GetNumberOfChannelElevations() const
{
  return static_cast<int>(this->ChannelElevations.size());
}

//------------------------------------------------------------------------------
bool vtkAvianLidarBeamSource::HasChannelElevation(int index)
{
  const bool has = index >= 0 && index < this->GetNumberOfChannelElevations();
  if (!has)
  {
    vtkErrorMacro("ChannelElevation has no entry " << index << ", expected an index below the "
                                                   << this->GetNumberOfChannelElevations()
                                                   << " of NumberOfChannelElevations.");
  }
  return has;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetChannelElevation(int index, double elevation)
{
  if (this->HasChannelElevation(index) && this->ChannelElevations[index] != elevation)
  {
    this->ChannelElevations[index] = elevation;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeamSource::GetChannelElevation(int index)
{
  return this->HasChannelElevation(index) ? this->ChannelElevations[index] : 0.0;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetWavelength(double nanometres)
{
  if (nanometres != this->GetWavelength())
  {
    this->SetFrequency(avianlidar::SpeedOfLight / (1e-9 * nanometres));
  }
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeamSource::GetWavelength()
{
  return vtkInternals::WavelengthOf(*this);
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeamSource::GetUnambiguousRange()
{
  return avianlidar::unambiguousRange(avianlidar::pulseInterval(vtkInternals::PatternOf(*this)));
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeamSource::GetClearAirAttenuation()
{
  return avianlidar::attenuationOfVisibility(
    avianlidar::ClearVisibility, 1e-9 * this->GetWavelength());
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetLimitsFromDataSheet(double range, double reflectance)
{
  this->SetLimitsFromDataSheet(range, reflectance, this->GetClearAirAttenuation());
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetLimitsFromDataSheet(
  double range, double reflectance, double attenuation)
{
  avianlidar::Sensor sensor;
  const auto find = [&]()
  {
    vtkInternals::RequireProperties(*this);
    sensor = vtkInternals::SensorOf(*this);
    vtkAvianLidarRequire(NameProperties(
      avianlidar::setDataSheetLimits(sensor, range, reflectance, attenuation, this->DynamicRange)));
  };
  if (this->IsGood("SetLimitsFromDataSheet", vtkAvianLidarGuard::ProblemOf(find)))
  {
    this->SetLowerEnergyLimit(sensor.lowerEnergyLimit);
    this->SetUpperEnergyLimit(sensor.upperEnergyLimit);
  }
}

//------------------------------------------------------------------------------
avianlidar::Sensor vtkAvianLidarBeamSource::vtkInternals::SensorOf(const Source& self)
{
  avianlidar::Sensor sensor;
  for (const Scalar& scalar : Scalars())
  {
    if (scalar.sensor)
    {
      sensor.*scalar.sensor = self.*scalar.property;
    }
  }
  sensor.beamOutline = static_cast<avianlidar::BeamOutline>(self.BeamOutline);
  sensor.beamProfile = static_cast<avianlidar::BeamProfile>(self.BeamProfile);
  sensor.receiverModel = static_cast<avianlidar::ReceiverModel>(self.ReceiverModel);
  sensor.pulseShape = static_cast<avianlidar::PulseShape>(self.PulseShape);
  if (sensor.pulseShape == avianlidar::PulseShape::Samples)
  {
    sensor.pulseSamples = PulseOf(self);
  }
  sensor.thresholdLaw = static_cast<avianlidar::ThresholdLaw>(self.ThresholdLaw);
  std::string error = avianlidar::checkSensor(sensor);
  if (error.rfind("frequency is", 0) == 0)
  {
    error += " (" +
      avianlidar::valueError(
        "Wavelength", WavelengthOf(self), "the nanometres of such a frequency") +
      ")";
  }
  const bool ofFile = error.rfind("pulse_samples", 0) == 0 && !self.PulseFileName.empty();
  vtkAvianLidarRequire(
    NameProperties(error), ofFile ? ("PulseFileName " + self.PulseFileName + ": ").c_str() : "");
  vtkAvianLidarRequire(
    NameProperties(avianlidar::checkPhotonLimits(self.FalseAlarmsPerScan, self.DynamicRange)));
  if (sensor.receiverModel == avianlidar::ReceiverModel::Photons)
  {
    vtkAvianLidarRequire(NameProperties(avianlidar::setPhotonLimits(sensor, self.FalseAlarmsPerScan,
      self.DynamicRange, static_cast<double>(avianlidar::numberOfFirings(PatternOf(self))))));
  }
  return sensor;
}

//------------------------------------------------------------------------------
avianlidar::ScanPattern vtkAvianLidarBeamSource::vtkInternals::PatternOf(const Source& self)
{
  avianlidar::ScanPattern pattern;
  pattern.yaw = self.Orientation[0];
  pattern.pitch = self.Orientation[1];
  pattern.roll = self.Orientation[2];
  pattern.channels = self.NumberOfChannels;
  pattern.minimumElevation = self.MinimumElevation;
  pattern.elevationStep = self.ElevationStep;
  pattern.elevations = self.ChannelElevations;
  pattern.azimuthOffsets = self.ChannelAzimuthOffsets;
  pattern.firingTimes = self.ChannelFiringTimes;
  pattern.blankedSectors = self.BlankedSectors;
  pattern.prisms.wedgeAngles = self.PrismWedgeAngles;
  pattern.prisms.refractiveIndices = self.PrismRefractiveIndices;
  pattern.prisms.rotationRates = self.PrismRotationRates;
  pattern.prisms.phases = self.PrismPhases;
  pattern.prisms.axisElevation = self.PrismAxisElevation;
  pattern.prisms.axisRotationRate = self.PrismAxisRotationRate;
  pattern.prisms.laserRotationRate = self.PrismLaserRotationRate;
  pattern.azimuthStart = self.AzimuthRange[0];
  pattern.azimuthEnd = self.AzimuthRange[1];
  pattern.azimuthStep = self.AzimuthStep;
  pattern.rotationRate = self.RotationRate;
  pattern.firingInterval = self.FiringInterval;
  pattern.table = self.Table;
  return pattern;
}

//------------------------------------------------------------------------------
avianlidar::ScanClock vtkAvianLidarBeamSource::vtkInternals::ClockOf(const Source& self)
{
  avianlidar::ScanClock clock;
  clock.rotationRate = self.RotationRate;
  clock.revolutions = self.NumberOfRevolutions;
  clock.steps = self.StepsPerRevolution;
  return clock;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::vtkInternals::FindMoment(
  const Source& self, vtkInformation* asked, avianlidar::ScanPart& part, int& revolution)
{
  if (asked->Has(Pipeline::UPDATE_TIME_STEP())) // without a time: whole revolution 0
  {
    avianlidar::ScanMoment moment;
    vtkAvianLidarRequire(
      avianlidar::momentAt(ClockOf(self), asked->Get(Pipeline::UPDATE_TIME_STEP()), moment));
    revolution = moment.revolution;
    part.step = moment.step;
    part.steps = self.StepsPerRevolution;
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::vtkInternals::RequireProperties(const Source& self)
{
  vtkAvianLidarRequire(NameProperties(
    avianlidar::checkPosition({ self.Position[0], self.Position[1], self.Position[2] })));
  vtkAvianLidarRequire(NameProperties(avianlidar::checkDisplayLength(self.DisplayLength)));
  vtkAvianLidarRequire(avianlidar::checkPattern(PatternOf(self)));
  vtkAvianLidarRequire(avianlidar::checkPointing(PointingOf(self)));
  if (self.GetNumberOfPrisms() > 0 && !self.Table && self.EncoderJitter != 0.0)
  {
    vtkAvianLidarRequire(avianlidar::valueError("EncoderJitter", self.EncoderJitter,
      "0 with prisms, whose beams have no columns by azimuth"));
  }
  vtkAvianLidarRequire(avianlidar::checkClock(ClockOf(self), PatternOf(self)));
  SensorOf(self);
}

//------------------------------------------------------------------------------
const avianlidar::Poses& vtkAvianLidarBeamSource::vtkInternals::TrajectoryOf(
  Source& self, vtkInformationVector* input, int revolution)
{
  static const avianlidar::Poses none;
  if (input->GetNumberOfInformationObjects() == 0)
  {
    return none;
  }
  vtkPolyData* const data = vtkPolyData::GetData(input);
  if (!self.Trajectory || self.Trajectory->input != data ||
    self.Trajectory->time != data->GetMTime())
  {
    self.Trajectory.reset();
    auto read = std::make_shared<vtkTrajectory>();
    *read = { data, data->GetMTime(), vtkAvianLidarTrajectory::Read(data) };
    self.Trajectory = read;
  }
  const avianlidar::Poses& poses = self.Trajectory->poses;
  const double begin = revolution / self.RotationRate;
  const double end = begin + avianlidar::durationOf(PatternOf(self));
  if (begin < poses.front().time || end > poses.back().time)
  {
    const auto figures = [](double value) { return avianlidar::figures(value, 12); };
    vtkAvianLidarRequire("Input port 0 (trajectory), its poses are from " +
      figures(poses.front().time) + " to " + figures(poses.back().time) +
      " s, but the beams of revolution " + std::to_string(revolution) + " are from " +
      figures(begin) + " to " + figures(end) + " s: expected poses at all these times");
  }
  return poses;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::vtkInternals::WarningOnLeverArm(const Source& self)
{
  const double arm =
    avianlidar::safeLength({ self.Position[0], self.Position[1], self.Position[2] });
  return arm > LongestLeverArm ? "Position is " + avianlidar::figures(arm, 4) +
      " m from the origin of the platform, in whose frame it is with a trajectory"
                               : std::string();
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::vtkInternals::AddSensor(
  const Source& self, int revolution, const avianlidar::Pose& pose, vtkFieldData* fields)
{
  double position[3];
  double orientation[3];
  vtkAvianLidarTrajectory::Place(pose, self.Position, self.Orientation, position, orientation);
  Arrays::SetFieldVector(fields, Arrays::Position, position, 3);
  Arrays::SetFieldVector(fields, Arrays::Orientation, orientation, 3);
  if (!self.Table)
  {
    Arrays::SetFieldInteger(
      fields, Arrays::NumberOfChannels, avianlidar::numberOfChannels(PatternOf(self)));
    for (const auto& [name, table] : Tables())
    {
      const bool ofPulse = table == &Source::PulseTimes || table == &Source::PulsePowers;
      if (!ofPulse && !(self.*table).empty())
      {
        fields->AddArray(Arrays::MakeOf<vtkDoubleArray>(name, self.*table));
      }
    }
    if (self.GetNumberOfPrisms() == 0)
    {
      Arrays::SetFieldVector(fields, Arrays::AzimuthRange, self.AzimuthRange, 2);
    }
  }
  Arrays::SetFieldInteger(fields, Arrays::BeamOutline, self.BeamOutline);
  Arrays::SetFieldInteger(fields, Arrays::BeamProfile, self.BeamProfile);
  Arrays::SetFieldInteger(fields, Arrays::NumberOfRevolutions, self.NumberOfRevolutions);
  Arrays::SetFieldInteger(fields, Arrays::StepsPerRevolution, self.StepsPerRevolution);
  Arrays::SetFieldInteger(fields, Arrays::Revolution, revolution);
  Arrays::SetFieldInteger(fields, Arrays::ReceiverModel, self.ReceiverModel);
  Arrays::SetFieldInteger(fields, Arrays::ThresholdLaw, self.ThresholdLaw);
  Arrays::SetFieldValue(fields, Arrays::Wavelength, WavelengthOf(self));
  for (const Scalar& scalar : Scalars())
  {
    if ((!scalar.onlyWith || self.*scalar.onlyWith != 0.0) && !IsUnused(self, scalar.name))
    {
      Arrays::SetFieldValue(fields, scalar.name, self.*scalar.property);
    }
  }
  if (!PointingOf(self).none())
  {
    Arrays::SetFieldInteger(fields, Arrays::MotionSeed, self.MotionSeed);
  }
  if (self.ReceiverModel == RECEIVER_MODEL_PHOTONS || !self.Assumed.empty())
  {
    Arrays::SetFieldStrings(fields, Arrays::Assumed, AssumedOf(self));
  }
  const avianlidar::Sensor sensor = SensorOf(self);
  if (self.PulseShape != PULSE_SHAPE_RECTANGLE)
  {
    Arrays::SetFieldInteger(fields, Arrays::PulseShape, self.PulseShape);
  }
  if (!sensor.pulseSamples.empty())
  {
    std::vector<double> halves[2];
    for (std::size_t i = 0; i < sensor.pulseSamples.size(); ++i)
    {
      halves[i % 2].push_back(sensor.pulseSamples[i]);
    }
    fields->AddArray(Arrays::MakeOf<vtkDoubleArray>(Arrays::PulseTimes, halves[0]));
    fields->AddArray(Arrays::MakeOf<vtkDoubleArray>(Arrays::PulsePowers, halves[1]));
  }
  Arrays::SetFieldValue(fields, Arrays::LowerEnergyLimit, sensor.lowerEnergyLimit);
  Arrays::SetFieldValue(fields, Arrays::UpperEnergyLimit, sensor.upperEnergyLimit);
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    vtkInformation* outInfo = outputVector->GetInformationObject(port);
    outInfo->Set(CAN_HANDLE_PIECE_REQUEST(), 1);
    vtkAvianLidarRevolutions::Publish(vtkInternals::ClockOf(*this), outInfo);
    vtkAvianLidarScanShape::Publish(vtkInternals::PatternOf(*this), outInfo);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  if (vtkInformation* trajectory = inputVector[0]->GetInformationObject(0))
  {
    trajectory->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0); // each piece of the scan needs all poses
    trajectory->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    trajectory->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      // The piece and the time requested from one output apply to both outputs, as in VTK's
      // executive.
      vtkInformation* asked = vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      avianlidar::ScanPart part = PieceOf(asked);
      int revolution = 0;
      const avianlidar::Poses* poses = nullptr;
      vtkAvianLidarWithin("Beam source: ",
        [&]()
        {
          vtkInternals::RequireProperties(*this);
          const double full = 2000.0 * this->HalfBeamwidth;
          if (this->BeamwidthMilliradians != 0.0 &&
            !(std::abs(this->BeamwidthMilliradians - full) <= 1e-9 * full))
          {
            vtkAvianLidarRequire(
              avianlidar::valueError("BeamwidthMilliradians", this->BeamwidthMilliradians,
                "2000 times HalfBeamwidth (set both properties, or load the plugin in ParaView's "
                "client, too, which then sets both properties)"));
          }
          vtkInternals::FindMoment(*this, asked, part, revolution);
          poses = &vtkInternals::TrajectoryOf(*this, inputVector[0], revolution);
        });
      vtkPolyData* beams = vtkPolyData::GetData(outputVector, 0);
      vtkPolyData* rays = vtkPolyData::GetData(outputVector, 1);
      vtkAvianLidarScanArrays::FillBeams(vtkInternals::PatternOf(*this),
        vtkInternals::PointingOf(*this), part, revolution, this->Position, beams);
      avianlidar::Pose pose; // at the start of the revolution
      if (!poses->empty())
      {
        vtkAvianLidarTrajectory::Carry(*poses, this->Position, this->Orientation, beams);
        avianlidar::poseAt(*poses, revolution / this->RotationRate, pose);
      }
      vtkAvianLidarScanArrays::FillRays(beams, this->DisplayLength, rays);
      vtkInternals::AddSensor(*this, revolution, pose, beams->GetFieldData());
      vtkInternals::AddSensor(*this, revolution, pose, rays->GetFieldData());
      const avianlidar::Sensor sensor = vtkInternals::SensorOf(*this);
      std::string warning;
      const std::string arm =
        poses->empty() ? std::string() : vtkInternals::WarningOnLeverArm(*this);
      for (const std::string& one : { arm, avianlidar::warningOnElectrons(sensor),
             avianlidar::warningOnAmbiguity(
               sensor, avianlidar::pulseInterval(vtkInternals::PatternOf(*this))) })
      {
        warning += (warning.empty() || one.empty() ? "" : "; ") + NameProperties(one);
      }
      if (part.piece == 0 && warning != this->Warned)
      {
        this->Warned = warning;
        if (!warning.empty())
        {
          vtkWarningMacro("Beam source: " << warning << ".");
        }
      }
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkAvianLidarPrintMacro(ErrorsAsData, Position, Orientation, NumberOfChannels);
  os << indent << "NumberOfChannelElevations: " << this->ChannelElevations.size() << "\n";
  os << indent << "NumberOfPrisms: " << this->GetNumberOfPrisms() << "\n";
  for (const auto& [name, table] : vtkInternals::Tables())
  {
    os << indent << NameProperties(name.name) << ": (" << (this->*table).size() << ")";
    for (const double value : this->*table)
    {
      os << " " << value;
    }
    os << "\n";
  }
  os << indent << "Beams: " << (this->Table ? this->Table->directions.size() : 0) << "\n";
  vtkAvianLidarPrintMacro(AzimuthRange, BeamwidthMilliradians, BeamOutline, BeamProfile,
    NumberOfRevolutions, StepsPerRevolution, MotionSeed, ReceiverModel, ThresholdLaw, PulseShape,
    PulseFileName, GetWavelength());
  for (const vtkInternals::Scalar& scalar : vtkInternals::Scalars())
  {
    os << indent << NameProperties(scalar.name.name) << ": " << this->*scalar.property << "\n";
  }
}
