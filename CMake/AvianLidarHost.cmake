# SPDX-License-Identifier: BSD-3-Clause
# Parts that the module needs if another project builds it with vtk_module_scan() and vtk_module_build(): the kernel and the
# program that reads mesh files, without tests, Python package and plugin.

set(BUILD_TESTING OFF)
foreach (part IN ITEMS BUILD_PYTHON BUILD_PLUGIN KERNEL_TESTS RENDERING_TESTS BUILD_BENCHMARKS BUILD_FUZZERS)
  set("AVIANLIDAR_${part}" OFF)
endforeach ()
set(PROJECT_SOURCE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
file(STRINGS CMakeLists.txt version REGEX "^  VERSION ")
string(REGEX REPLACE ".* " "" PROJECT_VERSION "${version}")
include("${CMAKE_CURRENT_LIST_DIR}/AvianLidarKernel.cmake")
add_subdirectory(IO/MeshReader)
