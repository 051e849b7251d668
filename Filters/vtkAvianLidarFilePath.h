// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarFilePath.h
 * @brief Setter and getter of a property that is the name of a file and a std::string:
 * vtkSetFilePathMacro() has those of a char* alone.
 */
#ifndef vtkAvianLidarFilePath_h
#define vtkAvianLidarFilePath_h

#include "vtkSetGet.h" // For VTK_FILEPATH

#include <string> // For the name

/// In the public part of a class.
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
