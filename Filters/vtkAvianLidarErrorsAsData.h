// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarErrorsAsData.h
 * @brief The property ErrorsAsData, which every algorithm of the module has.
 *
 * If on, an execution that fails counts as done: the pipeline goes on with empty outputs whose
 * field data `error` hold the message. ParaView's proxies turn it on, as ParaView never updates
 * again what failed. Default: off.
 */
#ifndef vtkAvianLidarErrorsAsData_h
#define vtkAvianLidarErrorsAsData_h

#include "vtkSetGet.h" // For set and get macros

/// In the public part of a class. Superclasses differ, so none can hold it.
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
