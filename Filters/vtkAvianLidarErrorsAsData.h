// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarErrorsAsData.h
 * @brief Declares the property ErrorsAsData, which every algorithm of the module has.
 *
 * If ErrorsAsData is on, an execution that fails counts as done: the pipeline goes on with empty
 * outputs whose field data `error` hold the message. ParaView's proxies turn the property on,
 * because ParaView never updates a failed filter again. Default: off.
 */
#ifndef vtkAvianLidarErrorsAsData_h
#define vtkAvianLidarErrorsAsData_h

#include "vtkSetGet.h" // For set and get macros

/// Declares the property in the public part of a class. The classes have no common superclass that
/// could hold the property.
#define vtkAvianLidarErrorsAsDataMacro() \
  vtkSetMacro(ErrorsAsData, bool);       \
  vtkGetMacro(ErrorsAsData, bool);       \
  vtkBooleanMacro(ErrorsAsData, bool);   \
                                         \
protected:                               \
  bool ErrorsAsData = false;             \
                                         \
public:

#endif
