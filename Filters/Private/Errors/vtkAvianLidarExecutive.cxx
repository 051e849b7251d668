// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarProperties.h"

#include "vtkCompositeDataPipeline.h"
#include "vtkObjectFactory.h"

#include <cstring>
#include <vector>

namespace
{
/// An executive that does not leave old data in the outputs after a failure. VTK's executives
/// return before they call the algorithm if a producer fails or an input is missing.
class EmptyingExecutive : public vtkCompositeDataPipeline
{
public:
  static EmptyingExecutive* New();
  vtkTypeMacro(EmptyingExecutive, vtkCompositeDataPipeline);

  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override
  {
    // VTK refuses a request that comes while the algorithm fills the outputs.
    const bool isFilling = this->InAlgorithm != 0;
    const std::vector<vtkMTimeType> before = vtkAvianLidarGuard::TimesOf(outputs);
    const vtkTypeBool done = this->Superclass::ProcessRequest(request, inputs, outputs);
    if (!done && !isFilling && !this->InLocalLoop && this->Algorithm)
    {
      vtkAvianLidarGuard::EmptyUnlessChanged(this->Algorithm, outputs, before);
    }
    return done;
  }

protected:
  EmptyingExecutive() = default;
  ~EmptyingExecutive() override = default;

private:
  EmptyingExecutive(const EmptyingExecutive&) = delete;
  void operator=(const EmptyingExecutive&) = delete;
};

vtkStandardNewMacro(EmptyingExecutive);
}

//------------------------------------------------------------------------------
vtkExecutive* vtkAvianLidarEmptyingExecutive(vtkExecutive* usual)
{
  if (!usual || std::strcmp(usual->GetClassName(), "vtkCompositeDataPipeline") != 0)
  {
    return usual;
  }
  usual->Delete();
  return EmptyingExecutive::New();
}
