# SPDX-License-Identifier: BSD-3-Clause
# Imported targets of all libraries outside VTK. Other files do not search for libraries.

find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(Threads REQUIRED)
find_package(hwy 1.0 CONFIG REQUIRED)

# avianlidar_find_library(<target> <header> [<library>]): defines an imported target for a library without a
# CMake package. Without <library> the target has only headers.
function (avianlidar_find_library target header)
  string(MAKE_C_IDENTIFIER "AVIANLIDAR_${target}" prefix)
  find_path("${prefix}_INCLUDE_DIR" "${header}" REQUIRED)
  mark_as_advanced("${prefix}_INCLUDE_DIR")
  add_library("AvianLidar::${target}" INTERFACE IMPORTED)
  target_include_directories("AvianLidar::${target}" SYSTEM INTERFACE "${${prefix}_INCLUDE_DIR}")
  if (ARGC GREATER 2)
    find_library("${prefix}_LIBRARY" "${ARGV2}" REQUIRED)
    mark_as_advanced("${prefix}_LIBRARY")
    target_link_libraries("AvianLidar::${target}" INTERFACE "${${prefix}_LIBRARY}")
  endif ()
endfunction ()

avianlidar_find_library(GeographicLib GeographicLib/Geocentric.hpp GeographicLib)
avianlidar_find_library(glm glm/glm.hpp)
avianlidar_find_library(boost boost/version.hpp)
avianlidar_find_library(xxhash xxhash.h xxhash)

# Optional: without LASzip the project cannot read or write LAZ files.
find_path(AVIANLIDAR_LASZIP_INCLUDE_DIR laszip/laszip_api.h)
find_library(AVIANLIDAR_LASZIP_LIBRARY laszip)
mark_as_advanced(AVIANLIDAR_LASZIP_INCLUDE_DIR AVIANLIDAR_LASZIP_LIBRARY)
add_library(AvianLidar::laszip INTERFACE IMPORTED)
if (AVIANLIDAR_LASZIP_INCLUDE_DIR AND AVIANLIDAR_LASZIP_LIBRARY)
  target_include_directories(AvianLidar::laszip SYSTEM INTERFACE "${AVIANLIDAR_LASZIP_INCLUDE_DIR}")
  target_link_libraries(AvianLidar::laszip INTERFACE "${AVIANLIDAR_LASZIP_LIBRARY}")
  target_compile_definitions(AvianLidar::laszip INTERFACE AVIANLIDAR_LASZIP)
endif ()

if (BUILD_TESTING)
  find_package(GTest REQUIRED)
  avianlidar_find_library(Random123 Random123/philox.h)
endif ()
if (BUILD_TESTING OR AVIANLIDAR_BUILD_BENCHMARKS)
  find_package(embree REQUIRED) # version 3 or 4
endif ()

if (NOT AVIANLIDAR_KERNEL_ONLY)
  find_package(assimp REQUIRED)
  find_package(GDAL REQUIRED)
  avianlidar_find_library(expat expat.h expat)
  avianlidar_find_library(geos geos_c.h geos_c)
  avianlidar_find_library(glu GL/glu.h GLU)
  avianlidar_find_library(utf8 utf8.h)
  find_package(liblzf REQUIRED)
  find_package(nlohmann_json REQUIRED)
  if (BUILD_TESTING AND AVIANLIDAR_BUILD_PYTHON)
    find_package(mrpt-maps REQUIRED)
  endif ()
endif ()
