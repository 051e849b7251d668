// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Sanitized.h
 * @brief Whether a test runs under a sanitizer, which looks for faults of memory and needs no
 * statistics.
 */
#ifndef Sanitized_h
#define Sanitized_h

#if defined(AVIANLIDAR_SANITIZED)
constexpr bool IsSanitized = true;
#else
constexpr bool IsSanitized = false;
#endif

#endif
