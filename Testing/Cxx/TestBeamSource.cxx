// SPDX-License-Identifier: BSD-3-Clause
// The beam source: the paper's presets, angles and times, the table of elevations, pieces, held
// outputs. Bad values are TestScanPattern's, TestScanClock's and TestBadInput.py's.
#include "vtkAvianLidarBeamSource.h"

#include "Checks.h"
#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <functional>
#include <string>
#include <utility>

namespace
{
using Source = vtkAvianLidarBeamSource;
using checks::At;
using checks::Check;

void TestPresets()
{
  const struct
  {
    void (Source::*choose)();
    vtkIdType columns;
    int channels;
    double energy, gate, minimum, step;
  } presets[] = {
    { &Source::SetPresetToAirport16, 960, 16, 3.6e-4, 4000.0, 0.0, 0.375 },
    { &Source::SetPresetToAirport32, 1920, 32, 3.6e-4, 4000.0, 0.0, 0.1875 },
    { &Source::SetPresetToCorridorC16, 180, 16, 2.5e-4, 200.0, -15.0, 2.0 },
  };
  for (const auto& preset : presets)
  {
    const std::string name = std::to_string(preset.columns) + " columns: ";
    vtkNew<Source> source;
    source->SetPosition(1.0, 2.0, 3.0); // to be overwritten
    source->SetNumberOfChannelElevations(2);
    (source.Get()->*preset.choose)();
    const vtkMTimeType time = source->GetMTime();
    (source.Get()->*preset.choose)();
    Check(source->GetMTime() == time, name + "the same preset changes nothing");
    source->Update();
    vtkPolyData* beams = source->GetOutput();
    Check(beams->GetNumberOfVerts() == preset.columns * preset.channels, name + "beams");
    for (const auto& [field, value] : { std::pair("pulse_energy", preset.energy),
           { "range_gate", preset.gate }, { "half_beamwidth", 5.6e-3 },
           { "lower_energy_limit", 2e-6 }, { "upper_energy_limit", 6.25e-5 },
           { "frequency", 3.313e14 }, { "noise_photon_rate", 20e3 } })
    {
      Check(At(beams->GetFieldData(), field) == value, name + field);
    }
    for (int channel = 0; channel < preset.channels; ++channel)
    {
      Check(At(beams->GetPointData(), "vertical_angle", channel) ==
          preset.minimum + channel * preset.step,
        name + "elevations");
    }
    Check(source->GetPosition()[2] == 0.0, name + "position");
  }
}

void TestBeamsAndRays()
{
  vtkNew<Source> source;
  source->SetPosition(10.0, 20.0, 3.0);
  source->SetDisplayLength(50.0);
  source->Update();
  vtkPolyData* beams = source->GetOutput();
  vtkPolyData* rays = source->GetOutput(1);
  // Beam 16 * 240 looks east: 90 degrees are 9000 hundredths, a quarter of the 2 s turn.
  const vtkIdType east = 16 * 240;
  Check(At(beams->GetPointData(), "azimuth", east) == 9000.0, "hundredths of a degree");
  Check(At(beams->GetPointData(), "timestamp", east) == 5e5, "microseconds");
  Check(At(beams->GetPointData(), "direction", east) == 1.0, "90 degrees is east");
  Check(At(rays->GetCellData(), "beam_id", east) == east, "rays know their beam");
  Check(At(rays->GetCellData(), "timestamp", east) == 5e5 &&
      At(rays->GetCellData(), "laser_id", east + 3) == 3.0,
    "rays know their time and laser");
  const double* begin = beams->GetPoints()->GetPoint(777);
  Check(begin[0] == 10.0 && begin[1] == 20.0 && begin[2] == 3.0, "beams start at the position");
  const double* end = rays->GetPoints()->GetPoint(2 * east + 1);
  Check(end[0] == 60.0 && end[1] == 20.0 && end[2] == 3.0, "rays have the display length");
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
  Check(At(beams->GetPointData(), "vertical_angle", 4) == 7.5, "elevation of channel 1");
  Check(At(beams->GetFieldData(), "channel_elevations", 2) == 1.0, "the table is in field data");

  checks::Heard heard(source);
  for (const std::function<void()>& call :
    { std::function<void()>([&] { source->SetChannelElevation(3, 1.0); }),
      std::function<void()>([&] { source->SetChannelElevation(-1, 1.0); }),
      std::function<void()>([&] { source->GetChannelElevation(3); }),
      std::function<void()>([&] { source->SetNumberOfChannelElevations(-1); }) })
  {
    heard.observer->Clear();
    call();
    Check(heard.observer->GetError(), "a bad index of the table is an error");
  }
  Check(source->GetNumberOfChannelElevations() == 3, "and changes nothing");
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
    Check(At(rays->GetCellData(), "beam_id") == piece * 16, "rays of the piece asked for");
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
  Check(At(beams->GetFieldData(), "pulse_energy") == 1e-4, "the pulse is new");
  Check(beams->GetPoint(0)[2] == 3.0 && held->GetPoint(0)[2] == 0.0, "new points");
  Check(At(beams->GetPointData(), "azimuth") == 100.0 && At(held->GetPointData(), "azimuth") == 0.0,
    "new azimuths");
}
}

int TestBeamSource(int, char*[])
{
  TestPresets();
  TestBeamsAndRays();
  TestTable();
  TestPiecesOfBothPorts();
  TestHeldOutput();
  return checks::Result();
}
