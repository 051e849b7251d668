# SPDX-License-Identifier: BSD-3-Clause
# Options, and settings of all targets of the project.

option(BUILD_SHARED_LIBS "Build vtkAvianLidar as a shared library" ON)
option(BUILD_TESTING "Build the tests" ON)
option(AVIANLIDAR_KERNEL_ONLY "Build the VTK-free kernel and its tests only" OFF)
option(AVIANLIDAR_BUILD_PYTHON "Build the Python package avianlidar" ON)
option(AVIANLIDAR_BUILD_PLUGIN "Build the ParaView plugin; VTK is then ParaView's" OFF)
option(AVIANLIDAR_KERNEL_TESTS "Build the tests of the VTK-free kernel" ON)
option(AVIANLIDAR_RENDERING_TESTS "Build the tests that draw (they need an X server)"
  "${AVIANLIDAR_BUILD_PLUGIN}")
option(AVIANLIDAR_BUILD_BENCHMARKS "Build Testing/Benchmarks (its run.sh does)" OFF)
option(AVIANLIDAR_BUILD_FUZZERS "Build Testing/Fuzzing (needs clang)" OFF)
option(AVIANLIDAR_FUZZ_COVERAGE "Count which code an input of the fuzzers reaches: needed to find new ones, not to replay those known" ON)
set(AVIANLIDAR_TEST_PREFIX "" CACHE STRING
  "Begins the name of every test, to tell builds apart that one ctest runs together")
set(AVIANLIDAR_VTK_SDK "" CACHE PATH
  "Folder that Debian's VTK 9.1 packages are unpacked into; empty: VTK_DIR, the system's VTK or ParaView's")
set(AVIANLIDAR_KERNEL_LIBRARY "" CACHE FILEPATH
  "libavianlidarKernel.a of another build of these sources, with the same compiler and options; empty: it is built here")
set(AVIANLIDAR_SANITIZE "" CACHE STRING
  "Value of -fsanitize= for all targets, for example address,undefined; empty: none")
set(AVIANLIDAR_DATA_DIR "$ENV{AVIANLIDAR_DATA_DIR}" CACHE PATH
  "Folder of the rich sceneries; tests that need it are reported as skipped where it is empty")

if (PROJECT_IS_TOP_LEVEL)
  option(CMAKE_UNITY_BUILD "Compile sources twenty at a time: the whole in less than half the time; OFF to work on single files" ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 20)
endif ()

# If ccache is installed, objects compiled before are reused, also from another build tree.
find_program(AVIANLIDAR_CCACHE ccache)
mark_as_advanced(AVIANLIDAR_CCACHE)
foreach (language IN ITEMS C CXX)
  if (AVIANLIDAR_CCACHE AND NOT DEFINED CMAKE_${language}_COMPILER_LAUNCHER)
    set(CMAKE_${language}_COMPILER_LAUNCHER "${AVIANLIDAR_CCACHE}")
  endif ()
endforeach ()

if (NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif ()

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_BINDIR}")

# No fused multiply-add, so that all machines give the same bits: a fused multiply-add rounds once, and two
# operations round twice.
add_compile_options("$<$<COMPILE_LANGUAGE:C,CXX>:-ffp-contract=off>")
# The project does not read errno or floating-point flags. Without errno and flags, the compiler can vectorize
# loops over lanes. The options do not change results.
add_compile_options("$<$<COMPILE_LANGUAGE:C,CXX>:-fno-math-errno>" "$<$<COMPILE_LANGUAGE:C,CXX>:-fno-trapping-math>")

# Every deprecated function of VTK gives a warning, also a function that only a later version deprecates.
add_compile_definitions(VTK_DEPRECATION_LEVEL=99900000000ULL)

if (CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>") # GCC treats a source in a unity file as a header
endif ()

if (AVIANLIDAR_SANITIZE)
  add_compile_options("-fsanitize=${AVIANLIDAR_SANITIZE}" -fno-sanitize-recover=all
    -fno-omit-frame-pointer
    "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:-Wno-pass-failed>") # with a sanitizer, loops are not vectorized
  add_link_options("-fsanitize=${AVIANLIDAR_SANITIZE}")
  # An index beyond the end of a vector may lie in memory that the vector has allocated. Sanitizers miss such an index.
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
endif ()

if (AVIANLIDAR_BUILD_FUZZERS AND AVIANLIDAR_FUZZ_COVERAGE)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif ()

if (BUILD_TESTING)
  enable_testing()
endif ()
