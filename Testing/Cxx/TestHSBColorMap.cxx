// SPDX-License-Identifier: BSD-3-Clause
// Colours of Eq. 13: limits from field data or given, equal ones, any array, the lookup table,
// energies that are not numbers, bad limits.
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarHSBColorMap.h"

#include "Checks.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkLookupTable.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <cmath>
#include <string>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Filter = vtkAvianLidarHSBColorMap;
using checks::At;
using checks::Check;

// Limits 1 and 3: hue 240, 180, 120, 60, 0, both ends again outside, and between (paper, Eq. 13).
const std::vector<double> Energies{ 1.0, 1.5, 2.0, 2.5, 3.0, 0.0, 9.0, 2.75, 2.25 };
const double Hues[] = { 240.0, 180.0, 120.0, 60.0, 0.0, 240.0, 0.0, 30.0, 90.0 };
const double Colours[][3] = { { 0, 0, 255 }, { 0, 255, 255 }, { 0, 255, 0 }, { 255, 255, 0 },
  { 255, 0, 0 }, { 0, 0, 255 }, { 255, 0, 0 }, { 255, 128, 0 }, { 128, 255, 0 } };

/// The energies in an array of a name.
template <class SetT, class ArrayT = vtkDoubleArray>
vtkSmartPointer<SetT> Cloud(
  const std::vector<double>& energies, double lower, double upper, const char* name = "energy")
{
  auto cloud = vtkSmartPointer<SetT>::New();
  vtkNew<vtkPoints> points;
  vtkNew<ArrayT> array;
  array->SetName(name);
  for (double energy : energies)
  {
    points->InsertNextPoint(0.0, 0.0, 0.0);
    array->InsertNextTuple1(energy);
  }
  cloud->SetPoints(points);
  cloud->GetPointData()->AddArray(array);
  Arrays::SetFieldValue(cloud->GetFieldData(), Arrays::LowerEnergyLimit, lower);
  Arrays::SetFieldValue(cloud->GetFieldData(), Arrays::UpperEnergyLimit, upper);
  return cloud;
}

vtkPointData* Output(Filter* filter, vtkDataObject* input)
{
  filter->SetInputData(input);
  filter->Update();
  return vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0))->GetPointData();
}

void CheckColours(vtkPointData* output, const std::string& what)
{
  for (vtkIdType i = 0; i < 9; ++i)
  {
    Check(std::abs(At(output, "hue", i) - Hues[i]) < 1e-12, what + ": hue " + std::to_string(i));
    for (int c = 0; c < 3; ++c)
    {
      Check(At(output, "rgb", i, c) == Colours[i][c], what + ": colour " + std::to_string(i));
    }
  }
}

void TestColours()
{
  vtkNew<Filter> filter;
  CheckColours(Output(filter, Cloud<vtkPolyData>(Energies, 1.0, 3.0)), "limits from field data");
  Check(filter->GetLookupTable()->GetTableRange()[1] == 3.0, "the table has them");
  filter->UseFieldDataRangeOff();
  filter->SetEnergyRange(1.0, 3.0);
  CheckColours(Output(filter, Cloud<vtkUnstructuredGrid>(Energies, 5.0, 6.0)), "limits given");
  Check(vtkUnstructuredGrid::SafeDownCast(filter->GetOutputDataObject(0)), "the type is kept");
  filter->SetEnergyRange(2.0, 2.0);
  Check(
    At(Output(filter, Cloud<vtkPolyData>({ 2.0 }, 1.0, 3.0)), "hue") == 0.0, "equal limits: red");
  filter->SetEnergyRange(1.0, 3.0);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "other");
  CheckColours(Output(filter, Cloud<vtkPolyData, vtkFloatArray>(Energies, 1.0, 3.0, "other")),
    "another array");
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
    double rgb[3];
    filter->GetLookupTable()->GetColor(Energies[i], rgb);
    for (int c = 0; c < 3; ++c)
    {
      Check(std::abs(table->GetTableValue(i)[c] - Colours[i][c] / 255.0) < 1e-12, "five colours");
      Check(std::abs(rgb[c] - Colours[i][c] / 255.0) < 0.03, "the width of a colour");
    }
  }
}

void TestOddAndBad()
{
  vtkNew<Filter> filter;
  checks::Heard heard(filter);
  vtkPointData* data = Output(filter, vtkNew<vtkPolyData>());
  Check(heard.Nothing() && data->HasArray("hue") && data->HasArray("rgb"), "no points: silence");
  data = Output(filter, Cloud<vtkPolyData>({ 1.0, NAN, NAN }, 1.0, 3.0));
  Check(heard.WarningHas("2 values"), "energies that are not numbers are counted");
  Check(std::isnan(At(data, "hue", 1)) && At(data, "rgb", 1, 2) == 0.0, "no hue, and black");

  // Arrays and fields of wrong values are tested in TestBadInput.py.
  auto cloud = Cloud<vtkPolyData>(Energies, 3.0, 1.0);
  filter->SetInputData(cloud);
  checks::CheckFails(filter, "limits in the field data");
  cloud->GetFieldData()->RemoveArray("lower_energy_limit");
  filter->Modified();
  checks::CheckFails(filter, "lower_energy_limit");
  cloud->GetPointData()->RemoveArray("energy");
  filter->Modified();
  checks::CheckFails(filter, "'energy'");
  filter->UseFieldDataRangeOff();
  filter->SetEnergyRange(3.0, 1.0);
  filter->SetInputData(Cloud<vtkPolyData>(Energies, 1.0, 3.0));
  checks::CheckFails(filter, "EnergyRange");
}
}

int TestHSBColorMap(int, char*[])
{
  TestColours();
  TestLookupTable();
  TestOddAndBad();
  return checks::Result();
}
