// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBeamSource.h"

#include "AvailableMemory.h"
#include "PhotonReceiver.h"
#include "ScanBeams.h"
#include "ScanClock.h"
#include "ScanPattern.h"
#include "Sensor.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanArrays.h"
#include "vtkAvianLidarScanShape.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <string>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Pipeline = vtkStreamingDemandDrivenPipeline;

// The piece that is asked for; one that does not exist has no columns.
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

// The kernel speaks of values by their names in the field data: the same words as the names of the
// properties, "range_gate is 0" as "RangeGate is 0".
std::string NameProperties(const std::string& error)
{
  std::string result;
  std::size_t begin = 0;
  while (begin < error.size())
  {
    const std::size_t end = std::min(error.find(' ', begin), error.size());
    std::string word = error.substr(begin, end - begin);
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

void SetVector(vtkFieldData* fields, const Arrays::Name& name, const double* values, int components)
{
  auto array = Arrays::Make<vtkDoubleArray>(name, 1, components);
  array->SetTypedTuple(0, values);
  fields->AddArray(array);
}
}

//------------------------------------------------------------------------------
// The source's properties as the kernel and the field data have them.
struct vtkAvianLidarBeamSource::vtkInternals
{
  using Source = vtkAvianLidarBeamSource;

  // A number of the source, and where the kernel's sensor has it.
  struct Scalar
  {
    Arrays::Name name;
    double Source::*property;
    double avianlidar::Sensor::*sensor;
  };
  static const std::vector<Scalar>& Scalars();

  // The sensor with the limits that it uses. An error if a value is bad.
  static std::string SensorOf(const Source& self, avianlidar::Sensor& sensor);
  static avianlidar::ScanPattern PatternOf(const Source& self);
  static avianlidar::ScanClock ClockOf(const Source& self);
  // What is asked for, or an error.
  static std::string FindMoment(
    const Source& self, vtkInformation* asked, avianlidar::ScanPart& part, int& revolution);
  // The first bad value in words, or an empty string.
  static std::string CheckProperties(const Source& self);
  // The sensor as field data of its beams.
  static void AddSensor(const Source& self, int revolution, vtkFieldData* fields);
};

vtkStandardNewMacro(vtkAvianLidarBeamSource);

//------------------------------------------------------------------------------
vtkAvianLidarBeamSource::vtkAvianLidarBeamSource()
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarBeamSource::~vtkAvianLidarBeamSource() = default;

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
  take(this->NumberOfChannels, preset.NumberOfChannels);
  take(this->ChannelElevations, preset.ChannelElevations);
  take(this->BeamProfile, preset.BeamProfile);
  take(this->NumberOfRevolutions, preset.NumberOfRevolutions);
  take(this->StepsPerRevolution, preset.StepsPerRevolution);
  take(this->ReceiverModel, preset.ReceiverModel);
  for (const vtkInternals::Scalar& scalar : vtkInternals::Scalars())
  {
    take(this->*scalar.property, preset.*scalar.property);
  }
  if (changed)
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetPresetToAirport16()
{
  vtkNew<vtkAvianLidarBeamSource> airport;
  this->TakeProperties(*airport);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetPresetToAirport32()
{
  vtkNew<vtkAvianLidarBeamSource> airport;
  airport->SetNumberOfChannels(32);
  airport->SetElevationStep(0.1875);
  airport->SetAzimuthStep(0.1875);
  this->TakeProperties(*airport);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetPresetToCorridorC16()
{
  vtkNew<vtkAvianLidarBeamSource> corridor;
  corridor->SetMinimumElevation(-15.0);
  corridor->SetElevationStep(2.0);
  corridor->SetAzimuthStep(2.0);
  corridor->SetRotationRate(10.0);
  corridor->SetFiringInterval(5e-6);
  corridor->SetPulseEnergy(2.5e-4);
  corridor->SetRangeGate(200.0);
  this->TakeProperties(*corridor);
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
    // The table itself, and its copies in an execution.
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
int vtkAvianLidarBeamSource::GetNumberOfChannelElevations() const
{
  return static_cast<int>(this->ChannelElevations.size());
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetChannelElevation(int index, double elevation)
{
  if (index < 0 || index >= this->GetNumberOfChannelElevations())
  {
    vtkErrorMacro("ChannelElevation has no entry " << index << ", expected an index below the "
                                                   << this->GetNumberOfChannelElevations()
                                                   << " of NumberOfChannelElevations.");
    return;
  }
  if (this->ChannelElevations[index] != elevation)
  {
    this->ChannelElevations[index] = elevation;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeamSource::GetChannelElevation(int index)
{
  if (index < 0 || index >= this->GetNumberOfChannelElevations())
  {
    vtkErrorMacro("ChannelElevation has no entry " << index << ", expected an index below the "
                                                   << this->GetNumberOfChannelElevations()
                                                   << " of NumberOfChannelElevations.");
    return 0.0;
  }
  return this->ChannelElevations[index];
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetWavelength(double nanometres)
{
  if (!(nanometres > 0.0) || !std::isfinite(nanometres))
  {
    vtkErrorMacro("Wavelength is " << nanometres << ", expected more than 0 nm.");
    return;
  }
  this->SetFrequency(avianlidar::SpeedOfLight / (1e-9 * nanometres));
}

//------------------------------------------------------------------------------
double vtkAvianLidarBeamSource::GetWavelength()
{
  return 1e9 * avianlidar::SpeedOfLight / this->Frequency;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetLimitsFromDataSheet(
  double range, double reflectance, double attenuation)
{
  avianlidar::Sensor sensor;
  vtkInternals::SensorOf(*this, sensor);
  const std::string error =
    avianlidar::setDataSheetLimits(sensor, range, reflectance, attenuation, this->DynamicRange);
  if (!error.empty())
  {
    vtkErrorMacro("SetLimitsFromDataSheet: " << NameProperties(error) << ".");
    return;
  }
  this->SetLowerEnergyLimit(sensor.lowerEnergyLimit);
  this->SetUpperEnergyLimit(sensor.upperEnergyLimit);
}

//------------------------------------------------------------------------------
const std::vector<vtkAvianLidarBeamSource::vtkInternals::Scalar>& vtkAvianLidarBeamSource::
  vtkInternals::Scalars()
{
  using Sensor = avianlidar::Sensor;
  static const std::vector<Scalar> all = { { Arrays::MinimumElevation, &Source::MinimumElevation,
                                             nullptr },
    { Arrays::ElevationStep, &Source::ElevationStep, nullptr },
    { Arrays::AzimuthStep, &Source::AzimuthStep, nullptr },
    { Arrays::RotationRate, &Source::RotationRate, nullptr },
    { Arrays::FiringInterval, &Source::FiringInterval, nullptr },
    { Arrays::HalfBeamwidth, &Source::HalfBeamwidth, &Sensor::halfBeamwidth },
    { Arrays::PulseEnergy, &Source::PulseEnergy, &Sensor::pulseEnergy },
    { Arrays::PulseWidth, &Source::PulseWidth, &Sensor::pulseWidth },
    { Arrays::Frequency, &Source::Frequency, &Sensor::frequency },
    { Arrays::SamplingInterval, &Source::SamplingInterval, &Sensor::samplingInterval },
    { Arrays::RangeGate, &Source::RangeGate, &Sensor::rangeGate },
    { Arrays::NoisePhotonRate, &Source::NoisePhotonRate, &Sensor::noisePhotonRate },
    { Arrays::LowerEnergyLimit, &Source::LowerEnergyLimit, &Sensor::lowerEnergyLimit },
    { Arrays::UpperEnergyLimit, &Source::UpperEnergyLimit, &Sensor::upperEnergyLimit },
    { Arrays::ReceiverAperture, &Source::ReceiverAperture, &Sensor::receiverAperture },
    { Arrays::ReceiverEfficiency, &Source::ReceiverEfficiency, &Sensor::receiverEfficiency },
    { Arrays::FilterBandwidth, &Source::FilterBandwidth, &Sensor::filterBandwidth },
    { Arrays::BackgroundRadiance, &Source::BackgroundRadiance, &Sensor::backgroundRadiance },
    { Arrays::AmplifierNoise, &Source::AmplifierNoise, &Sensor::amplifierNoise },
    { Arrays::ExcessNoiseFactor, &Source::ExcessNoiseFactor, &Sensor::excessNoiseFactor },
    { Arrays::FalseAlarmsPerScan, &Source::FalseAlarmsPerScan, nullptr },
    { Arrays::DynamicRange, &Source::DynamicRange, nullptr },
    { Arrays::DisplayLength, &Source::DisplayLength, nullptr } };
  return all;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::vtkInternals::SensorOf(
  const Source& self, avianlidar::Sensor& sensor)
{
  for (const Scalar& scalar : Scalars())
  {
    if (scalar.sensor)
    {
      sensor.*scalar.sensor = self.*scalar.property;
    }
  }
  sensor.beamProfile = static_cast<avianlidar::BeamProfile>(self.BeamProfile);
  sensor.receiverModel = static_cast<avianlidar::ReceiverModel>(self.ReceiverModel);
  const std::string error = avianlidar::checkSensor(sensor);
  if (!error.empty() || sensor.receiverModel != avianlidar::ReceiverModel::Photons)
  {
    return error;
  }
  return avianlidar::setPhotonLimits(sensor, self.FalseAlarmsPerScan, self.DynamicRange,
    static_cast<double>(avianlidar::numberOfBeams(PatternOf(self))));
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
  pattern.azimuthStart = self.AzimuthRange[0];
  pattern.azimuthEnd = self.AzimuthRange[1];
  pattern.azimuthStep = self.AzimuthStep;
  pattern.rotationRate = self.RotationRate;
  pattern.firingInterval = self.FiringInterval;
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
std::string vtkAvianLidarBeamSource::vtkInternals::FindMoment(
  const Source& self, vtkInformation* asked, avianlidar::ScanPart& part, int& revolution)
{
  if (!asked->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    return std::string(); // the whole of revolution 0
  }
  avianlidar::ScanMoment moment;
  const std::string error =
    avianlidar::momentAt(ClockOf(self), asked->Get(Pipeline::UPDATE_TIME_STEP()), moment);
  revolution = moment.revolution;
  part.step = moment.step;
  part.steps = self.StepsPerRevolution;
  return error;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::vtkInternals::CheckProperties(const Source& self)
{
  for (const std::string& error : { NameProperties(avianlidar::checkPosition(
                                      { self.Position[0], self.Position[1], self.Position[2] })),
         NameProperties(avianlidar::checkDisplayLength(self.DisplayLength)),
         avianlidar::checkPattern(PatternOf(self)) })
  {
    if (!error.empty())
    {
      return error;
    }
  }
  const std::string badClock = avianlidar::checkClock(ClockOf(self), PatternOf(self));
  if (!badClock.empty())
  {
    return badClock;
  }
  avianlidar::Sensor sensor;
  return NameProperties(SensorOf(self, sensor));
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::vtkInternals::AddSensor(
  const Source& self, int revolution, vtkFieldData* fields)
{
  SetVector(fields, Arrays::Position, self.Position, 3);
  SetVector(fields, Arrays::Orientation, self.Orientation, 3);
  Arrays::SetFieldInteger(
    fields, Arrays::NumberOfChannels, avianlidar::numberOfChannels(PatternOf(self)));
  if (!self.ChannelElevations.empty())
  {
    fields->AddArray(
      Arrays::MakeOf<vtkDoubleArray>(Arrays::ChannelElevations, self.ChannelElevations));
  }
  SetVector(fields, Arrays::AzimuthRange, self.AzimuthRange, 2);
  Arrays::SetFieldInteger(fields, Arrays::BeamProfile, self.BeamProfile);
  Arrays::SetFieldInteger(fields, Arrays::NumberOfRevolutions, self.NumberOfRevolutions);
  Arrays::SetFieldInteger(fields, Arrays::StepsPerRevolution, self.StepsPerRevolution);
  Arrays::SetFieldInteger(fields, Arrays::Revolution, revolution);
  Arrays::SetFieldInteger(fields, Arrays::ReceiverModel, self.ReceiverModel);
  Arrays::SetFieldValue(
    fields, Arrays::Wavelength, 1e9 * avianlidar::SpeedOfLight / self.Frequency);
  for (const Scalar& scalar : Scalars())
  {
    Arrays::SetFieldValue(fields, scalar.name, self.*scalar.property);
  }
  avianlidar::Sensor sensor;
  SensorOf(self, sensor);
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
int vtkAvianLidarBeamSource::RequestData(
  vtkInformation* request, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> std::string
    {
      vtkAvianLidarAbort::StopIfWanted(this);
      std::string error = vtkInternals::CheckProperties(*this);
      // Both outputs are of the piece and the time that one of them is asked for: so VTK's
      // executive has it.
      vtkInformation* asked = vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      avianlidar::ScanPart part = PieceOf(asked);
      int revolution = 0;
      if (error.empty())
      {
        error = vtkInternals::FindMoment(*this, asked, part, revolution);
      }
      if (!error.empty())
      {
        return "Beam source: " + error;
      }
      vtkPolyData* beams = vtkPolyData::GetData(outputVector, 0);
      vtkPolyData* rays = vtkPolyData::GetData(outputVector, 1);
      vtkAvianLidarScanArrays::FillBeams(
        vtkInternals::PatternOf(*this), part, revolution, this->Position, beams);
      vtkAvianLidarScanArrays::FillRays(beams, this->DisplayLength, rays);
      vtkInternals::AddSensor(*this, revolution, beams->GetFieldData());
      vtkInternals::AddSensor(*this, revolution, rays->GetFieldData());
      return {};
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  os << indent << "Position: " << this->Position[0] << " " << this->Position[1] << " "
     << this->Position[2] << "\n";
  os << indent << "Orientation: " << this->Orientation[0] << " " << this->Orientation[1] << " "
     << this->Orientation[2] << "\n";
  os << indent << "NumberOfChannels: " << this->NumberOfChannels << "\n";
  os << indent << "ChannelElevations: " << this->ChannelElevations.size() << " entries";
  for (std::size_t i = 0; i < this->ChannelElevations.size(); ++i)
  {
    os << (i == 0 ? ": " : " ") << this->ChannelElevations[i];
  }
  os << "\n";
  os << indent << "AzimuthRange: " << this->AzimuthRange[0] << " " << this->AzimuthRange[1] << "\n";
  os << indent << "BeamProfile: " << this->BeamProfile << "\n";
  os << indent << "NumberOfRevolutions: " << this->NumberOfRevolutions << "\n";
  os << indent << "StepsPerRevolution: " << this->StepsPerRevolution << "\n";
  os << indent << "ReceiverModel: " << this->ReceiverModel << "\n";
  for (const vtkInternals::Scalar& scalar : vtkInternals::Scalars())
  {
    os << indent << NameProperties(scalar.name.name) << ": " << this->*scalar.property << "\n";
  }
}
