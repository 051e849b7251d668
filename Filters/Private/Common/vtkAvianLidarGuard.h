// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarGuard.h
 * @brief What becomes of an execution that fails: an error message, empty outputs and 0; or, with
 * errors as data, 1 and outputs whose field data `error` repeat the message. Not installed.
 *
 * Every RequestData passes here, alone by vtkAvianLidarGuarded() or together with other ranks by
 * vtkAvianLidarRanks::Execute(). VTK considers what has failed up to date and lets the next filter
 * run on its empty outputs. So an algorithm notes that it failed, and whoever follows looks
 * upstream for such notes, and into its inputs for field data `error`, before it executes.
 */
#ifndef vtkAvianLidarGuard_h
#define vtkAvianLidarGuard_h

#include "ParallelLoop.h"

#include "vtkAlgorithm.h"

#include <exception>
#include <new>
#include <string>

class vtkDataObject;
class vtkInformationVector;

namespace vtkAvianLidarGuard
{
constexpr char NoMemory[] = "There is not enough memory for this";

/// In vtkAlgorithm::ModifyRequest(): note that the inputs are updated for RequestData. VTK
/// considers what has failed up to date, so if RequestData does not follow, the inputs are not good
/// until they or the request change.
void NoteInputs(vtkAlgorithm* self, vtkInformation* request, int when);

/// The first input whose producer failed, or something further upstream, and why; else nothing.
std::string FailedInput(vtkAlgorithm* self);

/// With errors as data, the error of the request before if this is the same and nothing was changed
/// since; else nothing. VTK asks again for another part of an image, on some ranks only: those must
/// neither wait for the others nor say it again.
std::string FailedBefore(vtkAlgorithm* self, vtkInformationVector* outputs);

/// The problem as UTF-8, with a full stop.
std::string Sentence(const std::string& problem);

/// Note how an execution ended: nothing is wrong, or empty outputs and the note, and if errors are
/// data the outputs' field data, say what. @return what RequestData is to return
int End(
  vtkAlgorithm* self, vtkInformationVector* outputs, const std::string& problem, bool errorsAsData);

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
  std::string problem = vtkAvianLidarGuard::FailedBefore(self, outputs);
  if (problem.empty())
  {
    problem = vtkAvianLidarGuard::ProblemOf(
      [&]()
      {
        const std::string failed = vtkAvianLidarGuard::FailedInput(self);
        return failed.empty() ? body() : failed;
      });
    if (!problem.empty())
    {
      vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(problem));
    }
  }
  return vtkAvianLidarGuard::End(self, outputs, problem, self->GetErrorsAsData());
}
catch (const std::bad_alloc&)
{
  return vtkAvianLidarGuard::GiveUp(self, outputs);
}

#endif
