// SPDX-License-Identifier: BSD-3-Clause
// The beam source: presets, arrays, field data, pieces, reuse of arrays, and every bad value.
#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarNames.h"

#include "Checks.h"
#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Source = vtkAvianLidarBeamSource;
using checks::Check;

double Field(vtkPolyData* data, const char* name)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(name);
  return array && array->GetNumberOfTuples() == 1 ? array->GetComponent(0, 0) : std::nan("");
}

void TestPreset(const std::string& name, void (Source::*preset)(), vtkIdType columns, int channels,
  double energy, double gate, double minimum, double step)
{
  vtkNew<Source> source;
  source->SetNumberOfChannels(3); // to be overwritten
  source->SetPosition(1.0, 2.0, 3.0);
  source->SetNumberOfChannelElevations(2);
  int modified = 0;
  vtkNew<vtkCallbackCommand> count;
  count->SetClientData(&modified);
  count->SetCallback(
    [](vtkObject*, unsigned long, void* times, void*) { ++*static_cast<int*>(times); });
  source->AddObserver(vtkCommand::ModifiedEvent, count);
  (source->*preset)();
  (source->*preset)();
  Check(modified == 1, name + ": modified once, and not when nothing changes");
  source->Update();
  vtkPolyData* beams = source->GetOutput();
  Check(beams->GetNumberOfPoints() == columns * channels &&
      beams->GetNumberOfVerts() == columns * channels,
    name + ": one vertex per beam");
  for (const auto& [field, value] :
    { std::pair("pulse_energy", energy), { "range_gate", gate }, { "number_of_channels", channels },
      { "half_beamwidth", 5.6e-3 }, { "lower_energy_limit", 2e-6 },
      { "upper_energy_limit", 6.25e-5 }, { "frequency", 3.313e14 }, { "noise_photon_rate", 20e3 } })
  {
    Check(Field(beams, field) == value, name + ": " + field);
  }
  vtkDataArray* angles = beams->GetPointData()->GetArray("vertical_angle");
  for (int channel = 0; channel < channels; ++channel)
  {
    Check(angles->GetComponent(channel, 0) == minimum + channel * step, name + ": elevations");
  }
  Check(source->GetPosition()[2] == 0.0, name + ": position");
}

void TestArrays()
{
  vtkNew<Source> source;
  source->SetPosition(10.0, 20.0, 3.0);
  source->SetDisplayLength(50.0);
  source->Update();
  vtkPolyData* beams = source->GetOutput();
  Check(beams->GetPoints()->GetDataType() == VTK_DOUBLE, "points are double");
  double p[3];
  beams->GetPoint(777, p);
  Check(p[0] == 10.0 && p[1] == 20.0 && p[2] == 3.0, "beams start at the position");
  vtkPointData* data = beams->GetPointData();
  Check(vtkIdTypeArray::SafeDownCast(data->GetArray("beam_id")) != nullptr, "beam_id is vtkIdType");
  Check(vtkIntArray::SafeDownCast(data->GetArray("laser_id")) != nullptr, "laser_id is int");
  for (const Arrays::Name& name :
    { Arrays::Direction, Arrays::Azimuth, Arrays::VerticalAngle, Arrays::Timestamp })
  {
    vtkDataArray* array = data->GetArray(name.name);
    Check(array && array->GetDataType() == VTK_DOUBLE, std::string(name.name) + " is double");
    const char* unit = array->GetInformation()->Get(vtkDataArray::UNITS_LABEL());
    Check(unit && std::string(unit) == name.unit, std::string(name.name) + " has its unit");
  }
  // Beam 16 * 240 looks east: 90 degrees are 9000 hundredths, a quarter of the 2 s turn.
  const vtkIdType east = 16 * 240;
  Check(data->GetArray("azimuth")->GetComponent(east, 0) == 9000.0,
    "azimuth in hundredths of a degree");
  Check(data->GetArray("timestamp")->GetComponent(east, 0) == 5e5, "timestamp in microseconds");
  Check(data->GetArray("direction")->GetComponent(east, 0) == 1.0, "90 degrees is east");

  vtkPolyData* rays = source->GetOutput(1);
  Check(rays->GetNumberOfLines() == 15360, "one ray per beam");
  rays->GetPoint(2 * east + 1, p);
  Check(p[0] == 60.0 && p[1] == 20.0 && p[2] == 3.0, "rays are as long as DisplayLength");
  Check(rays->GetCellData()->GetArray("beam_id")->GetComponent(east, 0) == east,
    "rays know their beam");
  Check(Field(rays, "display_length") == 50.0, "rays carry the sensor");

  source->SetBeamProfileToGaussian();
  source->Update();
  Check(Field(source->GetOutput(), "beam_profile") == Source::BEAM_PROFILE_GAUSSIAN,
    "Gaussian profile");
}

void TestTable()
{
  vtkNew<Source> source;
  source->SetNumberOfChannelElevations(3);
  source->SetChannelElevation(0, -2.0);
  source->SetChannelElevation(1, 7.5);
  source->SetChannelElevation(2, 1.0);
  source->Update();
  vtkPolyData* beams = source->GetOutput();
  Check(beams->GetNumberOfPoints() == 960 * 3, "the table gives the channels");
  Check(beams->GetPointData()->GetArray("vertical_angle")->GetComponent(4, 0) == 7.5,
    "elevation of channel 1");
  vtkDataArray* table = beams->GetFieldData()->GetArray("channel_elevations");
  Check(table && table->GetNumberOfTuples() == 3 && table->GetComponent(2, 0) == 1.0,
    "the table travels along");
  std::ostringstream text;
  source->Print(text);
  Check(text.str().find("ChannelElevations: (3) -2 7.5 1\n") != std::string::npos,
    "the table is printed");
}

// Rays that are asked for after the beams are those of the same piece.
void TestPiecesOfBothPorts()
{
  vtkNew<Source> source;
  source->UpdatePiece(1, 3, 0);
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* asked = source->GetOutputInformation(1);
  for (int piece : { 1, 0, 2 })
  {
    asked->Set(Pipeline::UPDATE_PIECE_NUMBER(), piece);
    asked->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 3);
    source->Update(1);
    vtkPolyData* rays = source->GetOutput(1);
    Check(rays->GetNumberOfLines() == 320 * 16, "rays of a piece");
    Check(rays->GetCellData()->GetArray("beam_id")->GetComponent(0, 0) == piece * 16,
      "rays of the piece that was asked for");
  }
}

// What somebody holds of an output stays as it is, and properties reach the next one.
void TestHeldOutput()
{
  vtkNew<Source> source;
  source->Update();
  vtkNew<vtkPolyData> held;
  held->ShallowCopy(source->GetOutput());
  source->SetPulseEnergy(1e-4);
  source->SetPosition(0.0, 0.0, 3.0);
  source->SetOrientation(1.0, 0.0, 0.0);
  source->Update();
  vtkPolyData* beams = source->GetOutput();
  Check(Field(beams, "pulse_energy") == 1e-4, "the pulse is new");
  Check(
    beams->GetPoint(0)[2] == 3.0 && held->GetPoint(0)[2] == 0.0, "a new position makes new points");
  Check(beams->GetPointData()->GetArray("azimuth")->GetComponent(0, 0) == 100.0 &&
      held->GetPointData()->GetArray("azimuth")->GetComponent(0, 0) == 0.0,
    "a new yaw makes new azimuths");
}

// Values that others forbid, and values just beyond a limit. TestBadInput.py goes far beyond the
// limits of every property, TestScanPattern.cxx and TestPointingErrors.cxx have the kernel's.
void TestBadValues()
{
  const std::vector<std::pair<const char*, std::function<void(Source*)>>> cases = {
    { "Position", [](Source* s) { s->SetPosition(0.0, 0.0, 1.1e30); } },
    { "NumberOfChannels", [](Source* s) { s->SetNumberOfChannels(0); } },
    { "MinimumElevation", [](Source* s) { s->SetMinimumElevation(-91.0); } },
    { "ElevationStep", [](Source* s) { s->SetElevationStep(0.0); } },
    { "channel 15", [](Source* s) { s->SetElevationStep(7.0); } },
    { "AzimuthRange", [](Source* s) { s->SetAzimuthRange(180.0, 0.0); } },
    { "AzimuthStep", [](Source* s) { s->SetAzimuthStep(0.0); } },
    { "FiringInterval", [](Source* s) { s->SetFiringInterval(1e-3); } },
    { "NumberOfRevolutions is", [](Source* s) { s->SetNumberOfRevolutions(0); } },
    { "StepsPerRevolution is", [](Source* s) { s->SetStepsPerRevolution(-1); } },
    { "960 columns", [](Source* s) { s->SetStepsPerRevolution(961); } },
    { "NumberOfRevolutions times", [](Source* s) { s->SetNumberOfRevolutions(1000001); } },
    { "SwayAmplitude is", [](Source* s) { s->SetSwayAmplitude(11.0); } },
    { "SwayFrequency is", [](Source* s) { s->SetSwayFrequency(0.0); } },
    { "EncoderJitter is", [](Source* s) { s->SetEncoderJitter(-0.01); } },
    { "BeamwidthMilliradians is 6", [](Source* s) { s->SetBeamwidthMilliradians(6.0); } },
    { "HalfBeamwidth is", [](Source* s) { s->SetHalfBeamwidth(0.0); } },
    { "HalfBeamwidth is", [](Source* s) { s->SetHalfBeamwidth(1.05); } }, // 60.2 degrees
    { "BeamProfile is", [](Source* s) { s->SetBeamProfile(2); } },
    { "PulseEnergy is", [](Source* s) { s->SetPulseEnergy(0.0); } },
    { "PulseWidth is", [](Source* s) { s->SetPulseWidth(5.1e-6); } }, // more than 1000 units
    { "SamplingInterval is", [](Source* s) { s->SetSamplingInterval(0.0); } },
    { "RangeGate is", [](Source* s) { s->SetRangeGate(0.0); } },
    { "NoisePhotonRate is", [](Source* s) { s->SetNoisePhotonRate(-1.0); } },
    { "LowerEnergyLimit is", [](Source* s) { s->SetLowerEnergyLimit(-1e-6); } },
    { "UpperEnergyLimit is", [](Source* s) { s->SetUpperEnergyLimit(1e-6); } }, // below the lower
    { "ReceiverAperture is", [](Source* s) { s->SetReceiverAperture(-1.0); } },
    { "DisplayLength is", [](Source* s) { s->SetDisplayLength(0.0); } },
  };
  for (const auto& [words, spoil] : cases)
  {
    vtkNew<Source> source;
    source->Update(); // so that there is something that must go
    checks::Heard heard(source);
    spoil(source);
    source->Update();
    Check(heard.ErrorHas(words), std::string(words) + " is named");
    Check(source->GetOutput()->GetNumberOfPoints() == 0 &&
        source->GetOutput(1)->GetNumberOfPoints() == 0,
      std::string(words) + ": outputs are empty");
  }
}

void TestBadTableIndex()
{
  vtkNew<Source> source;
  checks::Heard heard(source);
  source->SetNumberOfChannelElevations(2);
  for (const std::function<void()>& call :
    { std::function<void()>([&] { source->SetChannelElevation(2, 1.0); }),
      std::function<void()>([&] { source->SetChannelElevation(-1, 1.0); }),
      std::function<void()>([&] { source->GetChannelElevation(2); }),
      std::function<void()>([&] { source->SetNumberOfChannelElevations(-1); }) })
  {
    heard.observer->Clear();
    call();
    Check(heard.observer->GetError(), "a bad index of the table is an error");
  }
  Check(source->GetNumberOfChannelElevations() == 2, "and changes nothing");
}
}

int TestBeamSource(int, char*[])
{
  TestPreset("Airport16", &Source::SetPresetToAirport16, 960, 16, 3.6e-4, 4000.0, 0.0, 0.375);
  TestPreset("Airport32", &Source::SetPresetToAirport32, 1920, 32, 3.6e-4, 4000.0, 0.0, 0.1875);
  TestPreset("CorridorC16", &Source::SetPresetToCorridorC16, 180, 16, 2.5e-4, 200.0, -15.0, 2.0);
  TestArrays();
  TestTable();
  TestPiecesOfBothPorts();
  TestHeldOutput();
  TestBadValues();
  TestBadTableIndex();
  return checks::Result();
}
