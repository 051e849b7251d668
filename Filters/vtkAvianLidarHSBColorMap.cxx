// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarHSBColorMap.h"

#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkAvianLidarHSBColorMap);

//------------------------------------------------------------------------------
void vtkAvianLidarHSBColorMap::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
int vtkAvianLidarHSBColorMap::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* output = vtkPolyData::GetData(outputVector);
  output->ShallowCopy(vtkPolyData::GetData(inputVector[0]));
  return 1;
}
