// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBeamSource.h"

#include "AvailableMemory.h"
#include "ScanBeams.h"
#include "ScanClock.h"
#include "ScanPattern.h"
#include "Sensor.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarHandedOut.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanCache.h"
#include "vtkAvianLidarScanShape.h"

#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <string>

namespace
{
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
std::string NameProperties(const std::string& complaint)
{
  std::string result;
  std::size_t begin = 0;
  while (begin < complaint.size())
  {
    const std::size_t end = std::min(complaint.find(' ', begin), complaint.size());
    std::string word = complaint.substr(begin, end - begin);
    bool capital = begin == 0 || word.find('_') != std::string::npos;
    for (const char c : word)
    {
      if (c != '_')
      {
        result += capital ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      }
      capital = c == '_';
    }
    result += end < complaint.size() ? " " : "";
    begin = end + 1;
  }
  return result;
}
}

//------------------------------------------------------------------------------
class vtkAvianLidarBeamSource::vtkInternals : public vtkAvianLidarScanCache
{
public:
  vtkAvianLidarHandedOut HandedOut;
};

vtkStandardNewMacro(vtkAvianLidarBeamSource);

//------------------------------------------------------------------------------
vtkAvianLidarBeamSource::vtkAvianLidarBeamSource()
  : Internals(new vtkInternals)
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
  this->SetPresetToAirport16();
}

//------------------------------------------------------------------------------
vtkAvianLidarBeamSource::~vtkAvianLidarBeamSource() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetPresetToAirport16()
{
  for (int i = 0; i < 3; ++i)
  {
    this->Position[i] = 0.0;
    this->Orientation[i] = 0.0;
  }
  this->NumberOfChannels = 16;
  this->MinimumElevation = 0.0;
  this->ElevationStep = 0.375;
  this->ChannelElevations.clear();
  this->AzimuthRange[0] = 0.0;
  this->AzimuthRange[1] = 360.0;
  this->AzimuthStep = 0.375;
  this->HalfBeamwidth = 5.6e-3;
  this->BeamProfile = BEAM_PROFILE_UNIFORM;
  this->RotationRate = 0.5;
  this->FiringInterval = 30e-6;
  this->NumberOfRevolutions = 1;
  this->StepsPerRevolution = 1;
  this->PulseEnergy = 3.6e-4;
  this->PulseWidth = 5e-9;
  this->Frequency = 3.313e14;
  this->SamplingInterval = 5e-9;
  this->RangeGate = 4000.0;
  this->NoisePhotonRate = 20e3;
  this->LowerEnergyLimit = 2e-6;
  this->UpperEnergyLimit = 6.25e-5;
  this->ReceiverAperture = 0.0;
  this->DisplayLength = 1000.0;
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetPresetToAirport32()
{
  this->SetPresetToAirport16();
  this->NumberOfChannels = 32;
  this->ElevationStep = 0.1875;
  this->AzimuthStep = 0.1875;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::SetPresetToCorridorC16()
{
  this->SetPresetToAirport16();
  this->MinimumElevation = -15.0;
  this->ElevationStep = 2.0;
  this->AzimuthStep = 2.0;
  this->RotationRate = 10.0;
  this->FiringInterval = 5e-6;
  this->PulseEnergy = 2.5e-4;
  this->RangeGate = 200.0;
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
avianlidar::ScanPattern vtkAvianLidarBeamSource::MakePattern() const
{
  avianlidar::ScanPattern pattern;
  pattern.yaw = this->Orientation[0];
  pattern.pitch = this->Orientation[1];
  pattern.roll = this->Orientation[2];
  pattern.channels = this->NumberOfChannels;
  pattern.minimumElevation = this->MinimumElevation;
  pattern.elevationStep = this->ElevationStep;
  pattern.elevations = this->ChannelElevations;
  pattern.azimuthStart = this->AzimuthRange[0];
  pattern.azimuthEnd = this->AzimuthRange[1];
  pattern.azimuthStep = this->AzimuthStep;
  pattern.rotationRate = this->RotationRate;
  pattern.firingInterval = this->FiringInterval;
  return pattern;
}

//------------------------------------------------------------------------------
avianlidar::ScanClock vtkAvianLidarBeamSource::MakeClock() const
{
  avianlidar::ScanClock clock;
  clock.rotationRate = this->RotationRate;
  clock.revolutions = this->NumberOfRevolutions;
  clock.steps = this->StepsPerRevolution;
  return clock;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::FindMoment(
  vtkInformation* asked, avianlidar::ScanPart& part, int& revolution) const
{
  if (!asked->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    return std::string(); // the whole of revolution 0
  }
  avianlidar::ScanMoment moment;
  const std::string complaint =
    avianlidar::momentAt(this->MakeClock(), asked->Get(Pipeline::UPDATE_TIME_STEP()), moment);
  revolution = moment.revolution;
  part.step = moment.step;
  part.steps = this->StepsPerRevolution;
  return complaint;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::CheckProperties() const
{
  for (const std::string& complaint :
    { NameProperties(
        avianlidar::checkPosition({ this->Position[0], this->Position[1], this->Position[2] })),
      NameProperties(avianlidar::checkDisplayLength(this->DisplayLength)),
      avianlidar::checkPattern(this->MakePattern()) })
  {
    if (!complaint.empty())
    {
      return complaint;
    }
  }
  const std::string badClock = avianlidar::checkClock(this->MakeClock(), this->MakePattern());
  if (!badClock.empty())
  {
    return badClock;
  }
  avianlidar::Sensor sensor;
  sensor.halfBeamwidth = this->HalfBeamwidth;
  sensor.beamProfile = static_cast<avianlidar::BeamProfile>(this->BeamProfile);
  sensor.pulseEnergy = this->PulseEnergy;
  sensor.pulseWidth = this->PulseWidth;
  sensor.frequency = this->Frequency;
  sensor.samplingInterval = this->SamplingInterval;
  sensor.rangeGate = this->RangeGate;
  sensor.noisePhotonRate = this->NoisePhotonRate;
  sensor.lowerEnergyLimit = this->LowerEnergyLimit;
  sensor.upperEnergyLimit = this->UpperEnergyLimit;
  sensor.receiverAperture = this->ReceiverAperture;
  return NameProperties(avianlidar::checkSensor(sensor));
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    vtkInformation* outInfo = outputVector->GetInformationObject(port);
    outInfo->Set(CAN_HANDLE_PIECE_REQUEST(), 1);
    vtkAvianLidarRevolutions::Publish(this->MakeClock(), outInfo);
    vtkAvianLidarScanShape::Publish(this->MakePattern(), outInfo);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::ModifyRequest(vtkInformation* request, int when)
{
  if (this->Internals->HandedOut.AreEdited(this, request, when))
  {
    *this->Internals = vtkInternals();
  }
  return this->Superclass::ModifyRequest(request, when);
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamSource::RequestData(
  vtkInformation* request, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> std::string
    {
      vtkAvianLidarAbort::StopIfWanted(this);
      std::string complaint = this->CheckProperties();
      // Both outputs are of the piece and the time that one of them is asked for: so VTK's
      // executive has it.
      vtkInformation* asked = vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      avianlidar::ScanPart part = PieceOf(asked);
      int revolution = 0;
      if (complaint.empty())
      {
        complaint = this->FindMoment(asked, part, revolution);
      }
      if (!complaint.empty())
      {
        return "Beam source: " + complaint;
      }
      const avianlidar::ScanPattern pattern = this->MakePattern();

      vtkPolyData* output = vtkPolyData::GetData(outputVector, 0);
      const vtkAvianLidarScanCache::Scan& scan =
        this->Internals->GetScan(pattern, part, revolution);
      this->Internals->GetVertices(scan.Size(), this->Position, output);
      vtkPointData* pointData = output->GetPointData();
      pointData->AddArray(scan.BeamIds);
      pointData->AddArray(scan.Directions);
      pointData->AddArray(scan.LaserIds);
      pointData->AddArray(scan.Azimuths);
      pointData->AddArray(scan.VerticalAngles);
      pointData->AddArray(scan.Timestamps);
      this->AddSensor(revolution, output->GetFieldData());

      vtkPolyData* rays = vtkPolyData::GetData(outputVector, 1);
      this->Internals->GetRays(scan, this->Position, this->DisplayLength, rays);
      rays->GetCellData()->AddArray(scan.BeamIds);
      rays->GetCellData()->AddArray(scan.LaserIds);
      rays->GetCellData()->AddArray(scan.Timestamps);
      this->AddSensor(revolution, rays->GetFieldData());
      this->Internals->HandedOut.Note(this);
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
  os << indent << "MinimumElevation: " << this->MinimumElevation << "\n";
  os << indent << "ElevationStep: " << this->ElevationStep << "\n";
  os << indent << "ChannelElevations: " << this->ChannelElevations.size() << " entries";
  for (std::size_t i = 0; i < this->ChannelElevations.size(); ++i)
  {
    os << (i == 0 ? ": " : " ") << this->ChannelElevations[i];
  }
  os << "\n";
  os << indent << "AzimuthRange: " << this->AzimuthRange[0] << " " << this->AzimuthRange[1] << "\n";
  os << indent << "AzimuthStep: " << this->AzimuthStep << "\n";
  os << indent << "HalfBeamwidth: " << this->HalfBeamwidth << "\n";
  os << indent << "BeamProfile: " << this->BeamProfile << "\n";
  os << indent << "RotationRate: " << this->RotationRate << "\n";
  os << indent << "FiringInterval: " << this->FiringInterval << "\n";
  os << indent << "NumberOfRevolutions: " << this->NumberOfRevolutions << "\n";
  os << indent << "StepsPerRevolution: " << this->StepsPerRevolution << "\n";
  os << indent << "PulseEnergy: " << this->PulseEnergy << "\n";
  os << indent << "PulseWidth: " << this->PulseWidth << "\n";
  os << indent << "Frequency: " << this->Frequency << "\n";
  os << indent << "SamplingInterval: " << this->SamplingInterval << "\n";
  os << indent << "RangeGate: " << this->RangeGate << "\n";
  os << indent << "NoisePhotonRate: " << this->NoisePhotonRate << "\n";
  os << indent << "LowerEnergyLimit: " << this->LowerEnergyLimit << "\n";
  os << indent << "UpperEnergyLimit: " << this->UpperEnergyLimit << "\n";
  os << indent << "ReceiverAperture: " << this->ReceiverAperture << "\n";
  os << indent << "DisplayLength: " << this->DisplayLength << "\n";
}
