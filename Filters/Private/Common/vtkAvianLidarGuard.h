// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarGuard.h
 * @brief What becomes of an execution that fails: an error message, empty outputs whose field data
 * `error` repeat it, and 0; with errors as data 1. Not installed.
 *
 * Every RequestData passes here, alone by vtkAvianLidarGuarded() or together with other ranks by
 * vtkAvianLidarRanks::Execute(). VTK considers what has failed up to date, and at the next
 * update runs the next filter on its empty outputs. So each looks into its inputs for such an
 * `error` before it executes.
 */
#ifndef vtkAvianLidarGuard_h
#define vtkAvianLidarGuard_h

#include "ParallelLoop.h"

#include "vtkAlgorithm.h"

#include <exception>
#include <new>
#include <string>

class vtkInformationVector;

namespace vtkAvianLidarGuard
{
constexpr char NoMemory[] = "There is not enough memory for this";

/// The first input that is empty because its producer failed, and why; else nothing.
std::string FailedInput(vtkAlgorithm* self);

/// The problem as UTF-8, with a full stop.
std::string Sentence(const std::string& problem);

/// Empty all outputs. @param error for their field data, if any
void Empty(vtkInformationVector* outputs, const std::string& error = {});

/// The end of an execution: if something is wrong, outputs are empty and say what.
/// @return what RequestData is to return
int End(vtkInformationVector* outputs, const std::string& problem, bool errorsAsData);

/// The end of an execution whose error cannot be kept for want of memory: empty outputs. @return 0
int GiveUp(vtkAlgorithm* self, vtkInformationVector* outputs);

/// What is wrong: what the step returns, or what it throws. Nothing if it throws
/// avianlidar::WorkStopped.
template <class Step>
std::string ProblemOf(Step step)
{
  try
  {
    return step();
  }
  catch (const avianlidar::WorkStopped&)
  {
    return {}; // outputs are empty and valid
  }
  catch (const std::bad_alloc&)
  {
    return NoMemory;
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
}
}

/// Run the body of a RequestData, which returns what is wrong, or nothing.
template <class Filter, class Body>
int vtkAvianLidarGuarded(Filter* self, vtkInformationVector* outputs, Body body)
try
{
  const std::string problem = vtkAvianLidarGuard::ProblemOf(
    [&]()
    {
      const std::string failed = vtkAvianLidarGuard::FailedInput(self);
      return failed.empty() ? body() : failed;
    });
  if (!problem.empty())
  {
    vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(problem));
  }
  return vtkAvianLidarGuard::End(outputs, problem, self->GetErrorsAsData());
}
catch (const std::bad_alloc&)
{
  return vtkAvianLidarGuard::GiveUp(self, outputs);
}

#endif
