// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Aborted.h
 * @brief The user stopped a reader or a writer; not a fault of the file.
 */
#ifndef AvianLidarAborted_h
#define AvianLidarAborted_h

#include <stdexcept>

namespace avianlidar
{
class Aborted : public std::runtime_error
{
public:
  Aborted()
    : std::runtime_error("aborted")
  {
  }
};
}

#endif
