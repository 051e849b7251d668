// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarFilePath.h
 * @brief Declares setter and getter of a file name that is a std::string; vtkSetFilePathMacro()
 * only takes a char*.
 */
#ifndef vtkAvianLidarFilePath_h
#define vtkAvianLidarFilePath_h

#include "vtkSetGet.h" // For VTK_FILEPATH

#include <string> // For the name

/// Declares setter and getter in the public part of a class.
#define vtkAvianLidarFilePathMacro(name)                           \
  virtual void Set##name(VTK_FILEPATH const std::string& fileName) \
  {                                                                \
    if (fileName != this->name)                                    \
    {                                                              \
      this->name = fileName;                                       \
      this->Modified();                                            \
    }                                                              \
  }                                                                \
  VTK_FILEPATH virtual std::string Get##name()                     \
  {                                                                \
    return this->name;                                             \
  }

#endif
