// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarArrays.h"

#include "vtkAvianLidarText.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkStringArray.h"

#include <cmath>
#include <stdexcept>

namespace vtkAvianLidarArrays
{
void SetUnit(vtkAbstractArray* array, const char* unit)
{
  if (unit && *unit)
  {
    array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), unit);
  }
}

void SetTuples(vtkStringArray* array, vtkIdType tuples)
{
  array->SetNumberOfTuples(tuples);
}

vtkSmartPointer<vtkPoints> MakePoints(vtkIdType count)
{
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  SetTuples(coordinates.Get(), count);
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(coordinates);
  return points;
}

void SetFieldValue(vtkFieldData* fields, const Name& name, double value)
{
  auto array = Make<vtkDoubleArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}

void SetFieldInteger(vtkFieldData* fields, const Name& name, int value)
{
  auto array = Make<vtkIntArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}

void SetFieldVector(vtkFieldData* fields, const Name& name, const double* values, int components)
{
  auto array = Make<vtkDoubleArray>(name, 1, components);
  array->SetTypedTuple(0, values);
  fields->AddArray(array);
}

vtkSmartPointer<vtkIntArray> Constant(const Name& name, vtkIdType tuples, int value)
{
  auto array = Make<vtkIntArray>(name, tuples);
  array->FillValue(value);
  return array;
}

void SetFieldStrings(vtkFieldData* fields, const Name& name, const std::vector<std::string>& values)
{
  auto array = Make<vtkStringArray>(name, static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    array->SetValue(static_cast<vtkIdType>(i), vtkAvianLidarText(values[i]));
  }
  fields->AddArray(array);
}

void RequireShape(vtkDataArray* array, const char* kind, int components, vtkIdType tuples)
{
  const bool width = array && array->GetNumberOfComponents() != components;
  if (width || (array && array->GetNumberOfTuples() != tuples))
  {
    throw std::runtime_error(std::string(kind) + " '" + array->GetName() + "' has " +
      std::to_string(width ? array->GetNumberOfComponents() : array->GetNumberOfTuples()) +
      (width ? " components, expected " : " values, expected ") +
      std::to_string(width ? components : tuples));
  }
}

void RequireNumeric(vtkFieldData* arrays, const Name& name, const char* kind)
{
  if (arrays->GetAbstractArray(name.name) && !arrays->GetArray(name.name))
  {
    throw std::runtime_error(
      std::string(kind) + " '" + name.name + "' holds no numbers, expected numbers");
  }
}

void RequireText(vtkFieldData* fields, const Name& name)
{
  if (fields->GetAbstractArray(name.name) && !FindTexts(fields, name))
  {
    throw std::runtime_error(
      std::string("field data '") + name.name + "' holds no text, expected text");
  }
}

vtkStringArray* FindTexts(vtkFieldData* fields, const Name& name)
{
  return fields ? vtkStringArray::SafeDownCast(fields->GetAbstractArray(name.name)) : nullptr;
}

std::string TextAt(vtkFieldData* fields, const Name& name, vtkIdType index)
{
  vtkStringArray* texts = FindTexts(fields, name);
  return texts && index >= 0 && index < texts->GetNumberOfValues() ? texts->GetValue(index)
                                                                   : std::string();
}

bool IsInt(double value)
{
  return value >= -2147483648.0 && value <= 2147483647.0 && value == std::floor(value);
}

bool GetFieldValue(vtkFieldData* fields, const Name& name, double& value)
{
  vtkDataArray* array = fields ? fields->GetArray(name.name) : nullptr;
  if (!array || array->GetNumberOfValues() != 1)
  {
    return false;
  }
  value = array->GetComponent(0, 0);
  return std::isfinite(value);
}

void ReadFieldValue(vtkFieldData* fields, const Name& name, double& value)
{
  double read = value;
  if (fields && fields->GetAbstractArray(name.name) && !GetFieldValue(fields, name, read))
  {
    throw std::runtime_error(
      std::string("field data '") + name.name + "' is not one finite number");
  }
  value = read;
}
}
