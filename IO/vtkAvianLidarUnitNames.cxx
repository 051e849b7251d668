// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarUnitNames.h"

#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"

namespace
{
/// Returns a shallow copy whose name has the unit, or the array if the name does not change.
vtkSmartPointer<vtkAbstractArray> WithUnit(vtkAbstractArray* array)
{
  auto* numbers = vtkDataArray::SafeDownCast(array);
  const char* unit = numbers && numbers->GetName() && numbers->HasInformation()
    ? numbers->GetInformation()->Get(vtkDataArray::UNITS_LABEL())
    : nullptr;
  const std::string name =
    unit ? vtkAvianLidarUnitNames::NameWithUnit(numbers->GetName(), unit) : std::string();
  if (!unit || name == numbers->GetName())
  {
    return array;
  }
  auto renamed = vtkSmartPointer<vtkDataArray>::Take(numbers->NewInstance());
  renamed->ShallowCopy(numbers);
  renamed->SetName(name.c_str());
  renamed->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), unit);
  return renamed;
}

/// Adds renamed arrays in the same order. The active attributes (scalars, ...) are not kept.
void Rename(vtkDataSetAttributes* from, vtkDataSetAttributes* to)
{
  to->Initialize();
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    to->AddArray(WithUnit(from->GetAbstractArray(i)));
  }
}
}

vtkStandardNewMacro(vtkAvianLidarUnitNames);

//------------------------------------------------------------------------------
std::string vtkAvianLidarUnitNames::NameWithUnit(const std::string& name, const std::string& unit)
{
  return unit.empty() || unit == "1" ? name : name + " [" + unit + "]";
}

//------------------------------------------------------------------------------
int vtkAvianLidarUnitNames::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarUnitNames::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
      vtkDataObject* output = vtkDataObject::GetData(outputVector);
      output->ShallowCopy(input);
      for (const int kind : { vtkDataObject::POINT, vtkDataObject::CELL, vtkDataObject::ROW })
      {
        if (vtkDataSetAttributes* from = input->GetAttributes(kind))
        {
          Rename(from, output->GetAttributes(kind));
        }
      }
    });
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarUnitNames, ErrorsAsData);
