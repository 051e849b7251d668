// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarGuard.h
 * @brief No exception leaves an algorithm: it becomes an error message and empty outputs. Not
 * installed.
 */
#ifndef vtkAvianLidarGuard_h
#define vtkAvianLidarGuard_h

#include "ParallelLoop.h"
#include "vtkAvianLidarText.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkInformationVector.h"

#include <exception>
#include <new>

/// Run the body of a RequestData, which returns 0 or 1, or throws avianlidar::WorkStopped to stop.
template <class Body>
int vtkAvianLidarGuarded(vtkAlgorithm* self, vtkInformationVector* outputs, Body body)
{
  int result = 0;
  try
  {
    return body();
  }
  catch (const avianlidar::WorkStopped&)
  {
    result = 1; // empty and valid
  }
  catch (const std::bad_alloc&)
  {
    vtkErrorWithObjectMacro(self, "There is not enough memory for this.");
  }
  catch (const std::exception& error)
  {
    vtkErrorWithObjectMacro(self, "" << vtkAvianLidarText(error.what()) << ".");
  }
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
  {
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, port))
    {
      output->Initialize();
    }
  }
  return result;
}

#endif
