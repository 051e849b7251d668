# SPDX-License-Identifier: BSD-3-Clause
# The module, the Python package, the plugin and the package files, in the order of their dependencies.

set(avianlidar_vtk_components
  CommonComputationalGeometry
  CommonCore
  CommonDataModel
  CommonExecutionModel
  CommonMath
  CommonMisc
  CommonSystem
  CommonTransforms
  FiltersCore
  FiltersGeneral
  FiltersGeometry
  FiltersModeling
  FiltersSources
  IOCore
  IOGeometry
  IOLegacy
  IOPLY
  IOXML
  ParallelCore
  vtksys
  zlib)
set(AVIANLIDAR_VTK_COMPONENTS "${avianlidar_vtk_components}")
if (AVIANLIDAR_BUILD_PYTHON)
  list(APPEND avianlidar_vtk_components Python WrappingPythonCore)
endif ()
if (BUILD_TESTING)
  list(APPEND avianlidar_vtk_components TestingCore)
endif ()
if (AVIANLIDAR_BUILD_BENCHMARKS)
  list(APPEND avianlidar_vtk_components FiltersFlowPaths)
endif ()
# Modules that image tests link to. TEST_OPTIONAL_DEPENDS of the module cannot replace this list: an imported
# target exists even if its own libraries are missing.
set(avianlidar_rendering_modules
  VTK::IOImage
  VTK::InteractionStyle
  VTK::RenderingAnnotation
  VTK::RenderingCore
  VTK::RenderingFreeType
  VTK::RenderingOpenGL2
  VTK::TestingRendering)
if (AVIANLIDAR_RENDERING_TESTS)
  foreach (module IN LISTS avianlidar_rendering_modules)
    string(REPLACE "VTK::" "" component "${module}")
    list(APPEND avianlidar_vtk_components "${component}")
  endforeach ()
endif ()

include(AvianLidarFindVtk)
if (AVIANLIDAR_VTK_SDK)
  list(APPEND CMAKE_PREFIX_PATH "${AVIANLIDAR_VTK_SDK}/usr")
  list(APPEND CMAKE_INSTALL_RPATH
    "$ORIGIN" "${AVIANLIDAR_VTK_SDK}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}")
  set(AVIANLIDAR_VTK_PYTHONPATH "${AVIANLIDAR_VTK_SDK}/usr/lib/python3/dist-packages")
endif ()

if (AVIANLIDAR_BUILD_PLUGIN)
  # Without Qt 6's preparation of programs with their own Qt: the preparation visits every folder below the project. The
  # module has the same folder as the project, so the preparation would not end.
  set(QT_SKIP_SETUP_DEPLOYMENT ON)
  # ParaView's package also finds ParaView's VTK.
  find_package(ParaView 5.11 REQUIRED
    COMPONENTS RemotingCore WrapClientServer)
endif ()
find_package(VTK 9.1 REQUIRED COMPONENTS ${avianlidar_vtk_components})

set(AVIANLIDAR_CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/AvianLidar")
set(AVIANLIDAR_HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/avianlidar")

include(AvianLidarTesting)

# vtk_module_build() names a module's build folder after its path below CMAKE_SOURCE_DIR. Here this path is
# empty, and the build folder would be the build tree. In this function the build tree is therefore a sub-folder.
function (avianlidar_build_module)
  set(CMAKE_BINARY_DIR "${CMAKE_BINARY_DIR}/AvianLidar")
  vtk_module_scan(
    MODULE_FILES "${PROJECT_SOURCE_DIR}/vtk.module"
    REQUEST_MODULES AvianLidar::AvianLidar
    PROVIDES_MODULES modules
    REQUIRES_MODULES required
    HIDE_MODULES_FROM_CACHE ON
    ENABLE_TESTS ${BUILD_TESTING})
  vtk_module_build(
    MODULES ${modules}
    PACKAGE AvianLidar
    VERSION "${PROJECT_VERSION}"
    SOVERSION "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}"
    INSTALL_EXPORT AvianLidar
    TARGET_NAMESPACE AvianLidar
    HEADERS_DESTINATION "${AVIANLIDAR_HEADERS_DESTINATION}"
    CMAKE_DESTINATION "${AVIANLIDAR_CMAKE_DESTINATION}"
    TEST_DATA_TARGET AvianLidarData
    TEST_OUTPUT_DIRECTORY "${AVIANLIDAR_TEST_OUTPUT_DIR}")
endfunction ()
avianlidar_build_module()
add_subdirectory(IO/MeshReader)
if (BUILD_TESTING)
  ExternalData_Add_Target(AvianLidarData)
endif ()

if (AVIANLIDAR_BUILD_PYTHON)
  include(AvianLidarPython)
endif ()
if (AVIANLIDAR_BUILD_PLUGIN)
  include(AvianLidarPlugin)
endif ()
include(AvianLidarInstall)
if (AVIANLIDAR_BUILD_PYTHON AND AVIANLIDAR_BUILD_PLUGIN)
  include(AvianLidarPackages)
endif ()
