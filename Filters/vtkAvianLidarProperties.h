// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarProperties.h
 * @brief Declares properties: each macro declares setter, getter and member, with the default, in
 * the public part of a class.
 */
#ifndef vtkAvianLidarProperties_h
#define vtkAvianLidarProperties_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkSetGet.h"           // For set and get macros
#include "vtkSmartPointer.h"     // For the controller

#include <string> // For names of files

class vtkExecutive;
class vtkInformation;
class vtkMultiProcessController;

/// Declares a property of any type.
#define vtkAvianLidarPropertyMacro(name, type, ...) \
  vtkSetMacro(name, type);                          \
  vtkGetMacro(name, type);                          \
                                                    \
protected:                                          \
  type name = __VA_ARGS__;                          \
                                                    \
public:

/// Declares a property that is on or off.
#define vtkAvianLidarSwitchMacro(name, value)    \
  vtkAvianLidarPropertyMacro(name, bool, value); \
  vtkBooleanMacro(name, bool)

/// Declares a whole number, limited to `low` to `high` by the setter.
#define vtkAvianLidarLimitedMacro(name, low, high, value) \
  vtkSetClampMacro(name, int, low, high);                 \
  vtkGetMacro(name, int);                                 \
                                                          \
protected:                                                \
  int name = value;                                       \
                                                          \
public:

/// Declares a property of `size` doubles: 2, 3 or 6.
#define vtkAvianLidarVectorMacro(name, size, ...) \
  vtkSetVector##size##Macro(name, double);        \
  vtkGetVector##size##Macro(name, double);        \
                                                  \
protected:                                        \
  double name[size] = { __VA_ARGS__ };            \
                                                  \
public:

/// Declares the name of a file as a std::string, empty by default. VTK's vtkSetFilePathMacro() only
/// takes a char*.
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
  }                                                                \
                                                                   \
protected:                                                         \
  std::string name;                                                \
                                                                   \
public:

/// Declares the Controller of a filter whose ranks work together, and ModifyRequest(), which
/// updates the inputs of all ranks. vtkAvianLidarCxxControllerMacro() defines these functions.
#define vtkAvianLidarControllerMacro()                           \
  void SetController(vtkMultiProcessController* controller);     \
  vtkMultiProcessController* GetController();                    \
                                                                 \
protected:                                                       \
  int ModifyRequest(vtkInformation* request, int when) override; \
  vtkSmartPointer<vtkMultiProcessController> Controller;         \
                                                                 \
public:

/// Declares ErrorsAsData, which every algorithm of the module has. If ErrorsAsData is on, an
/// execution that fails counts as done: the pipeline goes on with empty outputs whose field data
/// `error` hold the message. ParaView's proxies turn the property on, because ParaView never
/// updates a failed filter again. Default: off.
///
/// If ErrorsAsData is off, VTK does not execute a filter whose producer failed.
/// CreateDefaultExecutive() makes an executive that then empties the outputs.
#define vtkAvianLidarErrorsAsDataMacro()                                               \
  vtkAvianLidarSwitchMacro(ErrorsAsData, false);                                       \
                                                                                       \
protected:                                                                             \
  vtkExecutive* CreateDefaultExecutive() override                                      \
  {                                                                                    \
    return vtkAvianLidarEmptyingExecutive(this->Superclass::CreateDefaultExecutive()); \
  }                                                                                    \
                                                                                       \
public:

/// Replace a vtkCompositeDataPipeline by one that empties the outputs of its algorithm if a request
/// fails anywhere upstream, with the reason as field data `error`. Other executives are returned.
VTKAVIANLIDAR_EXPORT vtkExecutive* vtkAvianLidarEmptyingExecutive(vtkExecutive* usual);

#endif
