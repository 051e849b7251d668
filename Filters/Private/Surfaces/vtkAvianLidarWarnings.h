// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarWarnings.h
 * @brief Decides whether a warning about surfaces is new. A warning is given once per scene. For a
 * scene that moves, a warning is given once for all times. Not installed.
 */
#ifndef vtkAvianLidarWarnings_h
#define vtkAvianLidarWarnings_h

#include "vtkDataObject.h"
#include "vtkInformation.h"

#include <cstdint>
#include <string>

class vtkAvianLidarWarnings
{
public:
  /// True if `warning` about `surfaces` is to be given. The warning then counts as given. @param
  /// checksum checksum of the scene
  bool IsNew(vtkDataObject* surfaces, std::uint64_t checksum, const std::string& warning)
  {
    const bool moves = surfaces && surfaces->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP());
    const bool given = checksum == this->Checksum || (moves && warning == this->Given);
    const bool isNew = !warning.empty() && !given;
    this->Checksum = warning.empty() ? 0 : checksum;
    this->Given = warning;
    return isNew;
  }

private:
  std::uint64_t Checksum = 0;
  std::string Given;
};

#endif
