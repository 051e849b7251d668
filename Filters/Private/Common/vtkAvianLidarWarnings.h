// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarWarnings.h
 * @brief A warning about surfaces is given once for each scene, and once for all times of a scene
 * that moves. Not installed.
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
  /// Is `warning` about `surfaces` to be given? It counts as given then. `checksum`: of the scene.
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
