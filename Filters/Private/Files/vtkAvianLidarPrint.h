// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarPrint.h
 * @brief Defines PrintSelf() of a class by the names of its properties.
 */
#ifndef vtkAvianLidarPrint_h
#define vtkAvianLidarPrint_h

#include "vtkIndent.h"

#include <cstring>
#include <ostream>
#include <type_traits>

/// Prints a line "Name: value" for each member or Get function that the arguments name.
#define vtkAvianLidarPrintMacro(...) \
  vtkAvianLidarPrint::Lines(os, indent, #__VA_ARGS__, __VA_ARGS__)

/// Defines PrintSelf() as the lines of the superclass and of the arguments.
#define vtkAvianLidarPrintSelfMacro(class, ...)         \
  void class ::PrintSelf(ostream& os, vtkIndent indent) \
  {                                                     \
    this->Superclass::PrintSelf(os, indent);            \
    vtkAvianLidarPrintMacro(__VA_ARGS__);               \
  }                                                     \
  static_assert(true, "for the semicolon")

namespace vtkAvianLidarPrint
{
/// Prints a value, the elements of an array, or "(none)" for a missing text.
template <class T>
void Value(std::ostream& os, const T& value)
{
  if constexpr (std::is_array_v<T>)
  {
    const char* space = "";
    for (const auto element : value)
    {
      os << space << element;
      space = " ";
    }
  }
  else if constexpr (std::is_same_v<T, char*> || std::is_same_v<T, const char*>)
  {
    os << (value ? value : "(none)");
  }
  else
  {
    os << value;
  }
}

/// Prints values with their names, which `names` holds in the same order, with commas between.
template <class... Values>
void Lines(std::ostream& os, vtkIndent indent, const char* names, const Values&... values)
{
  const auto print = [&](const auto& value)
  {
    names += std::strncmp(names, "Get", 3) == 0 ? 3 : 0;
    os << indent;
    os.write(names, static_cast<std::streamsize>(std::strcspn(names, ",("))) << ": ";
    Value(os, value);
    os << "\n";
    names += std::strcspn(names, ",");
    names += std::strspn(names, ", ");
  };
  (print(values), ...);
}
}

#endif
