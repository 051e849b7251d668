// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarHSBColorMap.h"

#include "vtkNew.h"

#include <cstdlib>

int TestHSBColorMap(int, char*[])
{
  vtkNew<vtkAvianLidarHSBColorMap> map;
  return map->GetNumberOfInputPorts() == 1 ? EXIT_SUCCESS : EXIT_FAILURE;
}
