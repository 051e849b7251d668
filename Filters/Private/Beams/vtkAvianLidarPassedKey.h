// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarPassedKey.h
 * @brief Declares a pipeline information key with a vector of numbers, which every filter passes
 * from its input to its outputs, like VTK's time steps. Not installed.
 */
#ifndef vtkAvianLidarPassedKey_h
#define vtkAvianLidarPassedKey_h

#include "vtkDemandDrivenPipeline.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"

class vtkAvianLidarPassedKey : public vtkInformationDoubleVectorKey
{
public:
  vtkTypeMacro(vtkAvianLidarPassedKey, vtkInformationDoubleVectorKey);

  /// A key exists until the end of the process, when VTK's manager of keys deletes the key. @param
  /// length number of values; -1: any number
  vtkAvianLidarPassedKey(const char* name, const char* location, int length = -1)
    : vtkInformationDoubleVectorKey(name, location, length)
  {
  }

  void CopyDefaultInformation(
    vtkInformation* request, vtkInformation* from, vtkInformation* to) override
  {
    if (request->Has(vtkDemandDrivenPipeline::REQUEST_INFORMATION()))
    {
      this->ShallowCopy(from, to);
    }
  }
};

#endif
