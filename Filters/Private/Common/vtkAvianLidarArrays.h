// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarArrays.h
 * @brief Making and reading of arrays. Not installed.
 */
#ifndef vtkAvianLidarArrays_h
#define vtkAvianLidarArrays_h

#include "vtkAOSDataArrayTemplate.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarText.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

namespace vtkAvianLidarArrays
{
/// Attach the unit to an array (vtkDataArray::UNITS_LABEL).
inline void SetUnit(vtkAbstractArray* array, const char* unit)
{
  if (unit && *unit)
  {
    array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), unit);
  }
}

/// Set the number of tuples of a new array, whose components are set; values are not initialised.
/// VTK's own way ends the process where there is no memory (as Debian builds it): this throws
/// std::bad_alloc.
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
inline void SetTuples(vtkStringArray* array, vtkIdType tuples)
{
  array->SetNumberOfTuples(tuples);
}

/// A new array of the given type with name, unit, components and tuples set; values are not
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

/// The same of one component, with values.
template <class ArrayT, class Values>
vtkSmartPointer<ArrayT> MakeOf(const Name& name, const Values& values)
{
  auto array = Make<ArrayT>(name, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

/// Points in double precision, not initialised.
inline vtkSmartPointer<vtkPoints> MakePoints(vtkIdType count)
{
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  SetTuples(coordinates.Get(), count);
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(coordinates);
  return points;
}

/// Put one double value (with unit) into field data, replacing an array of that name.
inline void SetFieldValue(vtkFieldData* fields, const Name& name, double value)
{
  auto array = Make<vtkDoubleArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}

/// The same of an integer.
inline void SetFieldInteger(vtkFieldData* fields, const Name& name, int value)
{
  auto array = Make<vtkIntArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}

/// Put strings into field data, as UTF-8, replacing an array of that name.
inline void SetFieldStrings(
  vtkFieldData* fields, const Name& name, const std::vector<std::string>& values)
{
  auto array = Make<vtkStringArray>(name, static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    array->SetValue(static_cast<vtkIdType>(i), vtkAvianLidarText(values[i]));
  }
  fields->AddArray(array);
}

/// Empty if the array (null: fine) has as many components and tuples as expected; otherwise what is
/// wrong with it.
/// @param kind "point array" or "cell array"
inline std::string CheckShape(
  vtkDataArray* array, const char* kind, int components, vtkIdType tuples)
{
  if (!array ||
    (array->GetNumberOfComponents() == components && array->GetNumberOfTuples() == tuples))
  {
    return {};
  }
  const bool width = array->GetNumberOfComponents() != components;
  return std::string(kind) + " '" + array->GetName() + "' has " +
    std::to_string(width ? array->GetNumberOfComponents() : array->GetNumberOfTuples()) +
    (width ? " components, expected " : " values, expected ") +
    std::to_string(width ? components : tuples);
}

/// The error of an array that holds no numbers. @param kind "point array", "cell array" or
/// "field data"
inline std::string NotNumeric(const char* kind, const char* name)
{
  return std::string(kind) + " '" + name + "' holds no numbers, expected numbers";
}

/// Empty if there is no array of the name, or if it holds numbers; otherwise what is wrong.
/// @param kind as above
inline std::string CheckNumeric(vtkFieldData* arrays, const Name& name, const char* kind)
{
  return !arrays->GetAbstractArray(name.name) || arrays->GetArray(name.name)
    ? std::string()
    : NotNumeric(kind, name.name);
}

/// The same for text.
inline std::string CheckText(vtkFieldData* fields, const Name& name)
{
  vtkAbstractArray* array = fields->GetAbstractArray(name.name);
  return !array || vtkStringArray::SafeDownCast(array)
    ? std::string()
    : std::string("field data '") + name.name + "' holds no text, expected text";
}

/// True for the whole numbers that an int holds.
inline bool IsInt(double value)
{
  return value >= -2147483648.0 && value <= 2147483647.0 && value == std::floor(value);
}

/// Read one finite number of any numeric type from field data; false if there is none, or anything
/// else than one.
inline bool GetFieldValue(vtkFieldData* fields, const Name& name, double& value)
{
  vtkDataArray* array = fields ? fields->GetArray(name.name) : nullptr;
  if (!array || array->GetNumberOfValues() != 1)
  {
    return false;
  }
  value = array->GetComponent(0, 0);
  return std::isfinite(value);
}

/// The same where it may be absent: empty if it is (the value stays) or if it was read, otherwise
/// what is wrong.
inline std::string ReadFieldValue(vtkFieldData* fields, const Name& name, double& value)
{
  double read = value;
  if (fields && fields->GetAbstractArray(name.name) && !GetFieldValue(fields, name, read))
  {
    return std::string("field data '") + name.name + "' is not one finite number";
  }
  value = read;
  return {};
}
}

#endif
