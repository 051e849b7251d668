// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarAdvice.h
 * @brief Advice about surfaces is given once for each scene, and once for all times of one that
 * moves. Not installed.
 */
#ifndef vtkAvianLidarAdvice_h
#define vtkAvianLidarAdvice_h

#include "vtkDataObject.h"
#include "vtkInformation.h"

#include <cstdint>
#include <string>

class vtkAvianLidarAdvice
{
public:
  /// Is `advice` about `surfaces` to be given? It counts as given then. `checksum`: of the scene.
  bool IsNew(vtkDataObject* surfaces, std::uint64_t checksum, const std::string& advice)
  {
    const bool moves = surfaces && surfaces->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP());
    const bool given = checksum == this->Checksum || (moves && advice == this->Given);
    const bool isNew = !advice.empty() && !given;
    this->Checksum = advice.empty() ? 0 : checksum;
    this->Given = advice;
    return isNew;
  }

private:
  std::uint64_t Checksum = 0;
  std::string Given;
};

#endif
