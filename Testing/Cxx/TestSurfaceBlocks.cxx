// SPDX-License-Identifier: BSD-3-Clause
// A scene of many blocks costs what one block of the same triangles costs. Times are left to the
// benchmarks: what is compared here is the memory that is asked for, which is the same on every
// machine. A vector that grows to the exact size for each block asks for a multiple of the scene.
#include "vtkAvianLidarCollisionTree.h"

#include "vtkCellArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <new>

namespace
{
std::atomic<std::size_t> Bytes{ 0 }; // asked for since the beginning

constexpr int Blocks = 4000;
}

// Those of the whole executable, and of the libraries that it uses.
void* operator new(std::size_t size)
{
  Bytes += size;
  if (void* place = std::malloc(size > 0 ? size : 1))
  {
    return place;
  }
  throw std::bad_alloc();
}

// The sanitizers' form does not call the one above, but its memory would be freed below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
  Bytes += size;
  return std::malloc(size > 0 ? size : 1);
}

void operator delete(void* place) noexcept
{
  std::free(place);
}

void operator delete(void* place, std::size_t) noexcept
{
  std::free(place);
}

namespace
{
/// Bytes asked for while a scene is merged and its tree is built.
double BytesOf(vtkDataObject* surfaces)
{
  vtkNew<vtkAvianLidarCollisionTree> tree;
  tree->SetInputData(surfaces);
  tree->GlobalWarningDisplayOff(); // no materials
  const std::size_t before = Bytes;
  tree->Update();
  tree->GlobalWarningDisplayOn();
  return static_cast<double>(Bytes - before);
}

/// Plates of 50 triangles each, one above the other. @param first number of the lowest
vtkSmartPointer<vtkPolyData> PlatesOf(int first, int count)
{
  constexpr int Side = 5;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  for (int plate = first; plate < first + count; ++plate)
  {
    const vtkIdType corner = points->GetNumberOfPoints();
    for (int i = 0; i < (Side + 1) * (Side + 1); ++i)
    {
      points->InsertNextPoint(i % (Side + 1), i / (Side + 1), 0.01 * plate);
    }
    for (int i = 0; i < Side * Side; ++i)
    {
      const vtkIdType p = corner + i % Side + (i / Side) * (Side + 1);
      triangles->InsertNextCell({ p, p + 1, p + Side + 2 });
      triangles->InsertNextCell({ p, p + Side + 2, p + Side + 1 });
    }
  }
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  poly->SetPoints(points);
  poly->SetPolys(triangles);
  return poly;
}
}

int TestSurfaceBlocks(int, char*[])
{
  const vtkSmartPointer<vtkPolyData> whole = PlatesOf(0, Blocks);
  vtkNew<vtkMultiBlockDataSet> blocks;
  for (int block = 0; block < Blocks; ++block)
  {
    blocks->SetBlock(block, PlatesOf(block, 1));
  }
  const double one = BytesOf(whole);
  const double many = BytesOf(blocks);
  std::cout << whole->GetNumberOfPolys() << " triangles: " << one
            << " bytes asked for as one block, " << many / one << " times that as " << Blocks
            << "\n";
  if (one < 1e7 || many > 3.0 * one)
  {
    std::cerr << "Failed: expected at most 3 times, for what each block needs besides\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
