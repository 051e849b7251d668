# SPDX-License-Identifier: BSD-3-Clause
# Sets ParaView_DIR and VTK_DIR, the folders in which find_package() finds ParaView and VTK of any version. In this order: the
# folders that the user has set; VTK 9.1 unpacked into a folder; for the plugin, ParaView and its VTK; the system's VTK;
# ParaView's VTK.

include(AvianLidarPythonTargets)

# The search uses a small file of each package that does not define targets.
if (NOT ParaView_DIR)
  find_package(AvianLidarParaViewFolder QUIET NAMES ParaView CONFIGS paraview-prefix.cmake
    HINTS "${ParaView_ROOT}" "$ENV{ParaView_ROOT}" "$ENV{ParaView_DIR}")
  mark_as_advanced(AvianLidarParaViewFolder_DIR)
  set(ParaView_DIR "${AvianLidarParaViewFolder_DIR}")
endif ()
if (AVIANLIDAR_VTK_SDK)
  # A Debian VTK unpacked into a folder (CMake/fetch-vtk-9.1.sh).
  set(VTK_DIR "${AVIANLIDAR_VTK_SDK}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/vtk-9.1")
elseif (AVIANLIDAR_BUILD_PLUGIN AND IS_DIRECTORY "${ParaView_DIR}/vtk")
  set(VTK_DIR "${ParaView_DIR}/vtk")
elseif (NOT VTK_DIR)
  find_package(AvianLidarVtkFolder QUIET NAMES VTK CONFIGS vtk-prefix.cmake
    HINTS "${VTK_ROOT}" "$ENV{VTK_ROOT}" "$ENV{VTK_DIR}" PATHS "${ParaView_DIR}/vtk")
  mark_as_advanced(AvianLidarVtkFolder_DIR)
  set(VTK_DIR "${AvianLidarVtkFolder_DIR}")
endif ()
avianlidar_define_python_targets("${ParaView_DIR}" "${VTK_DIR}")
