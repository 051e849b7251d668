// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FileError.h
 * @brief Anything wrong with a file of a scene or a sensor.
 */
#ifndef AvianLidarFileError_h
#define AvianLidarFileError_h

#include <stdexcept>

namespace avianlidar
{
/// The message names the file, and the key or the input.
class FileError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};
}

#endif
