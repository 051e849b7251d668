// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarPassedKey.h
 * @brief A vector in the pipeline's information that filters on the way pass on, as VTK has them
 * do with the time steps. Not installed.
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

  /// A key lives to the end of the process: VTK's manager of keys deletes it. A length of -1 is
  /// any.
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
