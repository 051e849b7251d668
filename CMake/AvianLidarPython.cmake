# SPDX-License-Identifier: BSD-3-Clause
# The Python package avianlidar: `from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter`.

vtk_module_python_default_destination(AVIANLIDAR_PYTHON_DESTINATION)
set(AVIANLIDAR_PYTHON_BUILD_DIR "${CMAKE_BINARY_DIR}/${AVIANLIDAR_PYTHON_DESTINATION}")

vtk_module_wrap_python(
  MODULES AvianLidar::AvianLidar
  TARGET AvianLidar::AvianLidarPythonModules
  PYTHON_PACKAGE avianlidar
  MODULE_DESTINATION "${AVIANLIDAR_PYTHON_DESTINATION}"
  LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  INSTALL_HEADERS OFF
  BUILD_STATIC OFF)

# The wrapping makes the extension module only; the package is made here.
set(avianlidar_python_init "${AVIANLIDAR_PYTHON_BUILD_DIR}/avianlidar/__init__.py")
configure_file("${PROJECT_SOURCE_DIR}/CMake/__init__.py.in" "${avianlidar_python_init}" @ONLY)
install(FILES "${avianlidar_python_init}"
  DESTINATION "${AVIANLIDAR_PYTHON_DESTINATION}/avianlidar"
  COMPONENT python)

# Where scripts find the package in the build tree.
file(WRITE "${CMAKE_BINARY_DIR}/python-path" "${AVIANLIDAR_PYTHON_BUILD_DIR}\n")
