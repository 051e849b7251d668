# SPDX-License-Identifier: BSD-3-Clause
# find_package(AvianLidar) for the install tree.

include(CMakePackageConfigHelpers)
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/CMake/AvianLidarConfig.cmake.in"
  "${CMAKE_BINARY_DIR}/AvianLidarConfig.cmake"
  INSTALL_DESTINATION "${AVIANLIDAR_CMAKE_DESTINATION}")
write_basic_package_version_file("${CMAKE_BINARY_DIR}/AvianLidarConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(
  FILES
    "${CMAKE_BINARY_DIR}/AvianLidarConfig.cmake"
    "${CMAKE_BINARY_DIR}/AvianLidarConfigVersion.cmake"
  DESTINATION "${AVIANLIDAR_CMAKE_DESTINATION}"
  COMPONENT development)
