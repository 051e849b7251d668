// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarGuard.h
 * @brief Checks inputs before an execution, turns exceptions into texts, and empties the outputs of
 * an execution that fails, with the message as their field data `error`. Not installed.
 *
 * Every RequestData runs in vtkAvianLidarGuarded() or, together with other ranks, in
 * vtkAvianLidarRanks::Execute() (vtkAvianLidarRanks.h). VTK does not execute what is downstream of
 * a failure: vtkAvianLidarExecutive.cxx empties the outputs there. VTK considers a failed filter up
 * to date, and at the next update runs the next filter on the empty outputs. So each filter checks
 * its inputs for such an `error` before it executes.
 */
#ifndef vtkAvianLidarGuard_h
#define vtkAvianLidarGuard_h

#include "ParallelLoop.h"

#include "vtkAlgorithm.h"

#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <vector>

class vtkInformationVector;

namespace vtkAvianLidarGuard
{
constexpr char NoMemory[] = "There is not enough memory for this";

/// Check that an execution may start. Throws an error that names the first input that is empty
/// because its producer failed, or avianlidar::WorkStopped if an observer has stopped the algorithm
/// at progress 0, which the executive reports before RequestData.
void CheckStart(vtkAlgorithm* self);

/// Times at which the outputs were changed, by port. @return 0 for a port without an output
std::vector<vtkMTimeType> TimesOf(vtkInformationVector* outputs);

/// Empty the outputs after a request that failed. The field data `error` then says which producer
/// failed. Outputs that the request has changed stay: they hold the error of the algorithm, or are
/// empty because the work was stopped. @param before from TimesOf(), before the request
void EmptyUnlessChanged(vtkAlgorithm* self, vtkInformationVector* outputs,
  const std::vector<vtkMTimeType>& before) noexcept;

/// The problem as UTF-8, with a full stop.
std::string Sentence(const std::string& problem);

/// Empty all outputs. @param error error text for the field data; empty: no error text
void Empty(vtkInformationVector* outputs, const std::string& error = {});

/// The problem that a step throws; an empty string for avianlidar::WorkStopped.
template <class Step>
std::string ProblemOf(const Step& step)
{
  try
  {
    static_assert(std::is_void_v<decltype(step())>, "a step throws its error");
    step();
    return {};
  }
  catch (const avianlidar::WorkStopped&)
  {
    return {};
  }
  catch (const std::bad_alloc&)
  {
    return NoMemory;
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  catch (...)
  {
    return "An unknown exception was thrown";
  }
}
}

#endif
