# SPDX-License-Identifier: BSD-3-Clause
# The Python package avianlidar, with helpers and the wrapped classes: `from avianlidar.vtkAvianLidar import ...`.

# Folder below /usr in which Debian's Python finds modules.
set(AVIANLIDAR_PYTHON_DESTINATION "lib/python3/dist-packages")
set(AVIANLIDAR_PYTHON_BUILD_DIR "${CMAKE_BINARY_DIR}/${AVIANLIDAR_PYTHON_DESTINATION}")

vtk_module_wrap_python(
  MODULES AvianLidar::AvianLidar
  TARGET AvianLidar::AvianLidarPythonModules
  PYTHON_PACKAGE avianlidar
  MODULE_DESTINATION "${AVIANLIDAR_PYTHON_DESTINATION}"
  LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  INSTALL_HEADERS OFF
  BUILD_STATIC OFF)

# The wrapping makes only the extension module. The lines below make the package with its helpers in Python.
set(folder "${PROJECT_SOURCE_DIR}/Python/avianlidar")
file(GLOB_RECURSE avianlidar_python_files RELATIVE "${folder}" CONFIGURE_DEPENDS
  "${folder}/*.py" "${folder}/*.json" "${folder}/*.jinja" "${folder}/*.js" "${folder}/*.ini" "${folder}/py.typed")
set(avianlidar_python_package "${AVIANLIDAR_PYTHON_BUILD_DIR}/avianlidar")
# Removes modules of an earlier build, because Python would still find renamed modules.
file(GLOB old "${avianlidar_python_package}/*.py")
file(REMOVE_RECURSE "${avianlidar_python_package}/apps" ${old})
configure_file("${PROJECT_SOURCE_DIR}/Python/avianlidar/_version.py.in" "${avianlidar_python_package}/_version.py" @ONLY)
foreach (file IN LISTS avianlidar_python_files)
  configure_file("${PROJECT_SOURCE_DIR}/Python/avianlidar/${file}" "${avianlidar_python_package}/${file}" COPYONLY)
  get_filename_component(folder "${file}" DIRECTORY)
  install(FILES "${avianlidar_python_package}/${file}"
    DESTINATION "${AVIANLIDAR_PYTHON_DESTINATION}/avianlidar/${folder}"
    COMPONENT python)
endforeach ()
# The shipped scene, which example_scene() finds.
file(GLOB scene CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/Examples/airport/scene/*")
foreach (file IN LISTS scene)
  get_filename_component(name "${file}" NAME)
  configure_file("${file}" "${avianlidar_python_package}/scene/${name}" COPYONLY)
endforeach ()
install(FILES ${scene} DESTINATION "${AVIANLIDAR_PYTHON_DESTINATION}/avianlidar/scene" COMPONENT python)
set(avianlidar_python_generated "${avianlidar_python_package}/_version.py")

# Type stubs of the wrapped module, by VTK's own generator, which imports the module. ParaView's VTK has the generator, but
# Debian's VTK 9.1 does not.
set(avianlidar_python_command "${CMAKE_COMMAND}" -E env
  "PYTHONPATH=${AVIANLIDAR_PYTHON_BUILD_DIR}:${AVIANLIDAR_VTK_PYTHONPATH}" PYTHONDONTWRITEBYTECODE=1
  "${Python3_EXECUTABLE}")
execute_process(COMMAND ${avianlidar_python_command} -c "import vtkmodules.generate_pyi"
  RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
if (result EQUAL 0)
  set(avianlidar_stubs "${avianlidar_python_package}/vtkAvianLidar.pyi")
  add_custom_command(OUTPUT "${avianlidar_stubs}"
    COMMAND ${avianlidar_python_command} -m vtkmodules.generate_pyi -p avianlidar
      -o "${avianlidar_python_package}" vtkAvianLidar
    # VTK 9.3's generator gives properties in snake case a type without a definition.
    COMMAND sed -i "s/:'getset_descriptor'/: Any/" "${avianlidar_stubs}"
    DEPENDS vtkAvianLidarPython
    COMMENT "Type stubs of avianlidar.vtkAvianLidar"
    VERBATIM)
  add_custom_target(AvianLidarPythonStubs ALL DEPENDS "${avianlidar_stubs}")
  list(APPEND avianlidar_python_generated "${avianlidar_stubs}")
else ()
  message(STATUS "This VTK does not bring vtkmodules.generate_pyi: avianlidar.vtkAvianLidar gets no type stubs")
endif ()

install(FILES ${avianlidar_python_generated}
  DESTINATION "${AVIANLIDAR_PYTHON_DESTINATION}/avianlidar"
  COMPONENT python)

# The command `avianlidar`, for the build tree and for the installation.
file(RELATIVE_PATH AVIANLIDAR_COMMAND_PACKAGE "/${CMAKE_INSTALL_BINDIR}" "/${AVIANLIDAR_PYTHON_DESTINATION}")
configure_file("${PROJECT_SOURCE_DIR}/Python/avianlidar.in" "${CMAKE_BINARY_DIR}/bin/avianlidar" @ONLY
  FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
install(PROGRAMS "${CMAKE_BINARY_DIR}/bin/avianlidar" DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT python)

# Manual page and shell completions of the command, from the command's own parser, if the generators are installed.
execute_process(COMMAND "${Python3_EXECUTABLE}" -c "import build_manpages, shtab" RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
if (result EQUAL 0)
  set(avianlidar_share "${CMAKE_BINARY_DIR}/share")
  set(avianlidar_pages man/man1/avianlidar.1 bash-completion/completions/avianlidar zsh/vendor-completions/_avianlidar)
  list(TRANSFORM avianlidar_pages PREPEND "${avianlidar_share}/" OUTPUT_VARIABLE outputs)
  add_custom_command(OUTPUT ${outputs}
    COMMAND ${avianlidar_python_command} "${PROJECT_SOURCE_DIR}/CMake/command_pages.py" "${avianlidar_share}"
    COMMAND gzip -9nkf "${avianlidar_share}/man/man1/avianlidar.1" # compressed, as Debian requires
    DEPENDS vtkAvianLidarPython "${PROJECT_SOURCE_DIR}/CMake/command_pages.py"
      "${PROJECT_SOURCE_DIR}/Python/avianlidar/_command.py"
      "${PROJECT_SOURCE_DIR}/Python/avianlidar/apps/inputs/coverage.schema.json"
    COMMENT "Manual page and completions of the command"
    VERBATIM)
  add_custom_target(AvianLidarCommandPages ALL DEPENDS ${outputs})
  install(DIRECTORY "${avianlidar_share}/man" "${avianlidar_share}/bash-completion" "${avianlidar_share}/zsh"
    DESTINATION "${CMAKE_INSTALL_DATADIR}" COMPONENT python PATTERN "*.1" EXCLUDE)
else ()
  message(STATUS "There are no python3-argparse-manpage and python3-shtab: the command gets no manual page and no completion")
endif ()

# File with the folder of the package in the build tree, for scripts.
file(WRITE "${CMAKE_BINARY_DIR}/python-path" "${AVIANLIDAR_PYTHON_BUILD_DIR}\n")
