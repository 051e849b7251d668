# SPDX-License-Identifier: BSD-3-Clause
# Tests of the kernel with GoogleTest: executables, and one ctest entry per file (a process of its own each).

set(avianlidar_kernel_test_timeout 300)
set(avianlidar_kernel_test_labels kernel)
if (AVIANLIDAR_SANITIZE)
  set(avianlidar_kernel_test_timeout 900)
endif ()

# Archer, which comes with clang's OpenMP runtime, tells ThreadSanitizer what that runtime synchronises, and asks for
# silence about the runtime itself.
set(avianlidar_sanitizer_environment)
if (AVIANLIDAR_SANITIZE MATCHES "thread")
  if (NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "ThreadSanitizer takes GCC's OpenMP runtime for a crowd of races: use clang (preset tsan)")
  endif ()
  set(avianlidar_kernel_test_labels kernel nightly) # not in continuous integration
  # The child of a fork begins threads, which ThreadSanitizer refuses unless it is told to go on.
  set(avianlidar_sanitizer_environment "TSAN_OPTIONS=ignore_noninstrumented_modules=1:die_after_fork=0")
endif ()

# Clang's OpenMP runtime keeps what it has allocated for its threads. It lies below every parallel loop, too: only what it
# allocates itself has it in the two uppermost frames.
if (AVIANLIDAR_SANITIZE MATCHES "address" AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  file(WRITE "${CMAKE_BINARY_DIR}/leaks.txt" "leak:libomp\n")
  set(avianlidar_sanitizer_environment
    "ASAN_OPTIONS=malloc_context_size=2" "LSAN_OPTIONS=suppressions=${CMAKE_BINARY_DIR}/leaks.txt:print_suppressions=0")
endif ()

# Cases that take seconds. The tests of their files leave them out; Kernel-Slow runs them.
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

# avianlidar_add_kernel_tests(<executable> <name> <file>...): finish the executable that holds these
# files, and add a test <name>-<file without ending> for each. TestX.cxx holds the suites X, XFoo, XBar,
# ...: found by reading the file, checked again by the filter, which must match at least one test.
function (avianlidar_add_kernel_tests target prefix)
  # The tests themselves need no optimised code, which takes half as long again to compile.
  target_compile_options("${target}" PRIVATE -Wall -Wextra -Wshadow -O1)
  target_link_libraries("${target}"
    PRIVATE
      avianlidarVolumeTree
      AvianLidar::GeographicLib
      AvianLidar::Random123
      hwy::hwy
      GTest::gtest_main)
  if (AVIANLIDAR_SANITIZE)
    # Tests of millions of rays may take fewer where each costs ten times as much.
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
