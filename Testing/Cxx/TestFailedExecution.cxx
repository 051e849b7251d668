// SPDX-License-Identifier: BSD-3-Clause
// An execution of the collision tree that fails while it writes to arrays kept from the one before
// leaves nothing half written behind: the next one gives what a filter without a past gives.
#include "vtkAvianLidarCollisionTree.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTestErrorObserver.h"

#include <cstdlib>
#include <iostream>
#include <new>
#include <string>
#include <utility>

namespace
{
int Failures = 0;

void Check(bool good, const std::string& what)
{
  if (!good)
  {
    std::cerr << "Failed: " << what << "\n";
    ++Failures;
  }
}

/// Lacks memory, once, when what it observes was modified.
class ShortOfMemory : public vtkCommand
{
public:
  static ShortOfMemory* New() { return new ShortOfMemory; }
  void Execute(vtkObject*, unsigned long, void*) override
  {
    if (!this->Thrown)
    {
      this->Thrown = true;
      throw std::bad_alloc();
    }
  }
  bool Thrown = false;
};

/// A plane of 3200 triangles.
vtkSmartPointer<vtkPolyData> Plane()
{
  constexpr vtkIdType Side = 41;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  for (vtkIdType i = 0; i < Side * Side; ++i)
  {
    points->InsertNextPoint(i % Side, i / Side, 0.0);
    if (i % Side > 0 && i >= Side)
    {
      triangles->InsertNextCell({ i, i - 1, i - Side });
      triangles->InsertNextCell({ i - 1, i - Side - 1, i - Side });
    }
  }
  auto plane = vtkSmartPointer<vtkPolyData>::New();
  plane->SetPoints(points);
  plane->SetPolys(triangles);
  return plane;
}

/// Other coefficients for the first cells, in new arrays, as a filter upstream would bring them.
void Paint(vtkPolyData* surface, double kd)
{
  const std::pair<const char*, double> coefficients[] = { { "kd", kd }, { "ks", kd / 2 },
    { "kp", 100 * kd } };
  for (const auto& [name, value] : coefficients)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->SetNumberOfTuples(surface->GetNumberOfCells());
    array->FillValue(0.1);
    for (vtkIdType i = 0; i < 100; ++i)
    {
      array->SetValue(i, value);
    }
    surface->GetCellData()->AddArray(array);
  }
  surface->Modified();
}

bool SameCells(vtkPolyData* a, vtkPolyData* b)
{
  const auto count = [](vtkPolyData* data) { return data->GetCellData()->GetNumberOfArrays(); };
  bool same = count(a) == count(b) && a->GetNumberOfCells() == b->GetNumberOfCells();
  for (int k = 0; same && k < count(b); ++k)
  {
    vtkDataArray* y = b->GetCellData()->GetArray(k);
    vtkDataArray* x = a->GetCellData()->GetArray(y->GetName());
    same = x && x->GetNumberOfTuples() == y->GetNumberOfTuples();
    for (vtkIdType i = 0; same && i < y->GetNumberOfTuples(); ++i)
    {
      same = x->GetComponent(i, 0) == y->GetComponent(i, 0);
    }
  }
  return same;
}

/// The output is that of a filter that never ran before.
bool IsFresh(vtkAvianLidarCollisionTree* tree, vtkPolyData* surface)
{
  vtkNew<vtkAvianLidarCollisionTree> fresh;
  fresh->SetInputData(surface);
  fresh->Update();
  return fresh->GetOutput()->GetNumberOfCells() > 1024 &&
    SameCells(tree->GetOutput(), fresh->GetOutput());
}
}

int TestFailedExecution(int, char*[])
{
  const vtkSmartPointer<vtkPolyData> surface = Plane();
  vtkNew<vtkTest::ErrorObserver> errors;
  vtkNew<vtkAvianLidarCollisionTree> tree;
  tree->AddObserver(vtkCommand::ErrorEvent, errors);
  tree->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, errors);
  tree->SetInputData(surface);
  for (const char* name : { "kd", "ks", "kp" })
  {
    // Then comes what was there before the failure, or what was to be there.
    for (const double next : { 0.2, 0.3 })
    {
      const std::string where = std::string(" ") + name + ", then " + std::to_string(next);
      Paint(surface, 0.2);
      tree->Update();
      Check(IsFresh(tree, surface), "before" + where);
      vtkNew<ShortOfMemory> failure;
      if (vtkDataArray* array = tree->GetOutput()->GetCellData()->GetArray(name))
      {
        array->AddObserver(vtkCommand::ModifiedEvent, failure);
      }
      Paint(surface, 0.3);
      tree->Update();
      Check(failure->Thrown && errors->GetError(), "failure of" + where);
      errors->Clear();
      Check(tree->GetOutput()->GetNumberOfCells() == 0, "empty after" + where);
      Paint(surface, next);
      tree->Update();
      Check(!errors->GetError() && IsFresh(tree, surface), "after" + where);
    }
  }
  return Failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
