// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceState.h"

#include "Hash.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarSurfaceLeaf.h"

#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <string_view>

namespace vtkAvianLidarSurfaceState
{
namespace Content = vtkAvianLidarContent;
using avianlidar::hashOf;

//------------------------------------------------------------------------------
std::uint64_t HashOfNames(vtkFieldData* fields, std::uint64_t seed)
{
  for (const auto& name : vtkAvianLidarArrays::SurfaceTexts)
  {
    vtkAbstractArray* array = fields ? fields->GetAbstractArray(name.name) : nullptr;
    auto* names = vtkStringArray::SafeDownCast(array);
    constexpr vtkIdType none = -1;
    constexpr vtkIdType noText = -2; // an error: another state than none
    const vtkIdType count = names ? names->GetNumberOfValues() : array ? noText : none;
    seed = hashOf(&count, sizeof(count), seed);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const std::string& text = names->GetValue(i);
      seed = hashOf(text.data(), text.size(), seed);
    }
  }
  return seed;
}

//------------------------------------------------------------------------------
std::uint64_t HashOf(vtkPolyData* poly)
{
  const vtkAvianLidarSurfaceArrays arrays(poly);
  std::uint64_t hash = HashOfNames(poly->GetFieldData(), 0);
  hash = Content::HashOf(arrays.ghosts, Content::HashOfGeometry(poly, hash));
  // An array without numbers is an error: another state than no array.
  const std::string_view odd = arrays.notNumeric ? arrays.notNumeric : "";
  hash = hashOf(odd.data(), odd.size(), hash);
  for (vtkDataArray* array : arrays.Numbers())
  {
    hash = Content::HashOf(array, hash);
  }
  return hash;
}
}
