// SPDX-License-Identifier: BSD-3-Clause
// What the tests of numbers share: a check that says what failed, and what a filter says.
#ifndef Checks_h
#define Checks_h

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkTestErrorObserver.h"

#include <cstdlib>
#include <iostream>
#include <limits>
#include <string>

namespace checks
{
inline int Failures = 0;

inline void Check(bool good, const std::string& what)
{
  if (!good)
  {
    std::cerr << "Failed: " << what << "\n";
    ++Failures;
  }
}

inline int Result()
{
  return Failures ? EXIT_FAILURE : EXIT_SUCCESS;
}

/// A value of an array; NaN without it.
inline double At(vtkFieldData* data, const char* name, vtkIdType tuple = 0, int component = 0)
{
  vtkDataArray* array = data->GetArray(name);
  const bool there =
    array && tuple < array->GetNumberOfTuples() && component < array->GetNumberOfComponents();
  return there ? array->GetComponent(tuple, component) : std::numeric_limits<double>::quiet_NaN();
}

/// Errors and warnings of a filter and its executive.
struct Heard
{
  vtkNew<vtkTest::ErrorObserver> observer;

  explicit Heard(vtkAlgorithm* filter)
  {
    filter->AddObserver(vtkCommand::ErrorEvent, this->observer);
    filter->AddObserver(vtkCommand::WarningEvent, this->observer);
    filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, this->observer);
  }

  bool Nothing() { return !this->observer->GetError() && !this->observer->GetWarning(); }

  bool ErrorHas(const std::string& words)
  {
    return this->observer->GetErrorMessage().find(words) != std::string::npos;
  }

  bool WarningHas(const std::string& words)
  {
    return this->observer->GetWarningMessage().find(words) != std::string::npos;
  }
};

/// Updates a filter that has been spoilt: the error has these words, and all outputs are empty.
inline void CheckFails(vtkAlgorithm* filter, const std::string& words)
{
  Heard heard(filter);
  filter->Update();
  Check(heard.ErrorHas(words), words + " is named");
  for (int port = 0; port < filter->GetNumberOfOutputPorts(); ++port)
  {
    vtkDataObject* output = filter->GetOutputDataObject(port);
    Check(output->GetNumberOfElements(vtkDataObject::POINT) == 0, words + ": no output");
  }
}
}

#endif
