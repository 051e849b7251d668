// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Sanitized.h
 * @brief Whether a test runs under a sanitizer, which looks for faults of memory and needs no
 * statistics, and how many cases a test tries.
 */
#ifndef Sanitized_h
#define Sanitized_h

#include <cstdint>
#include <cstdlib>

#if defined(AVIANLIDAR_SANITIZED)
constexpr bool IsSanitized = true;
#else
constexpr bool IsSanitized = false;
#endif

/// The number that an environment variable asks for; without it the usual one.
inline std::uint64_t casesAskedFor(const char* variable, std::uint64_t usually)
{
  const char* const text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : usually;
}

#endif
