// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarErrorsAsData.h
 * @brief The property ErrorsAsData, which every algorithm of the module has.
 *
 * Whether an execution that fails counts as done, so that the pipeline goes on, on empty outputs
 * whose field data `error` hold the message. Default: off, an error is a failure of the pipeline,
 * too. The proxies of ParaView turn it on, as ParaView never updates again what failed.
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
