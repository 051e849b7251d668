// SPDX-License-Identifier: BSD-3-Clause
// Colours of Eq. 13: ends and middle, limits from field data or given, the lookup table, bad input.
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarHSBColorMap.h"

#include "Checks.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkLookupTable.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Filter = vtkAvianLidarHSBColorMap;
using checks::Check;

const double Nan = std::numeric_limits<double>::quiet_NaN();
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
  vtkNew<Filter> filter;
  checks::Heard heard(filter);
  vtkNew<vtkPolyData> nothing;
  filter->SetInputData(nothing);
  filter->Update();
  Check(heard.Nothing(), "no points: silence");
  auto* output = vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0));
  vtkDataArray* hue = output->GetPointData()->GetArray("hue");
  vtkDataArray* rgb = output->GetPointData()->GetArray("rgb");
  Check(hue && hue->GetNumberOfTuples() == 0 && rgb && rgb->GetNumberOfComponents() == 3,
    "no points: the arrays are there");
  filter->SetInputData(Cloud<vtkPolyData>({ 1.0, Nan, Nan }, 1.0, 3.0));
  filter->Update();
  output = vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0));
  Check(heard.WarningHas("2 values"), "energies that are not numbers are counted");
  Check(std::isnan(output->GetPointData()->GetArray("hue")->GetComponent(1, 0)) &&
      output->GetPointData()->GetArray("rgb")->GetComponent(1, 2) == 0.0,
    "they have no hue and are black");
}

// Arrays and fields of wrong values are tested in TestBadInput.py.
void TestBadInput()
{
  const auto check = [](Filter* filter, vtkPolyData* cloud, const char* words)
  {
    checks::Heard heard(filter);
    filter->SetInputData(cloud);
    filter->Update();
    Check(heard.ErrorHas(words), std::string(words) + " is named");
    Check(vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0))->GetNumberOfPoints() == 0,
      std::string(words) + ": the output is empty");
  };
  auto cloud = Cloud<vtkPolyData>(Energies, 3.0, 1.0);
  check(vtkNew<Filter>(), cloud, "limits in the field data");
  cloud->GetFieldData()->RemoveArray("lower_energy_limit");
  check(vtkNew<Filter>(), cloud, "lower_energy_limit");
  cloud->GetPointData()->RemoveArray("energy");
  check(vtkNew<Filter>(), cloud, "'energy'");
  vtkNew<Filter> filter;
  filter->UseFieldDataRangeOff();
  filter->SetEnergyRange(3.0, 1.0);
  check(filter, Cloud<vtkPolyData>(Energies, 1.0, 3.0), "EnergyRange");
}
}

int TestHSBColorMap(int, char*[])
{
  TestColours();
  TestLookupTable();
  TestLegalButOdd();
  TestBadInput();
  return checks::Result();
}
