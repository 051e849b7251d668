// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarHSBColorMap.h"

#include "vtkNew.h"

int main()
{
  vtkNew<vtkAvianLidarHSBColorMap> map;
  return map->GetNumberOfInputPorts() == 1 ? 0 : 1;
}
