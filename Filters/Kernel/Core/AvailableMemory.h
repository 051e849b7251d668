// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AvailableMemory.h
 * @brief Memory that the process may still take, and an error for requests that need more.
 *
 * A system that overcommits memory grants any request, and ends the process when the memory is
 * written to. Requests whose size depends on a property or a file are therefore estimated first.
 *
 * Source: none.
 * Valid: on Linux the available memory is the smallest of three numbers: the rest of the address
 * limit (RLIMIT_AS), the rest of the limits of the control group and the groups above it (version 1
 * or 2; file caches count as free), and MemAvailable. On other systems no request is refused. Other
 * processes may take the memory after the estimate.
 * Test: TestAvailableMemory.cxx.
 */
#ifndef avianlidar_AvailableMemory_h
#define avianlidar_AvailableMemory_h

#include <stdexcept>
#include <string>

namespace avianlidar
{
/// Exception for a request that is larger than the available memory.
class MemoryError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Available memory, bytes; infinite if nothing limits it.
double availableMemory();

/// Bytes that the address limit leaves, without regard to other limits. Without an address limit
/// the call costs no time.
double availableAddresses();

/// Available memory, bytes. @param root folder of the system files @param addressLimit limit of the
/// address space, bytes
double availableMemory(const std::string& root, double addressLimit);

/// Throw MemoryError ("100,000,000 beams need about 12 GB, 3 GB are available") unless `bytes` are
/// available. Requests below 64 MB are not checked.
/// @param count number of items @param what items in words, such as "beams" @param bytes memory of
/// all items, bytes
void requireMemory(double count, const std::string& what, double bytes);
}

#endif
