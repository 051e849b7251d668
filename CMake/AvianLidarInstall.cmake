# SPDX-License-Identifier: BSD-3-Clause
# Files for find_package(AvianLidar) in the build tree and in the install tree.

include(CMakePackageConfigHelpers)
# Folder of the files that vtk_module_build() writes, relative to AvianLidarConfig.cmake.
set(AVIANLIDAR_PACKAGE_FILES "/AvianLidar/${AVIANLIDAR_CMAKE_DESTINATION}")
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/CMake/AvianLidarConfig.cmake.in"
  "${CMAKE_BINARY_DIR}/AvianLidarConfig.cmake"
  INSTALL_PREFIX "${CMAKE_BINARY_DIR}"
  INSTALL_DESTINATION "${CMAKE_BINARY_DIR}")
set(AVIANLIDAR_PACKAGE_FILES "")
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/CMake/AvianLidarConfig.cmake.in"
  "${CMAKE_BINARY_DIR}/CMakeFiles/AvianLidarConfig.cmake"
  INSTALL_DESTINATION "${AVIANLIDAR_CMAKE_DESTINATION}")
write_basic_package_version_file("${CMAKE_BINARY_DIR}/AvianLidarConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
configure_file("${PROJECT_SOURCE_DIR}/CMake/AvianLidarPythonTargets.cmake" "${CMAKE_BINARY_DIR}" COPYONLY)
install(
  FILES
    "${CMAKE_BINARY_DIR}/CMakeFiles/AvianLidarConfig.cmake"
    "${PROJECT_SOURCE_DIR}/CMake/AvianLidarPythonTargets.cmake"
    "${CMAKE_BINARY_DIR}/AvianLidarConfigVersion.cmake"
  DESTINATION "${AVIANLIDAR_CMAKE_DESTINATION}"
  COMPONENT development)
