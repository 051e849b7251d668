# SPDX-License-Identifier: BSD-3-Clause
# Tests of the kernel with GoogleTest: executables, and one ctest entry with its own process per file.

set(avianlidar_kernel_test_timeout 300)
set(avianlidar_kernel_test_labels kernel)
if (AVIANLIDAR_SANITIZE)
  set(avianlidar_kernel_test_timeout 900)
endif ()

# Archer, a part of clang's OpenMP runtime, reports the synchronisation of the runtime to ThreadSanitizer. With Archer,
# ThreadSanitizer must ignore the runtime itself.
set(avianlidar_sanitizer_environment)
if (AVIANLIDAR_SANITIZE MATCHES "thread")
  if (NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "ThreadSanitizer takes GCC's OpenMP runtime for a crowd of races: use clang (preset tsan)")
  endif ()
  set(avianlidar_kernel_test_labels kernel nightly) # not in continuous integration
  # The child of a fork starts threads. With die_after_fork=0, ThreadSanitizer allows these threads.
  set(avianlidar_sanitizer_environment "TSAN_OPTIONS=ignore_noninstrumented_modules=1:die_after_fork=0")
endif ()

# Clang's OpenMP runtime does not free the memory of its threads. The runtime is in the call stacks of all parallel loops.
# With two frames per stack, only the runtime's own allocations match the suppression.
if (AVIANLIDAR_SANITIZE MATCHES "address" AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  file(WRITE "${CMAKE_BINARY_DIR}/leaks.txt" "leak:libomp\n")
  set(avianlidar_sanitizer_environment
    "ASAN_OPTIONS=malloc_context_size=2" "LSAN_OPTIONS=suppressions=${CMAKE_BINARY_DIR}/leaks.txt:print_suppressions=0")
endif ()

# Slow cases (seconds). The tests of their files leave out slow cases. The test Kernel-Slow runs all slow cases.
set(avianlidar_slow_kernel_cases)
foreach (list IN ITEMS slow-cases slow-cases-sanitized)
  set(file "${PROJECT_SOURCE_DIR}/Testing/Kernel/${list}.txt")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  if (list STREQUAL "slow-cases" OR AVIANLIDAR_SANITIZE)
    file(STRINGS "${file}" cases REGEX "^[^#]")
    list(APPEND avianlidar_slow_kernel_cases ${cases})
  endif ()
endforeach ()
list(JOIN avianlidar_slow_kernel_cases ":" avianlidar_slow_kernel_cases)

# avianlidar_add_kernel_tests(<executable> <name> <file>...): sets options and libraries of the executable
# that contains these files, and adds a test <name>-<file without extension> for each file. The names of the
# suites come from the text of the file. A test fails if its filter does not match at least one case.
function (avianlidar_add_kernel_tests target prefix)
  # Low optimisation, because full optimisation increases the compile time by half.
  target_compile_options("${target}" PRIVATE -Wall -Wextra -Wshadow -O1)
  target_link_libraries("${target}"
    PRIVATE
      avianlidarVolumeTree
      AvianLidar::GeographicLib
      AvianLidar::Random123
      hwy::hwy
      GTest::gtest_main)
  if (AVIANLIDAR_SANITIZE)
    # Tests may use fewer rays, because each ray takes ten times as long with a sanitizer.
    target_compile_definitions("${target}" PRIVATE AVIANLIDAR_SANITIZED)
  endif ()
  foreach (file IN LISTS ARGN)
    get_filename_component(name "${file}" NAME_WE)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    file(STRINGS "${file}" lines REGEX "^(TEST|TEST_F|TEST_P|TYPED_TEST|INSTANTIATE_TEST_SUITE_P)\\(")
    set(filters)
    foreach (line IN LISTS lines)
      if (line MATCHES "^(TEST|TEST_F|TYPED_TEST)\\(([A-Za-z0-9_]+)")
        list(APPEND filters "${CMAKE_MATCH_2}.*" "${CMAKE_MATCH_2}/*")
      elseif (line MATCHES "^TEST_P\\(([A-Za-z0-9_]+)")
        list(APPEND filters "*/${CMAKE_MATCH_1}.*")
      endif ()
    endforeach ()
    list(REMOVE_DUPLICATES filters)
    list(JOIN filters ":" filters)
    set(test "${AVIANLIDAR_TEST_PREFIX}${prefix}-${name}")
    add_test(NAME "${test}" COMMAND "${target}" "--gtest_filter=${filters}-${avianlidar_slow_kernel_cases}")
    set_tests_properties("${test}" PROPERTIES
      LABELS "${avianlidar_kernel_test_labels}"
      TIMEOUT ${avianlidar_kernel_test_timeout}
      ENVIRONMENT "${avianlidar_sanitizer_environment}"
      FAIL_REGULAR_EXPRESSION "0 tests from 0 test suites ran")
  endforeach ()
endfunction ()
