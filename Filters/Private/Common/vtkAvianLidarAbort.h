// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarAbort.h
 * @brief Whether the user wants a running filter to stop, with every VTK from 9.1 on. Not
 * installed.
 */
#ifndef vtkAvianLidarAbort_h
#define vtkAvianLidarAbort_h

#include "ParallelLoop.h"

#include "vtkAlgorithm.h"
#include "vtkVersionMacros.h"

namespace vtkAvianLidarAbort
{
/// To be asked on the calling thread only. Call vtkAlgorithm::UpdateProgress() before: its
/// observers set the flag.
inline bool Wanted(vtkAlgorithm* algorithm)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230111)
  // True for an abort anywhere upstream, too.
  return algorithm->CheckAbort();
#else
  return algorithm->GetAbortExecute() != 0;
#endif
}

/// Reports a part of the algorithm's progress, and asks. @param from progress when the work begins
/// @param to when it is done
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

/// In the body of a RequestData: throws if an observer of the progress 0, which the executive
/// reports before, wants to stop. Work shared by ranks does so in a step.
inline void StopIfWanted(vtkAlgorithm* algorithm)
{
  Require(!Wanted(algorithm));
}
}

#endif
