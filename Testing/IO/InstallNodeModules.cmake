# SPDX-License-Identifier: BSD-3-Clause
# Puts the node modules that package-lock.json names into a folder of the build tree, once for each state of that file.
# cmake -D NPM=... -D FROM=<this folder> -D TO=<folder> -P InstallNodeModules.cmake

file(SHA256 "${FROM}/package-lock.json" wanted)
set(stamp "${TO}/installed")
set(installed "")
if (EXISTS "${stamp}")
  file(READ "${stamp}" installed)
endif ()
if (installed STREQUAL wanted)
  return ()
endif ()

file(MAKE_DIRECTORY "${TO}")
file(COPY "${FROM}/package.json" "${FROM}/package-lock.json" DESTINATION "${TO}")
execute_process(
  COMMAND "${NPM}" ci --no-audit --no-fund --ignore-scripts
  WORKING_DIRECTORY "${TO}"
  RESULT_VARIABLE result)
if (NOT result EQUAL 0)
  message(FATAL_ERROR "npm ci failed (${result}): the test of the LAS writer needs the package copc, so the network")
endif ()
file(WRITE "${stamp}" "${wanted}")
