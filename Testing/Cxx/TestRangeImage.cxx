// SPDX-License-Identifier: BSD-3-Clause
// The range image: its grid in degrees, the strongest return of each beam, empty cells, and bad
// input.
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
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Filter = vtkAvianLidarRangeImage;
using checks::Check;

struct Echo
{
  vtkIdType beam;
  double distance;
  double received;
  int object;
};

vtkSmartPointer<vtkPolyData> Echoes(const std::vector<Echo>& echoes)
{
  auto cloud = vtkSmartPointer<vtkPolyData>::New();
  const vtkIdType size = static_cast<vtkIdType>(echoes.size());
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(size);
  auto beam = Arrays::Make<vtkIdTypeArray>(Arrays::BeamId, size);
  auto distance = Arrays::Make<vtkDoubleArray>(Arrays::Distance, size);
  auto energy = Arrays::Make<vtkDoubleArray>(Arrays::Energy, size);
  auto received = Arrays::Make<vtkDoubleArray>(Arrays::EnergyReceived, size);
  auto object = Arrays::Make<vtkIntArray>(Arrays::ObjectId, size);
  for (vtkIdType i = 0; i < size; ++i)
  {
    points->SetPoint(i, 0.0, 0.0, 0.0);
    beam->SetValue(i, echoes[i].beam);
    distance->SetValue(i, echoes[i].distance);
    received->SetValue(i, echoes[i].received);
    energy->SetValue(i, std::min(echoes[i].received, 6.25e-5)); // saturates
    object->SetValue(i, echoes[i].object);
  }
  cloud->SetPoints(points);
  for (vtkDataArray* array :
    std::initializer_list<vtkDataArray*>{ beam, distance, energy, received, object })
  {
    cloud->GetPointData()->AddArray(array);
  }
  return cloud;
}

double At(vtkImageData* image, const char* name, int column, int row)
{
  int index[3] = { column, row, 0 };
  return image->GetPointData()->GetArray(name)->GetComponent(image->ComputePointId(index), 0);
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
    Echoes({ { 1605, 300.0, 7e-5, 2 }, { 1605, 500.0, 9e-5, 3 }, { 0, 90.0, 1e-5, 8 },
      { 0, 80.0, 1e-5, 7 }, { 15359, 1234.5, 2.5e-6, 0 } }));
  filter->SetInputConnection(1, source->GetOutputPort());
  filter->Update();
  vtkImageData* image = filter->GetOutput();
  int size[3];
  image->GetDimensions(size);
  Check(size[0] == 960 && size[1] == 16 && size[2] == 1, "columns by rows");
  Check(image->GetOrigin()[0] == 0.0 && image->GetOrigin()[1] == 0.0, "origin in degrees");
  Check(std::abs(image->GetSpacing()[0] - 0.375) < 1e-12 &&
      std::abs(image->GetSpacing()[1] - 0.375) < 1e-12,
    "spacing in degrees");
  Check(At(image, "distance_m", 100, 5) == 500.0 && At(image, "object_id", 100, 5) == 3,
    "the strongest return");
  Check(At(image, "energy", 100, 5) == 6.25e-5, "its energy");
  Check(At(image, "distance_m", 0, 0) == 80.0 && At(image, "object_id", 0, 0) == 7,
    "of equal returns the nearest");
  Check(At(image, "distance_m", 959, 15) == 1234.5, "the last beam");
  Check(std::isnan(At(image, "distance_m", 1, 0)) && std::isnan(At(image, "energy", 1, 0)) &&
      At(image, "object_id", 1, 0) == -1,
    "empty cells");
  vtkIdType filled = 0;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    filled += std::isnan(image->GetPointData()->GetArray("distance_m")->GetComponent(i, 0)) ? 0 : 1;
  }
  Check(filled == 3, "one cell per beam with an echo");
  Check(image->GetFieldData()->GetArray("column_azimuths")->GetNumberOfTuples() == 960 &&
      std::abs(image->GetFieldData()->GetArray("row_elevations")->GetComponent(15, 0) - 5.625) <
        1e-12,
    "the angles are field data");

  // What is downstream learns the extent before this filter executes, also after a change upstream.
  Check(AnnouncedColumns(filter) == 960, "the pipeline knows the size");
  filter->SetInputData(0, Echoes({}));
  source->SetAzimuthRange(-30.0, 30.0);
  Check(AnnouncedColumns(filter) == 160, "the pipeline knows the new size");
  filter->Update();
  Check(std::abs(filter->GetOutput()->GetOrigin()[0] + 30.0) < 1e-9,
    "a sector across north starts below 0");
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
  filter->SetInputData(0, Echoes({ { 3 * 7 + 1, 50.0, 1e-5, 4 } }));
  filter->SetInputConnection(1, source->GetOutputPort());
  filter->Update();
  Check(At(filter->GetOutput(), "distance_m", 7, 2) == 50.0,
    "rows of a table are its elevations, sorted");
  Check(filter->GetOutput()->GetOrigin()[1] == 0.0 && filter->GetOutput()->GetSpacing()[1] == 1.0,
    "rows that are not equally spaced are counted");
  Check(filter->GetOutput()->GetFieldData()->GetArray("row_elevations")->GetComponent(2, 0) == 10.0,
    "their elevations are field data");

  // Beams of somebody's script: directions only, numbered as they come.
  vtkNew<vtkPolyData> bare;
  bare->DeepCopy(source->GetOutput());
  for (const char* name : { "azimuth", "vertical_angle", "beam_id", "laser_id" })
  {
    bare->GetPointData()->RemoveArray(name);
  }
  filter->SetInputData(1, bare);
  filter->SetColumns(960);
  filter->SetRows(3);
  filter->Update();
  Check(At(filter->GetOutput(), "distance_m", 7, 2) == 50.0, "directions are enough");
}

// A beam report of four beams, two of which share a cell.
vtkSmartPointer<vtkPolyData> Report()
{
  auto report = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(4);
  report->SetPoints(points);
  const auto add = [&](auto array, std::initializer_list<double> values)
  {
    for (const double value : values)
    {
      array->InsertNextTuple1(value);
    }
    report->GetPointData()->AddArray(array);
  };
  add(Arrays::Make<vtkIdTypeArray>(Arrays::BeamId), { 10, 11, 12, 13 });
  add(Arrays::Make<vtkDoubleArray>(Arrays::Azimuth), { 0, 100, 200, 100 });
  add(Arrays::Make<vtkDoubleArray>(Arrays::VerticalAngle), { 0, 0, 0, 0 });
  add(Arrays::Make<vtkIntArray>(Arrays::Status), { 0, 2, 1, 3 });
  add(Arrays::Make<vtkIdTypeArray>(Arrays::NodesVisited), { 7, 8, 5000000000.0, 10 });
  add(Arrays::Make<vtkDoubleArray>(Arrays::SkippedBound), { 1e-9, 2e-9, 0, 3e-9 });
  return report;
}

void TestReport()
{
  vtkNew<Filter> filter;
  filter->SetInputData(0, Echoes({}));
  filter->SetInputData(1, Report());
  filter->SetColumns(3);
  filter->SetRows(1);
  filter->Update();
  vtkImageData* image = filter->GetOutput();
  vtkPointData* data = image->GetPointData();
  Check(At(image, "status", 0, 0) == 0 && At(image, "status", 1, 0) == 2 &&
      At(image, "status", 2, 0) == 1 && std::isnan(At(image, "distance_m", 0, 0)),
    "without echoes a cell shows its first beam");
  Check(
    At(image, "nodes_visited", 2, 0) == 5000000000.0 && At(image, "skipped_bound", 1, 0) == 2e-9,
    "large counts and bounds");
  auto* units = vtkDataArray::UNITS_LABEL();
  Check(data->GetArray("skipped_bound")->GetInformation()->Get(units) == std::string("J") &&
      data->GetArray("nodes_visited")->GetInformation()->Get(units) == std::string("1"),
    "their units");
  Check(
    !data->GetArray("candidates") && !data->GetArray("skipped"), "what is not there is not made");

  filter->SetInputData(0, Echoes({ { 13, 20.0, 1e-5, 1 }, { 10, 30.0, 1e-5, 2 } }));
  filter->Update();
  image = filter->GetOutput();
  Check(At(image, "status", 1, 0) == 3 && At(image, "nodes_visited", 1, 0) == 10 &&
      At(image, "distance_m", 1, 0) == 20.0,
    "with echoes a cell shows the beam of the strongest");

  // Three azimuths and two elevations, but four beams: two cells have none.
  auto report = Report();
  report->GetPointData()->GetArray("vertical_angle")->SetComponent(3, 0, 1.0);
  filter->SetInputData(1, report);
  filter->SetRows(2);
  filter->Update();
  image = filter->GetOutput();
  Check(At(image, "status", 0, 1) == -1 && At(image, "nodes_visited", 2, 1) == -1 &&
      std::isnan(At(image, "skipped_bound", 2, 1)) && At(image, "status", 1, 1) == 3,
    "cells without a beam");
}

// What the pipeline announces, or the properties, has to be the grid of the beams.
void TestSize()
{
  for (const auto& [columns, rows] : { std::pair(0, 0), { 3, 0 }, { 1, 3 }, { 3, 1 } })
  {
    vtkNew<Filter> filter;
    checks::Heard heard(filter);
    filter->SetInputData(0, Echoes({}));
    filter->SetInputData(1, Report());
    filter->SetColumns(columns);
    filter->SetRows(rows);
    filter->Update();
    const bool good = rows == 1;
    Check(good ? heard.Nothing() : heard.ErrorHas("form 3 columns and 1 rows"), "size");
    Check(filter->GetOutput()->GetNumberOfPoints() == (good ? 3 : 0), "size of the image");
  }
}

void TestNoBeams()
{
  vtkNew<Filter> filter;
  checks::Heard heard(filter);
  vtkNew<vtkPolyData> nothing;
  filter->SetInputData(0, nothing);
  filter->SetInputData(1, nothing);
  filter->Update();
  Check(filter->GetOutput()->GetNumberOfPoints() == 0, "no beams: no image");
  filter->SetColumns(3);
  filter->SetRows(2);
  filter->Update();
  vtkImageData* image = filter->GetOutput();
  int extent[6];
  image->GetExtent(extent);
  Check(std::equal(extent, extent + 6,
          filter->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT())),
    "no beams: the size that was announced");
  Check(heard.Nothing(), "no beams: no error");
  Check(image->GetNumberOfPoints() == 6 && std::isnan(At(image, "distance_m", 2, 1)) &&
      At(image, "object_id", 0, 0) == -1,
    "no beams: cells without an echo");
}

// Arrays of wrong values are tested in TestBadInput.py.
void TestBadInput()
{
  using Spoil = std::function<void(vtkPointData * echoes, vtkPointData * beams)>;
  const std::vector<std::pair<const char*, Spoil>> cases = {
    { "'beam_id'", [](auto* e, auto*) { e->RemoveArray("beam_id"); } },
    { "'energy_received'", [](auto* e, auto*) { e->RemoveArray("energy_received"); } },
    { "'distance_m'", [](auto* e, auto*) { e->RemoveArray("distance_m"); } },
    { "'energy'", [](auto* e, auto*) { e->RemoveArray("energy"); } },
    { "'object_id'", [](auto* e, auto*) { e->RemoveArray("object_id"); } },
    { "'vertical_angle'", [](auto*, auto* b) { b->RemoveArray("vertical_angle"); } },
    { "'direction'",
      [](auto*, auto* b)
      {
        for (const char* name : { "vertical_angle", "azimuth", "direction" })
        {
          b->RemoveArray(name);
        }
      } },
    { "no beam of input port 1",
      [](auto* e, auto*) { e->GetArray("beam_id")->SetComponent(0, 0, 99999.0); } },
    { "two beams", [](auto*, auto* b) { b->GetArray("beam_id")->SetComponent(5, 0, 4.0); } },
    { "beam 9", [](auto*, auto* b) { b->GetArray("azimuth")->SetComponent(9, 0, NAN); } },
    { "no grid",
      [](auto*, auto* b)
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
    auto echoes = Echoes({ { 16, 50.0, 1e-5, 4 } });
    spoil(echoes->GetPointData(), beams->GetPointData());
    vtkNew<Filter> filter;
    checks::Heard heard(filter);
    filter->SetInputData(0, echoes);
    filter->SetInputData(1, beams);
    filter->SetColumns(960);
    filter->SetRows(16);
    filter->Update();
    Check(heard.ErrorHas(words), std::string(words) + " is named");
    Check(filter->GetOutput()->GetPointData()->GetNumberOfArrays() == 0,
      std::string(words) + ": the image is empty");
  }
}
}

int TestRangeImage(int, char*[])
{
  TestStrongest();
  TestOtherBeams();
  TestReport();
  TestSize();
  TestNoBeams();
  TestBadInput();
  return checks::Result();
}
