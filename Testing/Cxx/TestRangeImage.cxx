// SPDX-License-Identifier: BSD-3-Clause
// The range image: its grid in degrees, the strongest return of each beam, empty cells, beam
// reports, and bad input. TestEchoPipeline.py compares maps with reports of whole scans.
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarRangeImage.h"

#include "Checks.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Filter = vtkAvianLidarRangeImage;
using checks::Check;

template <class ArrayT>
void Add(vtkPolyData* data, const Arrays::Name& name, const std::vector<double>& values)
{
  auto array = Arrays::Make<ArrayT>(name);
  for (const double value : values)
  {
    array->InsertNextTuple1(value);
  }
  data->GetPointData()->AddArray(array);
}

vtkSmartPointer<vtkPolyData> Points(std::size_t size)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(static_cast<vtkIdType>(size));
  data->SetPoints(points);
  return data;
}

vtkSmartPointer<vtkPolyData> Echoes(const std::vector<double>& beams = {},
  const std::vector<double>& distances = {}, const std::vector<double>& received = {},
  const std::vector<double>& objects = {})
{
  auto cloud = Points(beams.size());
  std::vector<double> energies;
  for (const double energy : received)
  {
    energies.push_back(std::min(energy, 6.25e-5)); // saturates
  }
  Add<vtkIdTypeArray>(cloud, Arrays::BeamId, beams);
  Add<vtkDoubleArray>(cloud, Arrays::Distance, distances);
  Add<vtkDoubleArray>(cloud, Arrays::EnergyReceived, received);
  Add<vtkDoubleArray>(cloud, Arrays::Energy, energies);
  Add<vtkIntArray>(cloud, Arrays::ObjectId, objects);
  return cloud;
}

/// A beam report of four beams, two of which share a cell.
vtkSmartPointer<vtkPolyData> Report()
{
  auto report = Points(4);
  Add<vtkIdTypeArray>(report, Arrays::BeamId, { 10, 11, 12, 13 });
  Add<vtkDoubleArray>(report, Arrays::Azimuth, { 0, 100, 200, 100 });
  Add<vtkDoubleArray>(report, Arrays::VerticalAngle, { 0, 0, 0, 0 });
  Add<vtkIntArray>(report, Arrays::Status, { 0, 2, 1, 3 });
  Add<vtkIdTypeArray>(report, Arrays::NodesVisited, { 7, 8, 5e9, 10 });
  Add<vtkDoubleArray>(report, Arrays::SkippedBound, { 1e-9, 2e-9, 0, 3e-9 });
  return report;
}

/// The value of a cell in the present image.
double At(Filter* filter, const char* name, int column, int row)
{
  int index[3] = { column, row, 0 };
  vtkImageData* image = filter->GetOutput();
  return checks::At(image->GetPointData(), name, image->ComputePointId(index));
}

void Run(Filter* filter, vtkPolyData* echoes, vtkPolyData* beams, int columns, int rows)
{
  filter->SetInputData(0, echoes);
  filter->SetInputData(1, beams);
  filter->SetColumns(columns);
  filter->SetRows(rows);
  filter->Update();
}

// Columns that the pipeline announces to what is downstream.
int AnnouncedColumns(Filter* filter)
{
  filter->UpdateInformation();
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  return filter->GetOutputInformation(0)->Get(Pipeline::WHOLE_EXTENT())[1] + 1;
}

void TestStrongest()
{
  vtkNew<vtkAvianLidarBeamSource> source;
  vtkNew<Filter> filter;
  // Beam 16 * 100 + 5: two saturated returns, told apart by what was received; beam 0: equal ones,
  // the nearer wins.
  filter->SetInputData(0,
    Echoes({ 1605, 1605, 0, 0, 15359 }, { 300.0, 500.0, 90.0, 80.0, 1234.5 },
      { 7e-5, 9e-5, 1e-5, 1e-5, 2.5e-6 }, { 2, 3, 8, 7, 0 }));
  filter->SetInputConnection(1, source->GetOutputPort());
  filter->Update();
  vtkImageData* image = filter->GetOutput();
  int size[3];
  image->GetDimensions(size);
  Check(size[0] == 960 && size[1] == 16 && size[2] == 1, "columns by rows");
  for (int axis = 0; axis < 2; ++axis)
  {
    Check(image->GetOrigin()[axis] == 0.0 && std::abs(image->GetSpacing()[axis] - 0.375) < 1e-12,
      "origin and spacing in degrees");
  }
  Check(At(filter, "distance_m", 100, 5) == 500.0 && At(filter, "object_id", 100, 5) == 3 &&
      At(filter, "energy", 100, 5) == 6.25e-5,
    "the strongest return");
  Check(At(filter, "distance_m", 0, 0) == 80.0 && At(filter, "object_id", 0, 0) == 7,
    "of equal returns the nearest");
  Check(At(filter, "distance_m", 959, 15) == 1234.5, "the last beam");
  Check(std::isnan(At(filter, "distance_m", 1, 0)) && std::isnan(At(filter, "energy", 1, 0)) &&
      At(filter, "object_id", 1, 0) == -1,
    "empty cells");
  vtkFieldData* fields = image->GetFieldData();
  Check(fields->GetArray("column_azimuths")->GetNumberOfTuples() == 960 &&
      std::abs(checks::At(fields, "row_elevations", 15) - 5.625) < 1e-12,
    "the angles are field data");

  // What is downstream learns the extent before this filter executes, also after a change upstream.
  Check(AnnouncedColumns(filter) == 960, "the pipeline knows the size");
  filter->SetInputData(0, Echoes());
  source->SetAzimuthRange(-30.0, 30.0);
  Check(AnnouncedColumns(filter) == 160, "the pipeline knows the new size");
  filter->Update();
  Check(std::abs(filter->GetOutput()->GetOrigin()[0] + 30.0) < 1e-9, "a sector across north");
}

void TestOtherBeams()
{
  vtkNew<vtkAvianLidarBeamSource> source;
  source->SetNumberOfChannelElevations(3);
  source->SetChannelElevation(0, -5.0);
  source->SetChannelElevation(1, 10.0);
  source->SetChannelElevation(2, 0.0);
  source->Update();
  vtkNew<Filter> filter;
  auto echoes = Echoes({ 3 * 7 + 1 }, { 50.0 }, { 1e-5 }, { 4 });
  filter->SetInputData(0, echoes);
  filter->SetInputConnection(1, source->GetOutputPort());
  filter->Update();
  vtkImageData* image = filter->GetOutput();
  Check(At(filter, "distance_m", 7, 2) == 50.0, "rows are the elevations of the table, sorted");
  Check(image->GetOrigin()[1] == 0.0 && image->GetSpacing()[1] == 1.0 &&
      checks::At(image->GetFieldData(), "row_elevations", 2) == 10.0,
    "rows that are not equally spaced are counted");

  // Beams of somebody's script: directions only, numbered as they come.
  vtkNew<vtkPolyData> bare;
  bare->DeepCopy(source->GetOutput());
  for (const char* name : { "azimuth", "vertical_angle", "beam_id", "laser_id" })
  {
    bare->GetPointData()->RemoveArray(name);
  }
  Run(filter, echoes, bare, 960, 3);
  Check(At(filter, "distance_m", 7, 2) == 50.0, "directions are enough");
}

void TestReport()
{
  vtkNew<Filter> filter;
  Run(filter, Echoes(), Report(), 3, 1);
  Check(At(filter, "status", 0, 0) == 0 && At(filter, "status", 1, 0) == 2 &&
      At(filter, "status", 2, 0) == 1 && std::isnan(At(filter, "distance_m", 0, 0)),
    "without echoes a cell shows its first beam");
  Check(At(filter, "nodes_visited", 2, 0) == 5e9 && At(filter, "skipped_bound", 1, 0) == 2e-9,
    "large counts and bounds");
  vtkPointData* data = filter->GetOutput()->GetPointData();
  Check(data->GetArray("skipped_bound")->GetInformation()->Get(vtkDataArray::UNITS_LABEL()) ==
      std::string("J"),
    "units");
  Check(!data->HasArray("candidates") && !data->HasArray("skipped"), "what is not there");

  Run(filter, Echoes({ 13, 10 }, { 20.0, 30.0 }, { 1e-5, 1e-5 }, { 1, 2 }), Report(), 3, 1);
  Check(At(filter, "status", 1, 0) == 3 && At(filter, "nodes_visited", 1, 0) == 10 &&
      At(filter, "distance_m", 1, 0) == 20.0,
    "with echoes a cell shows the beam of the strongest");

  // Three azimuths and two elevations, but four beams: two cells have none.
  auto report = Report();
  report->GetPointData()->GetArray("vertical_angle")->SetComponent(3, 0, 1.0);
  Run(filter, Echoes(), report, 3, 2);
  Check(At(filter, "status", 0, 1) == -1 && At(filter, "nodes_visited", 2, 1) == -1 &&
      std::isnan(At(filter, "skipped_bound", 2, 1)) && At(filter, "status", 1, 1) == 3,
    "cells without a beam");
}

// What the pipeline announces, or the properties, has to be the grid of the beams.
void TestSize()
{
  for (const auto& [columns, rows] : { std::pair(0, 0), { 3, 0 }, { 1, 3 } })
  {
    vtkNew<Filter> filter;
    filter->SetInputData(0, Echoes());
    filter->SetInputData(1, Report());
    filter->SetColumns(columns);
    filter->SetRows(rows);
    checks::CheckFails(filter, "form 3 columns and 1 rows");
  }
  // Without beams it is the size that was announced.
  vtkNew<Filter> filter;
  checks::Heard heard(filter);
  vtkNew<vtkPolyData> nothing;
  Run(filter, nothing, nothing, 0, 0);
  Check(filter->GetOutput()->GetNumberOfPoints() == 0, "no beams: no image");
  Run(filter, nothing, nothing, 3, 2);
  Check(heard.Nothing() && filter->GetOutput()->GetNumberOfPoints() == 6 &&
      std::isnan(At(filter, "distance_m", 2, 1)) && At(filter, "object_id", 0, 0) == -1,
    "no beams: cells without an echo");
}

// Arrays that are missing or have wrong values are tested in TestBadInput.py.
void TestBadInput()
{
  using Data = vtkPointData*;
  const std::pair<const char*, void (*)(Data echoes, Data beams)> cases[] = {
    { "'direction'",
      [](Data, Data b)
      {
        for (const char* name : { "vertical_angle", "azimuth", "direction" })
        {
          b->RemoveArray(name);
        }
      } },
    { "no beam of input port 1",
      [](Data e, Data) { e->GetArray("beam_id")->SetComponent(0, 0, 99999.0); } },
    { "two beams", [](Data, Data b) { b->GetArray("beam_id")->SetComponent(5, 0, 4.0); } },
    { "no grid",
      [](Data, Data b)
      {
        for (vtkIdType i = 0; i < b->GetNumberOfTuples(); ++i)
        {
          b->GetArray("azimuth")->SetComponent(i, 0, 2.0 * i);
        }
        b->RemoveArray("laser_id");
      } },
  };
  vtkNew<vtkAvianLidarBeamSource> source;
  source->Update();
  for (const auto& [words, spoil] : cases)
  {
    vtkNew<vtkPolyData> beams;
    beams->DeepCopy(source->GetOutput());
    auto echoes = Echoes({ 16 }, { 50.0 }, { 1e-5 }, { 4 });
    spoil(echoes->GetPointData(), beams->GetPointData());
    vtkNew<Filter> filter;
    filter->SetInputData(0, echoes);
    filter->SetInputData(1, beams);
    filter->SetColumns(960);
    filter->SetRows(16);
    checks::CheckFails(filter, words);
  }
}
}

int TestRangeImage(int, char*[])
{
  TestStrongest();
  TestOtherBeams();
  TestReport();
  TestSize();
  TestBadInput();
  return checks::Result();
}
