// SPDX-License-Identifier: BSD-3-Clause
// The material filter: coefficients of Table 1, ids and names, blocks by pattern, shallow copies.
// Bad properties are tested in TestBadInput.py.
#include "vtkAvianLidarMaterial.h"

#include "Checks.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkInformation.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPlaneSource.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <limits>
#include <string>

namespace
{
using Filter = vtkAvianLidarMaterial;
using checks::Check;

vtkSmartPointer<vtkPolyData> Plane(int cells)
{
  vtkNew<vtkPlaneSource> plane;
  plane->SetXResolution(cells);
  plane->Update();
  return plane->GetOutput();
}

// The one value of a cell array, or NaN if it is missing or holds several.
double Cells(vtkDataObject* data, const char* name)
{
  auto* surface = vtkPolyData::SafeDownCast(data);
  vtkDataArray* array = surface->GetCellData()->GetArray(name);
  const bool one = array && array->GetNumberOfTuples() == surface->GetNumberOfCells() &&
    array->GetRange()[0] == array->GetRange()[1];
  return one ? array->GetComponent(0, 0) : std::numeric_limits<double>::quiet_NaN();
}

std::string Text(vtkDataObject* data, const char* name, vtkIdType index)
{
  auto* array = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(name));
  return array && index < array->GetNumberOfValues() ? std::string(array->GetValue(index))
                                                     : "(none)";
}

vtkDataObject* Output(Filter* filter)
{
  filter->Update();
  return filter->GetOutputDataObject(0);
}

void SetBlock(
  vtkMultiBlockDataSet* scene, unsigned int number, vtkDataObject* block, const char* name)
{
  scene->SetBlock(number, block);
  scene->GetMetaData(number)->Set(vtkCompositeDataSet::NAME(), name);
}

// Two buildings in a group, a tower, and an empty place.
vtkSmartPointer<vtkMultiBlockDataSet> Scene()
{
  vtkNew<vtkMultiBlockDataSet> group;
  SetBlock(group, 0, Plane(1), "hangar 1");
  SetBlock(group, 1, Plane(2), "hangar 2");
  auto scene = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  scene->SetBlock(0, nullptr);
  SetBlock(scene, 1, group, "buildings");
  SetBlock(scene, 2, Plane(3), "tower");
  return scene;
}

vtkDataObject* Leaf(vtkDataObject* scene, int number)
{
  auto* tree = vtkCompositeDataSet::SafeDownCast(scene);
  auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(tree->NewIterator());
  for (iterator->InitTraversal(); number > 0; --number)
  {
    iterator->GoToNextItem();
  }
  return iterator->GetCurrentDataObject();
}

void TestTable1()
{
  const struct
  {
    void (Filter::*choose)();
    const char* name;
    double kd, ks, kp;
  } rows[] = {
    { &Filter::SetMaterialToWall, "Wall", 0.146, 0.054, 112 },
    { &Filter::SetMaterialToGlass, "Glass", 0.020, 0.852, 8046 },
    { &Filter::SetMaterialToMetal, "Metal", 0.075, 0.634, 6803 },
    { &Filter::SetMaterialToWood, "Wood", 0.107, 0.100, 82 },
    // USGS Spectral Library 7 at 905 nm; plumage is assumed. They come behind the four.
    { &Filter::SetMaterialToConcrete, "Concrete", 0.3104, 0, 1 },
    { &Filter::SetMaterialToAsphalt, "Asphalt", 0.1298, 0, 1 },
    { &Filter::SetMaterialToGrass, "Grass", 0.2204, 0, 1 },
    { &Filter::SetMaterialToPlumage, "Plumage", 0.3, 0, 1 },
  };
  int id = 0;
  for (const auto& row : rows)
  {
    vtkNew<Filter> filter;
    filter->SetInputData(Plane(4));
    (filter.Get()->*row.choose)();
    vtkDataObject* output = Output(filter);
    Check(Cells(output, "kd") == row.kd && Cells(output, "ks") == row.ks &&
        Cells(output, "kp") == row.kp,
      std::string(row.name) + ": coefficients");
    Check(Cells(output, "material_id") == id && Text(output, "material_names", id) == row.name &&
        Cells(output, "object_id") == 0,
      std::string(row.name) + ": ids and name");
    id = std::min(id + 1, 4);
  }
}

void TestCustomAndNames()
{
  vtkSmartPointer<vtkPolyData> plane = Plane(4);
  vtkNew<Filter> filter;
  filter->SetInputData(plane);
  filter->SetMaterialToCustom();
  filter->SetKd(0.3);
  filter->SetKs(0.7); // the sum is exactly allowed
  filter->SetKp(1e6);
  filter->SetRoughness(0.4);
  filter->SetObjectId(7);
  filter->SetNameOfObject("mirror");
  auto* output = vtkPolyData::SafeDownCast(Output(filter));
  Check(Cells(output, "kd") == 0.3 && Cells(output, "ks") == 0.7 && Cells(output, "kp") == 1e6 &&
      Cells(output, "roughness") == 0.4,
    "custom coefficients");
  Check(Cells(output, "material_id") == 4 && Text(output, "material_names", 4) == "Custom",
    "custom is material 4");
  Check(Cells(output, "object_id") == 7 && Text(output, "object_names", 0) == "mirror",
    "object id and name");
  Check(output->GetPoints() == plane->GetPoints() && output->GetPolys() == plane->GetPolys() &&
      plane->GetCellData()->GetNumberOfArrays() == 0 &&
      plane->GetFieldData()->GetNumberOfArrays() == 0,
    "a shallow copy, and the input stays as it was");

  // A second filter behind the first: the material is new, the object stays.
  vtkNew<Filter> second;
  second->SetInputConnection(filter->GetOutputPort());
  second->SetMaterialToWood();
  vtkDataObject* again = Output(second);
  Check(Cells(again, "material_id") == 3 && Cells(again, "kd") == 0.107, "the last material holds");
  Check(Cells(again, "object_id") == 7 && Text(again, "object_names", 0) == "mirror" &&
      Text(again, "material_names", 4) == "Custom",
    "the object and known materials are kept");

  // A third gives a name alone; on surfaces without a material there is none behind it either.
  vtkNew<Filter> third;
  third->SetInputConnection(second->GetOutputPort());
  third->SetMaterial(Filter::MATERIAL_UNCHANGED);
  third->SetNameOfObject("door");
  vtkDataObject* named = Output(third);
  Check(Cells(named, "material_id") == 3 && Cells(named, "object_id") == 7 &&
      Text(named, "object_names", 0) == "door",
    "the material is kept, the object has another name");
  third->SetInputData(plane);
  named = Output(third);
  Check(named->GetAttributes(vtkDataObject::CELL)->GetNumberOfArrays() == 1 &&
      Cells(named, "object_id") == 0 && Text(named, "object_names", 0) == "door",
    "a name is no material");
}

void TestComposite()
{
  vtkSmartPointer<vtkMultiBlockDataSet> scene = Scene();
  vtkNew<Filter> filter;
  filter->SetInputData(scene);
  filter->SetMaterialToMetal();
  filter->SetBlockNamePattern("hangar*");
  vtkNew<Filter> glass;
  glass->SetInputConnection(filter->GetOutputPort());
  glass->SetMaterialToGlass();
  glass->SetBlockNamePattern("tower");
  for (vtkDataObject* plain : { Leaf(Output(filter), 2), Leaf(scene, 0) })
  {
    Check(plain->GetAttributes(vtkDataObject::CELL)->GetNumberOfArrays() == 0,
      "the tower is passed on, the input stays as it was");
  }
  vtkDataObject* output = Output(glass);
  for (int leaf = 0; leaf < 3; ++leaf)
  {
    Check(Cells(Leaf(output, leaf), "object_id") == leaf &&
        Cells(Leaf(output, leaf), "material_id") == (leaf == 2 ? 1 : 2),
      "leaves are objects, numbered in leaf order; hangars are metal, the tower is glass");
  }
  Check(Text(Leaf(output, 1), "object_names", 0) == "hangar 2", "a leaf takes the block's name");

  // The name of a group picks its leaves; no pattern is any.
  for (const auto& [pattern, metal] : { std::pair("build*", 2), { "*", 3 }, { "", 3 } })
  {
    filter->SetBlockNamePattern(pattern);
    int found = 0;
    for (int leaf = 0; leaf < 3; ++leaf)
    {
      found += Cells(Leaf(Output(filter), leaf), "material_id") == 2;
    }
    Check(found == metal, std::string("blocks of the pattern '") + pattern + "'");
  }

  // Custom comes behind the scene's own materials, in every leaf and in the whole.
  vtkNew<vtkStringArray> names;
  names->SetName("material_names");
  for (const char* name : { "Wall", "Glass", "Metal", "Wood", "Grass" })
  {
    names->InsertNextValue(name);
  }
  scene->GetFieldData()->AddArray(names);
  filter->SetMaterialToCustom();
  output = Output(filter);
  Check(Cells(Leaf(output, 0), "material_id") == 5 &&
      Text(Leaf(output, 0), "material_names", 5) == "Custom" &&
      Text(output, "material_names", 4) == "Grass" && Text(output, "material_names", 5) == "Custom",
    "custom comes behind the scene's own materials");
  Check(names->GetNumberOfValues() == 5, "the input's names stay as they were");
}

void TestOddBlocks()
{
  vtkNew<Filter> filter;
  checks::Heard heard(filter);
  vtkNew<vtkPolyData> nothing;
  filter->SetInputData(nothing);
  vtkDataObject* empty = Output(filter);
  Check(heard.Nothing() && empty->GetAttributes(vtkDataObject::CELL)->HasArray("kp"),
    "empty surfaces get the arrays, silently");
  vtkSmartPointer<vtkMultiBlockDataSet> scene = Scene();
  SetBlock(scene, 3, vtkNew<vtkUnstructuredGrid>(), "volume");
  filter->SetInputData(scene);
  filter->SetBlockNamePattern("tower");
  filter->Update();
  Check(heard.Nothing(), "a block that is not chosen may be anything");
  filter->SetBlockNamePattern("*");
  filter->Update();
  Check(heard.ErrorHas("volume"), "a chosen block that is no surface is named");
  filter->SetBlockNamePattern("castle*");
  filter->Update();
  Check(heard.WarningHas("castle*"), "a pattern that fits no block is a warning");
}
}

int TestMaterial(int, char*[])
{
  TestTable1();
  TestCustomAndNames();
  TestComposite();
  TestOddBlocks();
  return checks::Result();
}
