// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarHSBColorMap.h"

#include "Hue.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarText.h"

#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLookupTable.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

// Adds hue and rgb of `energies` to `data` and returns how many energies are not numbers.
vtkIdType Colour(vtkDataArray* energies, const double limits[2], vtkPointData* data)
{
  const vtkIdType size = energies->GetNumberOfTuples();
  auto hues = Arrays::Make<vtkDoubleArray>(Arrays::Hue, size);
  auto colours = Arrays::Make<vtkUnsignedCharArray>(Arrays::Rgb, size, 3);
  vtkIdType withoutNumber = 0;
  for (vtkIdType i = 0; i < size; ++i)
  {
    const double hue = avianlidar::hueOfEnergy(energies->GetComponent(i, 0), limits[0], limits[1]);
    unsigned char bytes[3] = { 0, 0, 0 };
    if (std::isnan(hue))
    {
      ++withoutNumber;
    }
    else
    {
      const auto rgb = avianlidar::colorOfHue(hue);
      for (int c = 0; c < 3; ++c)
      {
        bytes[c] = static_cast<unsigned char>(std::lround(255.0 * rgb[c]));
      }
    }
    hues->SetValue(i, hue);
    colours->SetTypedTuple(i, bytes);
  }
  data->AddArray(hues);
  data->AddArray(colours);
  return withoutNumber;
}
}

vtkStandardNewMacro(vtkAvianLidarHSBColorMap);

//------------------------------------------------------------------------------
vtkAvianLidarHSBColorMap::vtkAvianLidarHSBColorMap()
{
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, Arrays::Energy.name);
}

//------------------------------------------------------------------------------
void vtkAvianLidarHSBColorMap::FindLimits(vtkPointSet* input, double limits[2])
{
  limits[0] = this->EnergyRange[0];
  limits[1] = this->EnergyRange[1];
  std::string where = "EnergyRange";
  if (this->UseFieldDataRange)
  {
    where = "the field data of input port 0";
    const Arrays::Name names[2] = { Arrays::LowerEnergyLimit, Arrays::UpperEnergyLimit };
    for (int i = 0; i < 2; ++i)
    {
      if (!Arrays::GetFieldValue(input->GetFieldData(), names[i], limits[i]))
      {
        vtkAvianLidarRequire("The field data of input port 0 hold no finite number '" +
          std::string(names[i].name) +
          "' (J): colour echoes of the echo filter, or switch UseFieldDataRange off and set "
          "EnergyRange");
      }
    }
  }
  if (!std::isfinite(limits[0]) || !std::isfinite(limits[1]) || limits[0] > limits[1])
  {
    std::ostringstream text;
    text << "The energy limits in " << where << " are " << limits[0] << " and " << limits[1]
         << " J, expected two finite numbers, the lower one first";
    vtkAvianLidarRequire(text.str());
  }
}

//------------------------------------------------------------------------------
int vtkAvianLidarHSBColorMap::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkPointSet* input = vtkPointSet::GetData(inputVector[0]);
      vtkPointSet* output = vtkPointSet::GetData(outputVector);
      if (input->GetNumberOfPoints() == 0)
      {
        output->ShallowCopy(input);
        output->GetPointData()->AddArray(Arrays::Make<vtkDoubleArray>(Arrays::Hue));
        output->GetPointData()->AddArray(Arrays::Make<vtkUnsignedCharArray>(Arrays::Rgb, 0, 3));
        return;
      }
      vtkInformation* wanted = this->GetInputArrayInformation(0);
      const std::string name = vtkAvianLidarText(
        wanted->Has(vtkDataObject::FIELD_NAME()) ? wanted->Get(vtkDataObject::FIELD_NAME()) : "");
      int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
      vtkDataArray* energies = this->GetInputArrayToProcess(0, inputVector, association);
      if (!energies || association != vtkDataObject::FIELD_ASSOCIATION_POINTS ||
        energies->GetNumberOfTuples() != input->GetNumberOfPoints())
      {
        vtkAvianLidarRequire(
          "Input port 0 has no numeric point array '" + name + "' (energies in J, one component)");
      }
      if (energies->GetNumberOfComponents() != 1)
      {
        vtkAvianLidarRequire("Point array '" + name + "' of input port 0 has " +
          std::to_string(energies->GetNumberOfComponents()) +
          " components, expected 1 (energies in J)");
      }
      double limits[2];
      this->FindLimits(input, limits);
      output->ShallowCopy(input);
      const vtkIdType withoutNumber = Colour(energies, limits, output->GetPointData());
      if (withoutNumber > 0)
      {
        vtkWarningMacro("Point array '" << name << "' of input port 0: " << withoutNumber
                                        << " values are not numbers; these points are black.");
      }
      std::copy(limits, limits + 2, this->LastLimits);
      this->Executed = true;
    });
}

//------------------------------------------------------------------------------
vtkLookupTable* vtkAvianLidarHSBColorMap::GetLookupTable()
{
  this->FillLookupTable(this->Table);
  return this->Table;
}

//------------------------------------------------------------------------------
void vtkAvianLidarHSBColorMap::FillLookupTable(vtkLookupTable* table)
{
  if (!table)
  {
    vtkErrorMacro("FillLookupTable: no table given.");
    return;
  }
  const vtkIdType colours = std::max<vtkIdType>(2, table->GetNumberOfTableValues());
  table->SetNumberOfTableValues(colours);
  table->SetTableRange(this->Executed ? this->LastLimits : this->EnergyRange);
  table->SetScaleToLinear();
  for (vtkIdType i = 0; i < colours; ++i)
  {
    const double hue = avianlidar::LargestHue * static_cast<double>(colours - 1 - i) /
      static_cast<double>(colours - 1);
    const auto rgb = avianlidar::colorOfHue(hue);
    table->SetTableValue(i, rgb[0], rgb[1], rgb[2], 1.0);
  }
  table->SetNanColor(0.0, 0.0, 0.0, 1.0);
  table->UseBelowRangeColorOff();
  table->UseAboveRangeColorOff();
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarHSBColorMap, ErrorsAsData, UseFieldDataRange, EnergyRange);
