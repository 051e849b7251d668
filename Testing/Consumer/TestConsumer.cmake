# SPDX-License-Identifier: BSD-3-Clause

function (run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if (NOT result EQUAL 0)
    message(FATAL_ERROR "Failed (${result}): ${ARGN}")
  endif ()
endfunction ()

file(REMOVE_RECURSE "${WORK_DIR}")
set(prefix "${BUILD_DIR}")
if (TREE STREQUAL "Install")
  set(prefix "${WORK_DIR}/prefix")
  run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${prefix}")
endif ()

if (TREE STREQUAL "Host")
  run("${CMAKE_COMMAND}" -G Ninja -S "${SOURCE_DIR}" -B "${WORK_DIR}/build"
    "-DAVIANLIDAR_SOURCE_DIR=${AVIANLIDAR_SOURCE_DIR}" "-DVTK_DIR=${VTK_DIR}")
else ()
  # Only this tree is given: the package finds its VTK itself.
  run("${CMAKE_COMMAND}" -G Ninja -S "${SOURCE_DIR}" -B "${WORK_DIR}/build"
    "-DCMAKE_PREFIX_PATH=${prefix}")
  file(STRINGS "${WORK_DIR}/build/CMakeCache.txt" found REGEX "^AvianLidar_DIR:")
  if (NOT found MATCHES "=${prefix}(/|$)")
    message(FATAL_ERROR "Another package was found: ${found}, expected one in ${prefix}")
  endif ()
endif ()
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
set(echoes "${WORK_DIR}/echoes.vtp")
run("${WORK_DIR}/build/scan_airport" "${SCENE}" "${echoes}" 10000)

if (PYTHON_DESTINATION)
  set(ENV{PYTHONPATH} "${prefix}/${PYTHON_DESTINATION}:${VTK_PYTHONPATH}")
  run("${PYTHON}" -c
    "import avianlidar.vtkAvianLidar as m\nassert m.__file__.startswith('${prefix}'), m.__file__")
  run("${PYTHON}" "${COMPARE}" "${SCENE}" "${echoes}" 10000)
endif ()

if (PLUGIN AND NOT TREE STREQUAL "Host")
  unset(ENV{PYTHONPATH})
  run("${PVPYTHON}" -c
    "from paraview.simple import LoadPlugin\nLoadPlugin('${prefix}/${PLUGIN}', remote=False)")
endif ()
