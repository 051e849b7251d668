// SPDX-License-Identifier: BSD-3-Clause
// Colours of Eq. 13: ends and middle, limits from field data or given, the lookup table, bad input.
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarHSBColorMap.h"

#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFloatArray.h"
#include "vtkLookupTable.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTestErrorObserver.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Filter = vtkAvianLidarHSBColorMap;

const double Nan = std::numeric_limits<double>::quiet_NaN();
int Failures = 0;

void Check(bool good, const std::string& what)
{
  if (!good)
  {
    std::cerr << "Failed: " << what << "\n";
    ++Failures;
  }
}

template <class SetT>
vtkSmartPointer<SetT> Cloud(const std::vector<double>& energies, double lower, double upper)
{
  auto cloud = vtkSmartPointer<SetT>::New();
  vtkNew<vtkPoints> points;
  auto array = Arrays::Make<vtkDoubleArray>(Arrays::Energy);
  for (double energy : energies)
  {
    points->InsertNextPoint(0.0, 0.0, 0.0);
    array->InsertNextValue(energy);
  }
  cloud->SetPoints(points);
  cloud->GetPointData()->AddArray(array);
  Arrays::SetFieldValue(cloud->GetFieldData(), Arrays::LowerEnergyLimit, lower);
  Arrays::SetFieldValue(cloud->GetFieldData(), Arrays::UpperEnergyLimit, upper);
  return cloud;
}

// Limits 1 and 3: hue 240, 180, 120, 60, 0, and both ends again outside.
const std::vector<double> Energies{ 1.0, 1.5, 2.0, 2.5, 3.0, 0.0, 9.0 };
const double Hues[] = { 240.0, 180.0, 120.0, 60.0, 0.0, 240.0, 0.0 };
const unsigned char Colours[][3] = { { 0, 0, 255 }, { 0, 255, 255 }, { 0, 255, 0 }, { 255, 255, 0 },
  { 255, 0, 0 }, { 0, 0, 255 }, { 255, 0, 0 } };

void CheckColours(vtkPointSet* output, const std::string& what)
{
  vtkDataArray* hue = output->GetPointData()->GetArray("hue");
  auto* rgb = vtkUnsignedCharArray::SafeDownCast(output->GetPointData()->GetArray("rgb"));
  Check(hue && rgb && rgb->GetNumberOfComponents() == 3, what + ": arrays");
  for (vtkIdType i = 0; hue && rgb && i < 7; ++i)
  {
    Check(std::abs(hue->GetComponent(i, 0) - Hues[i]) < 1e-12, what + ": hue " + std::to_string(i));
    for (int c = 0; c < 3; ++c)
    {
      Check(rgb->GetTypedComponent(i, c) == Colours[i][c], what + ": colour " + std::to_string(i));
    }
  }
}

void TestColours()
{
  vtkNew<Filter> filter;
  filter->SetInputData(Cloud<vtkPolyData>(Energies, 1.0, 3.0));
  filter->Update();
  CheckColours(vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0)), "limits from field data");
  Check(filter->GetLookupTable()->GetTableRange()[1] == 3.0,
    "the table has the limits of the field data");

  filter->SetInputData(Cloud<vtkUnstructuredGrid>(Energies, 5.0, 6.0));
  filter->UseFieldDataRangeOff();
  filter->SetEnergyRange(1.0, 3.0);
  filter->Update();
  Check(vtkUnstructuredGrid::SafeDownCast(filter->GetOutputDataObject(0)) != nullptr,
    "the type of points is kept");
  CheckColours(vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0)), "limits given");

  // Another array, of another type.
  auto cloud = Cloud<vtkPolyData>(std::vector<double>(7, 0.0), 1.0, 3.0);
  vtkNew<vtkFloatArray> other;
  other->SetName("return_energy");
  for (double energy : Energies)
  {
    other->InsertNextValue(static_cast<float>(energy));
  }
  cloud->GetPointData()->AddArray(other);
  filter->SetInputData(cloud);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "return_energy");
  filter->Update();
  CheckColours(vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0)), "another array");

  filter->SetEnergyRange(2.0, 2.0);
  filter->Update();
  Check(vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0))
          ->GetPointData()
          ->GetArray("hue")
          ->GetRange()[1] == 0.0,
    "equal limits: hue 0");
}

void TestLookupTable()
{
  vtkNew<Filter> filter;
  filter->SetEnergyRange(1.0, 3.0);
  vtkNew<vtkLookupTable> table;
  table->SetNumberOfTableValues(5);
  filter->FillLookupTable(table);
  Check(table->GetTableRange()[0] == 1.0 && table->GetTableRange()[1] == 3.0, "range of the table");
  for (int i = 0; i < 5; ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      Check(std::abs(table->GetTableValue(i)[c] - Colours[i][c] / 255.0) < 1e-12,
        "colours of the table");
    }
  }
  // With many colours the table agrees with the filter to the width of a colour.
  vtkLookupTable* fine = filter->GetLookupTable();
  double rgb[3];
  fine->GetColor(1.0, rgb);
  Check(rgb[2] == 1.0 && rgb[0] == 0.0 && rgb[1] == 0.0, "Qlow is blue");
  fine->GetColor(3.0, rgb);
  Check(rgb[0] == 1.0 && rgb[1] == 0.0 && rgb[2] == 0.0, "Qhigh is red");
  fine->GetColor(0.0, rgb);
  Check(rgb[2] == 1.0, "below is blue");
}

void TestLegalButOdd()
{
  vtkNew<vtkTest::ErrorObserver> observer;
  vtkNew<Filter> filter;
  filter->AddObserver(vtkCommand::ErrorEvent, observer);
  filter->AddObserver(vtkCommand::WarningEvent, observer);
  vtkNew<vtkPolyData> nothing;
  filter->SetInputData(nothing);
  filter->Update();
  Check(!observer->GetError() && !observer->GetWarning(), "no points: silence");
  vtkPointData* none = vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0))->GetPointData();
  Check(none->GetArray("hue") && none->GetArray("hue")->GetNumberOfTuples() == 0,
    "no points: the array of hues is there");
  Check(none->GetArray("rgb") && none->GetArray("rgb")->GetNumberOfComponents() == 3 &&
      none->GetArray("rgb")->GetNumberOfTuples() == 0,
    "no points: the array of colours is there");
  filter->SetInputData(Cloud<vtkPolyData>({ 1.0, Nan, Nan }, 1.0, 3.0));
  filter->Update();
  auto* output = vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0));
  Check(observer->GetWarningMessage().find("2 values") != std::string::npos,
    "energies that are not numbers are counted");
  Check(std::isnan(output->GetPointData()->GetArray("hue")->GetComponent(1, 0)),
    "their hue is not a number");
  Check(output->GetPointData()->GetArray("rgb")->GetComponent(1, 2) == 0.0, "they are black");
}

void TestBadInput()
{
  const struct
  {
    const char* names;
    std::function<void(Filter*, vtkPolyData*)> spoil;
  } cases[] = {
    { "'energy'", [](Filter*, vtkPolyData* d) { d->GetPointData()->RemoveArray("energy"); } },
    { "2 components",
      [](Filter*, vtkPolyData* d)
      { d->GetPointData()->AddArray(Arrays::Make<vtkDoubleArray>(Arrays::Energy, 7, 2)); } },
    { "lower_energy_limit",
      [](Filter*, vtkPolyData* d) { d->GetFieldData()->RemoveArray("lower_energy_limit"); } },
    { "upper_energy_limit",
      [](Filter*, vtkPolyData* d)
      { Arrays::SetFieldValue(d->GetFieldData(), Arrays::UpperEnergyLimit, Nan); } },
    { "limits in the field data",
      [](Filter*, vtkPolyData* d)
      { Arrays::SetFieldValue(d->GetFieldData(), Arrays::UpperEnergyLimit, 0.5); } },
    { "EnergyRange",
      [](Filter* f, vtkPolyData*)
      {
        f->UseFieldDataRangeOff();
        f->SetEnergyRange(3.0, 1.0);
      } },
    { "EnergyRange",
      [](Filter* f, vtkPolyData*)
      {
        f->UseFieldDataRangeOff();
        f->SetEnergyRange(Nan, 1.0);
      } },
  };
  for (const auto& c : cases)
  {
    vtkNew<vtkTest::ErrorObserver> observer;
    vtkNew<Filter> filter;
    filter->AddObserver(vtkCommand::ErrorEvent, observer);
    filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
    auto cloud = Cloud<vtkPolyData>(Energies, 1.0, 3.0);
    c.spoil(filter, cloud);
    filter->SetInputData(cloud);
    filter->Update();
    Check(observer->GetErrorMessage().find(c.names) != std::string::npos,
      std::string(c.names) + " is named: " + observer->GetErrorMessage());
    Check(vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0))->GetNumberOfPoints() == 0,
      std::string(c.names) + ": the output is empty");
  }
}
}

int TestHSBColorMap(int, char*[])
{
  TestColours();
  TestLookupTable();
  TestLegalButOdd();
  TestBadInput();
  return Failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
