// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarArrays.h
 * @brief Makes, checks and reads arrays. Not installed.
 */
#ifndef vtkAvianLidarArrays_h
#define vtkAvianLidarArrays_h

#include "vtkAOSDataArrayTemplate.h"
#include "vtkAvianLidarNames.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

class vtkFieldData;
class vtkIntArray;
class vtkPoints;
class vtkStringArray;

namespace vtkAvianLidarArrays
{
/// Attach the unit to an array (vtkDataArray::UNITS_LABEL).
void SetUnit(vtkAbstractArray* array, const char* unit);

/// Set the number of tuples of a new array, whose number of components is set. The values are not
/// initialised. If memory does not suffice, the function throws std::bad_alloc. VTK's own function,
/// as Debian builds VTK, ends the process.
template <class ValueT>
void SetTuples(vtkAOSDataArrayTemplate<ValueT>* array, vtkIdType tuples)
{
  const vtkIdType values = tuples * array->GetNumberOfComponents();
  void* place =
    values > 0 ? std::malloc(static_cast<std::size_t>(values) * sizeof(ValueT)) : nullptr;
  if (values > 0 && !place)
  {
    throw std::bad_alloc();
  }
  array->SetArray(static_cast<ValueT*>(place), values, 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
}

void SetTuples(vtkStringArray* array, vtkIdType tuples);

/// A new array of the given type with name, unit, components and tuples set. The values are not
/// initialised.
template <class ArrayT>
vtkSmartPointer<ArrayT> Make(const Name& name, vtkIdType tuples = 0, int components = 1)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetName(name.name);
  array->SetNumberOfComponents(components);
  SetTuples(array.Get(), tuples);
  SetUnit(array, name.unit);
  return array;
}

/// A new array of one component with the given values, name and unit.
template <class ArrayT, class Values>
vtkSmartPointer<ArrayT> MakeOf(const Name& name, const Values& values)
{
  auto array = Make<ArrayT>(name, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

/// Points in double precision, not initialised.
vtkSmartPointer<vtkPoints> MakePoints(vtkIdType count);

/// Put one double value (with unit) into field data, replacing an array of that name.
void SetFieldValue(vtkFieldData* fields, const Name& name, double value);

/// Put one int value (with unit) into field data, replacing an array of that name.
void SetFieldInteger(vtkFieldData* fields, const Name& name, int value);

/// Put a vector (with unit) into field data, replacing an array of that name.
void SetFieldVector(
  vtkFieldData* fields, const Name& name, const double* values, int components = 3);

/// A new array of one component with the same value everywhere.
vtkSmartPointer<vtkIntArray> Constant(const Name& name, vtkIdType tuples, int value);

/// Put strings into field data, as UTF-8, replacing an array of that name.
void SetFieldStrings(
  vtkFieldData* fields, const Name& name, const std::vector<std::string>& values);

// The following functions throw std::runtime_error. @param kind "point array", "cell array" or
// "field data"

/// Throws unless the array is null or has the given numbers of components and tuples.
void RequireShape(vtkDataArray* array, const char* kind, int components, vtkIdType tuples);

/// Throws unless the array is missing or holds numbers.
void RequireNumeric(vtkFieldData* arrays, const Name& name, const char* kind);

/// Throws unless the field data are missing or hold text.
void RequireText(vtkFieldData* fields, const Name& name);

/// Texts of the name, or null; `fields` may be null.
vtkStringArray* FindTexts(vtkFieldData* fields, const Name& name);

/// Text `index` of the name, or an empty text.
std::string TextAt(vtkFieldData* fields, const Name& name, vtkIdType index);

/// True for the whole numbers that an int holds.
bool IsInt(double value);

/// Read one finite number of any numeric type from field data. Returns false if the array is
/// missing or does not hold exactly one finite value.
bool GetFieldValue(vtkFieldData* fields, const Name& name, double& value);

/// Read one finite number like GetFieldValue(). If the array is missing, `value` is kept. Throws
/// std::runtime_error if the array holds something else.
void ReadFieldValue(vtkFieldData* fields, const Name& name, double& value);
}

#endif
