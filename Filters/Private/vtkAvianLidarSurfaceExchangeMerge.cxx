// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceExchange.h"

#include "vtkAvianLidarSurfaces.h"

#include "vtkDataObject.h"

using Outcome = vtkAvianLidarRanks::Outcome;

//------------------------------------------------------------------------------
Outcome vtkAvianLidarSurfaceExchange::Merge(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  vtkDataObject* input, const std::string& what, int threads, const vtkAvianLidarSurfaces& known,
  vtkAvianLidarSurfaces& result)
{
  const int share = ranks.Threads(threads);
  if (ranks.Alone())
  {
    this->Forget();
  }
  else
  {
    const Outcome run = this->Run(ranks, self, input, what);
    if (run != Outcome::Done)
    {
      return run;
    }
  }
  const Outcome merged = ranks.Together(self,
    [&]() -> std::string
    {
      if (ranks.Alone())
      {
        this->Fields = input->GetFieldData();
        result = vtkAvianLidarSurfaces::Merge(input, &known, share);
      }
      else if (this->Changed)
      {
        result = vtkAvianLidarSurfaces::Merge(this->Leaves, this->Fields, &known, share);
      }
      else if (&result != &known)
      {
        result = known;
      }
      this->Release();
      return result.problem.empty() ? "" : what + result.problem;
    });
  if (merged != Outcome::Done)
  {
    this->Forget();
  }
  return merged;
}
