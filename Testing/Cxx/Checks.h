// SPDX-License-Identifier: BSD-3-Clause
// What the tests of numbers share: a check that says what failed, and what a filter says.
#ifndef Checks_h
#define Checks_h

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkExecutive.h"
#include "vtkNew.h"
#include "vtkTestErrorObserver.h"

#include <cstdlib>
#include <iostream>
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
}

#endif
