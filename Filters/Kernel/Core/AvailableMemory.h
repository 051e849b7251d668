// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AvailableMemory.h
 * @brief How much memory the process may still take, and an error before a request that needs
 * more.
 *
 * A system that overcommits grants any request and ends the process when the memory is written to.
 * So the few requests whose size a property or a file decides are estimated first.
 *
 * Source: none.
 * Valid: on Linux the smallest of what the address limit (RLIMIT_AS) leaves, what the control
 * group and those above it leave (version 1 or 2; file caches count as free), and MemAvailable.
 * Elsewhere nothing is known and nothing is refused. Other processes may take the memory
 * afterwards: an estimate is no promise.
 * Test: TestAvailableMemory.cxx.
 */
#ifndef avianlidar_AvailableMemory_h
#define avianlidar_AvailableMemory_h

#include <stdexcept>
#include <string>

namespace avianlidar
{
/// A request that is larger than the memory there is.
class MemoryError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Bytes; infinite if nothing limits them.
double availableMemory();

/// Bytes that the address limit alone leaves; costs nothing where there is none.
double availableAddresses();

/// The same, from the files of a system below `root` and with an address limit in bytes.
double availableMemory(const std::string& root, double addressLimit);

/// Throws MemoryError, "100,000,000 beams need about 12 GB, 3 GB are available", unless `bytes` are
/// available. Requests below 64 MB are not checked.
/// @param what "beams"
void requireMemory(double count, const std::string& what, double bytes);
}

#endif
