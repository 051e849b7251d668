// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Multiversion.h
 * @brief Functions compiled for several instruction sets. The version for the best instruction set
 * of the processor is chosen at program start.
 *
 * The macros serve only loops over independent lanes whose results must have the same bits
 * everywhere. The compiler does not contract or reassociate operations, so every version gives the
 * same bits. Code that only decides which nodes and triangles are tested uses Highway's vectors
 * (RayLanes.h).
 *
 * The loops are plain C++ because they call the functions that single rays call, such as
 * rangeOnPlane(). The bits of loops and single rays therefore agree by construction. In the paper's
 * corridor, on a processor with AVX-512, the ranges and cosines of a beam's hits took 8.0 ns per
 * ray, and 13.4 ns without the versions.
 * Source: none.
 * Valid: GCC on x86-64 compiles all versions. Elsewhere the functions are compiled once.
 * Test: InstructionSets.cxx with compare_instruction_sets.py (the same bits on several
 * processors), check_flags.py.
 */
#ifndef avianlidar_Multiversion_h
#define avianlidar_Multiversion_h

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define AVIANLIDAR_MULTIVERSION \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define AVIANLIDAR_MULTIVERSION
#endif

/// Attributes of functions that multiversion loops call. Only inlined code is compiled for the
/// loop's instruction set.
#if defined(__GNUC__)
#define AVIANLIDAR_ALWAYS_INLINE inline __attribute__((always_inline))
#define AVIANLIDAR_INLINE_LAMBDA __attribute__((always_inline))
#else
#define AVIANLIDAR_ALWAYS_INLINE inline
#define AVIANLIDAR_INLINE_LAMBDA
#endif

#endif
