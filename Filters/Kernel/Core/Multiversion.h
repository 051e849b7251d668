// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Multiversion.h
 * @brief Functions compiled for several instruction sets, the best chosen when the program starts.
 *
 * Only for loops over independent lanes that results take their bits from (for what only decides
 * where to look there are vectors, RayLanes.h). As nothing is contracted or reassociated, every
 * version gives the same bits.
 *
 * These loops are plain C++ and not Highway because they call the very functions that single rays
 * call (rangeOnPlane(), for one), so that the bits agree by construction and nothing is written
 * twice. Ranges and cosines of a beam's hits took 8.0 ns a ray in the corridor on a processor with
 * AVX-512, and 13.4 ns without the versions.
 */
#ifndef avianlidar_Multiversion_h
#define avianlidar_Multiversion_h

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define AVIANLIDAR_MULTIVERSION \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define AVIANLIDAR_MULTIVERSION
#endif

/// For what such a loop calls: only inlined is it compiled for the loop's instruction set.
#if defined(__GNUC__)
#define AVIANLIDAR_ALWAYS_INLINE inline __attribute__((always_inline))
#define AVIANLIDAR_INLINE_LAMBDA __attribute__((always_inline))
#else
#define AVIANLIDAR_ALWAYS_INLINE inline
#define AVIANLIDAR_INLINE_LAMBDA
#endif

#endif
