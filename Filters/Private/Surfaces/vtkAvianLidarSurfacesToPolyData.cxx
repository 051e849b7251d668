// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarMedia.h"
#include "vtkAvianLidarSlices.h"
#include "vtkAvianLidarSurfaceLeaf.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

/// The slice of all leaves if it holds the given values, else a new array with these values.
/// @param slices an array of each leaf @param placeOf,valueOf functions from 0 to `count` - 1 to
/// the place of a value in the array, and to the value
template <class ArrayT, class Place, class F>
vtkSmartPointer<ArrayT> Share(const std::vector<vtkDataArray*>& slices, const Arrays::Name& name,
  std::size_t count, int components, const Place& placeOf, const F& valueOf)
{
  const auto values = static_cast<vtkIdType>(count);
  auto array = vtkAvianLidarSlices::Join<ArrayT>(slices);
  bool isEqual = array && array->GetNumberOfValues() == values;
  for (std::size_t i = 0; i < count && isEqual; ++i)
  {
    isEqual = array->GetValue(placeOf(i)) == valueOf(i);
  }
  if (!isEqual)
  {
    array = Arrays::Make<ArrayT>(name, values / components, components);
    for (std::size_t i = 0; i < count; ++i)
    {
      array->SetValue(placeOf(i), valueOf(i));
    }
  }
  return array;
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarSurfaces::ToPolyData(
  vtkFieldData* fields, vtkDataObject* input) const
{
  constexpr std::size_t coefficients = std::size(avianlidar::MaterialCoefficients);
  std::vector<vtkDataArray*> ofPoints;
  std::vector<vtkDataArray*> ofCells[2 + coefficients];
  std::string ignored;
  for (const vtkAvianLidarSurfaceLeaf& leaf : vtkAvianLidarSurfaceLeaf::Collect(input, ignored))
  {
    if (leaf.data->GetNumberOfPolys() > 0 && leaf.data->GetPoints() &&
      !vtkAvianLidarMedia::IsMedium(leaf.data))
    {
      ofPoints.push_back(leaf.data->GetPoints()->GetData());
      std::size_t k = 0;
      for (vtkDataArray* array : vtkAvianLidarSurfaceArrays(leaf.data).Numbers())
      {
        ofCells[k++].push_back(array);
      }
    }
  }
  const auto pointOf = [](std::size_t i) { return static_cast<vtkIdType>(i); };
  // Cells are in the order of the input.
  const bool isSorted = !this->order || this->order->empty();
  const auto cellOf = [&](std::size_t i)
  { return static_cast<vtkIdType>(isSorted ? i : (*this->order)[i]); };
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  const std::vector<avianlidar::Vec3>& from = this->mesh->points;
  vtkNew<vtkPoints> points;
  points->SetData(Share<vtkDoubleArray>(ofPoints, { "Points", "" }, 3 * from.size(), 3, pointOf,
    [&](std::size_t i) { return from[i / 3][static_cast<int>(i % 3)]; }));
  poly->SetPoints(points);
  poly->SetPolys(vtkAvianLidarMakeTriangles(this->mesh->triangles, cellOf));
  const std::size_t count = this->materials.size();
  vtkCellData* cells = poly->GetCellData();
  cells->AddArray(Share<vtkIntArray>(ofCells[0], Arrays::ObjectId, count, 1, cellOf,
    [&](std::size_t i) { return this->objectIds[i]; }));
  cells->AddArray(Share<vtkIntArray>(ofCells[1], Arrays::MaterialId, count, 1, cellOf,
    [&](std::size_t i) { return this->materialIds[i]; }));
  for (std::size_t k = 0; k < coefficients; ++k)
  {
    const avianlidar::MaterialCoefficient& coefficient = avianlidar::MaterialCoefficients[k];
    cells->AddArray(Share<vtkDoubleArray>(ofCells[2 + k], { coefficient.name, coefficient.unit },
      count, 1, cellOf, [&](std::size_t i) { return this->materials[i].*coefficient.member; }));
  }
  if (fields)
  {
    poly->GetFieldData()->PassData(fields);
  }
  Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::ObjectNames, this->objectNames);
  if (!this->objectClasses.empty())
  {
    Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::ObjectClasses, this->objectClasses);
  }
  Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::MaterialNames, this->materialNames);
  if (!this->media.empty())
  {
    Arrays::SetFieldStrings(poly->GetFieldData(), Arrays::Media, this->media);
  }
  return poly;
}
