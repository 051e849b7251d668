# SPDX-License-Identifier: BSD-3-Clause
# Puts the node modules that package-lock.json names into a folder of the build tree, once for each state of that file.
# cmake -D NPM=... -D FROM=<this folder> -D TO=<folder> -P InstallNodeModules.cmake
# Where npm reaches no registry it prints "Skipped:" and how to get them, and fails; CTest calls that skipped.

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
    --fetch-timeout=30000 --fetch-retries=1 --fetch-retry-mintimeout=1000
  WORKING_DIRECTORY "${TO}"
  RESULT_VARIABLE result
  ERROR_VARIABLE errors
  ECHO_ERROR_VARIABLE)
if (NOT result EQUAL 0)
  # npm's words for a network that is not there, or that answers for the registry with a certificate of its own; anything
  # else is a failure.
  if (errors MATCHES "ENOTFOUND|EAI_AGAIN|ECONNREFUSED|ECONNRESET|ENETUNREACH|EHOSTUNREACH|ETIMEDOUT|SOCKET_TIMEOUT|ENOTCACHED|network timeout|SELF_SIGNED_CERT[A-Z_]*|UNABLE_TO_[A-Z_]*(ISSUER_CERT|LEAF_SIGNATURE)[A-Z_]*")
    message(FATAL_ERROR "Skipped: npm reaches no registry (${CMAKE_MATCH_0}), and tests of LAS and MCAP files need its "
      "packages. To get them, run this test once with a network; the packages stay in ${TO}.")
  endif ()
  message(FATAL_ERROR "npm ci failed (${result})")
endif ()
file(WRITE "${stamp}" "${wanted}")
