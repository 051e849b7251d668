// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarHandedOut.h
 * @brief Were the outputs of an algorithm modified by whoever got them? Not installed.
 *
 * Arrays of an output that are kept for the next one may have been edited in place meanwhile, and
 * Modified() called on them or on anything else in the output. The executive empties outputs before
 * the algorithm executes, so it looks before.
 */
#ifndef vtkAvianLidarHandedOut_h
#define vtkAvianLidarHandedOut_h

#include "vtkAvianLidarContent.h"

#include "vtkAlgorithm.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkExecutive.h"
#include "vtkInformation.h"
#include "vtkPolyData.h"

#include <array>
#include <utility>

class vtkAvianLidarHandedOut
{
public:
  /// When an execution is done, and nothing in the outputs will be changed any more.
  void Note(vtkAlgorithm* self) { this->Times = TimesOf(self); }

  /// In vtkAlgorithm::ModifyRequest(): true if the algorithm may execute next and its outputs are
  /// not as they were noted last. Then nothing of them is to be used again.
  bool AreEdited(vtkAlgorithm* self, vtkInformation* request, int when) const
  {
    return when == vtkExecutive::BeforeForward &&
      request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()) && TimesOf(self) != this->Times;
  }

private:
  /// The times of two outputs: no algorithm that keeps arrays has more.
  using OutputTimes = std::array<std::pair<const void*, vtkMTimeType>, 2>;

  static OutputTimes TimesOf(vtkAlgorithm* self)
  {
    OutputTimes times{};
    for (int port = 0; port < 2; ++port)
    {
      auto* output = vtkPolyData::SafeDownCast(self->GetOutputDataObject(port));
      times[port] = { output, output ? vtkAvianLidarContent::TimeOf(output) : 0 };
    }
    return times;
  }

  OutputTimes Times{};
};

#endif
