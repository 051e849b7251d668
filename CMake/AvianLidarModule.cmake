# SPDX-License-Identifier: BSD-3-Clause
# The module vtkAvianLidar.

include("${CMAKE_CURRENT_LIST_DIR}/AvianLidarSources.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/AvianLidarPrivateFolders.cmake")
vtk_module_add_module(AvianLidar::AvianLidar
  CLASSES ${classes}
  NOWRAP_HEADERS Filters/vtkAvianLidarProperties.h
  SOURCES ${private_sources})

# Built-in data files, as text.
set(built_in_texts "")
include("${CMAKE_CURRENT_LIST_DIR}/AvianLidarBuiltIn.cmake")
foreach(built_in IN LISTS built_in_files)
  set(built_in_file "${CMAKE_CURRENT_SOURCE_DIR}/Filters/${built_in}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${built_in_file}")
  file(READ "${built_in_file}" built_in_text)
  get_filename_component(built_in_name "${built_in}" NAME)
  string(APPEND built_in_texts "  { \"${built_in_name}\", R\"TEXT(${built_in_text})TEXT\" },\n")
endforeach()
configure_file(CMake/BuiltInTexts.cxx.in "${CMAKE_CURRENT_BINARY_DIR}/BuiltInTexts.cxx" @ONLY)
target_sources(AvianLidar PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/BuiltInTexts.cxx")

# The classes are in folders, but users and wrappers include their headers by name.
vtk_module_include(AvianLidar::AvianLidar
  PUBLIC
    "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/Filters>"
    "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/IO>"
  PRIVATE
    ${private_include_dirs}
    "$<TARGET_PROPERTY:avianlidarKernel,INTERFACE_INCLUDE_DIRECTORIES>"
    "$<TARGET_PROPERTY:avianlidarVolumeTree,INTERFACE_INCLUDE_DIRECTORIES>")

# Installed headers do not use these libraries.
vtk_module_link(AvianLidar::AvianLidar
  PRIVATE
    avianlidarVolumeTree
    avianlidarKernel
    AvianLidar::boost
    AvianLidar::expat
    AvianLidar::xxhash
    AvianLidar::geos
    AvianLidar::glu
    AvianLidar::utf8
    GDAL::GDAL
    AvianLidar::laszip
    liblzf::liblzf
    nlohmann_json::nlohmann_json)
vtk_module_definitions(AvianLidar::AvianLidar
  PRIVATE "AVIANLIDAR_VERSION=\"${PROJECT_VERSION}\"")
target_compile_options(AvianLidar PRIVATE -Wall -Wextra -Wshadow)
