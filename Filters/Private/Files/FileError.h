// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FileError.h
 * @brief Declares the error of a bad file of a scene, a sensor or a point cloud.
 */
#ifndef AvianLidarFileError_h
#define AvianLidarFileError_h

#include <locale>
#include <sstream>
#include <stdexcept>
#include <string>

namespace avianlidar
{
/// Error whose message names the file, and the key or the value that is wrong.
class FileError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Returns a message from its parts: texts and numbers. Numbers do not depend on the locale. Throws
/// std::bad_alloc rather than cut a message short.
template <class... Parts>
std::string joined(const Parts&... parts)
{
  std::ostringstream message;
  message.imbue(std::locale::classic());
  message.exceptions(std::ios::badbit);
  (message << ... << parts);
  return message.str();
}

/// Throws FileError with the joined parts.
template <class... Parts>
[[noreturn]] void fail(const Parts&... parts)
{
  throw FileError(joined(parts...));
}

/// Throws FileError if `isBad` is true. The parts are joined only then.
template <class... Parts>
void failIf(bool isBad, const Parts&... parts)
{
  if (isBad)
  {
    fail(parts...);
  }
}
}

#endif
