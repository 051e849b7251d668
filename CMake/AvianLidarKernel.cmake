# SPDX-License-Identifier: BSD-3-Clause
# Options, libraries and the kernel, for every build of the project, also within another project.

list(APPEND CMAKE_MODULE_PATH "${CMAKE_CURRENT_SOURCE_DIR}/CMake")
include(GNUInstallDirs)
include(AvianLidarOptions)
include(AvianLidarDependencies)
add_subdirectory(Filters/Kernel)
add_subdirectory(Filters/VolumeTree)
