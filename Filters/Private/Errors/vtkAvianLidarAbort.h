// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarAbort.h
 * @brief Finds whether a running filter is to stop, with every VTK from 9.1 on. Not installed.
 */
#ifndef vtkAvianLidarAbort_h
#define vtkAvianLidarAbort_h

#include "ParallelLoop.h"

#include "vtkAlgorithm.h"
#include "vtkVersionMacros.h"

namespace vtkAvianLidarAbort
{
/// True if the algorithm is to stop. Call the function only on the thread that runs the filter,
/// after vtkAlgorithm::UpdateProgress(), whose observers set the flag for stopping.
inline bool Wanted(vtkAlgorithm* algorithm)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230111)
  // CheckAbort() is also true after an abort upstream.
  return algorithm->CheckAbort();
#else
  return algorithm->GetAbortExecute() != 0;
#endif
}

/// Function that reports progress and returns false if the algorithm is to stop. @param from
/// progress when the work begins @param to progress when the work is done
inline avianlidar::KeepGoing KeepGoing(vtkAlgorithm* algorithm, double from = 0.0, double to = 1.0)
{
  return [algorithm, from, to](double fraction)
  {
    algorithm->UpdateProgress(from + (to - from) * fraction);
    return !Wanted(algorithm);
  };
}

/// Throws unless the work was done.
inline void Require(bool done)
{
  if (!done)
  {
    throw avianlidar::WorkStopped{};
  }
}

/// Throws if the algorithm is to stop.
inline void StopIfWanted(vtkAlgorithm* algorithm)
{
  Require(!Wanted(algorithm));
}
}

#endif
