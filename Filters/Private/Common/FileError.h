// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FileError.h
 * @brief Declares the error of a bad file of a scene or a sensor.
 */
#ifndef AvianLidarFileError_h
#define AvianLidarFileError_h

#include <stdexcept>

namespace avianlidar
{
/// Error whose message names the file, and the key or the value that is wrong.
class FileError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};
}

#endif
