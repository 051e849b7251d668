# SPDX-License-Identifier: BSD-3-Clause
# Debian packages: `cpack` in the build tree makes a package from each install component (Documentation/start/install.md).
# A package is for the Debian release and the ParaView of its build.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME avian-lidar)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # empty, because CPack would put it before the summaries of the packages
# Debian's changelog and CITATION.cff repeat the version of project(). The changelog also has the revision and the maintainer.
set(avianlidar_debian "${CMAKE_CURRENT_LIST_DIR}/debian")
file(READ "${avianlidar_debian}/changelog" changelog)
string(REGEX MATCH "^avian-lidar \\(([0-9.]+)-([0-9]+)\\)" ignored "${changelog}")
set(CPACK_DEBIAN_PACKAGE_VERSION "${CMAKE_MATCH_1}")
set(CPACK_DEBIAN_PACKAGE_RELEASE "${CMAKE_MATCH_2}")
if (NOT CPACK_DEBIAN_PACKAGE_VERSION STREQUAL PROJECT_VERSION)
  message(FATAL_ERROR "${avianlidar_debian}/changelog begins with version ${CPACK_DEBIAN_PACKAGE_VERSION}, not with ${PROJECT_VERSION}")
endif ()
file(READ "${PROJECT_SOURCE_DIR}/CITATION.cff" citation)
if (NOT citation MATCHES "\nversion: ${PROJECT_VERSION}\n")
  message(FATAL_ERROR "${PROJECT_SOURCE_DIR}/CITATION.cff has another version than ${PROJECT_VERSION}")
endif ()
string(REGEX MATCH "\n -- ([^\n]*)  " ignored "${changelog}")
set(CPACK_PACKAGE_CONTACT "${CMAKE_MATCH_1}")
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
# Permissions of folders, independent of the umask.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_COMPONENTS_ALL runtime python development doc)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SOURCE avian-lidar)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON) # this setting needs dpkg-dev and file
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}")
set(avianlidar_same_version
  "avian-lidar (= ${CPACK_DEBIAN_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(avianlidar_description "Simulates what a lidar that watches birds over an airport receives from
terminals, hangars, masts, the ground and the birds.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME avian-lidar)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS python3-avianlidar)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA
  "${avianlidar_debian}/prerm"
  "${avianlidar_debian}/triggers"
  "${CMAKE_BINARY_DIR}/packages.in/shlibs")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "library and ParaView plugin of the avian-lidar simulator
${avianlidar_description}
.
This package has the library of VTK classes and the plugin, which ParaView
loads when it starts.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-avianlidar)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
math(EXPR python_next_minor "${Python3_VERSION_MINOR} + 1")
string(JOIN ", " CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "${avianlidar_same_version}"
  "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR})"
  "python3 (<< ${Python3_VERSION_MAJOR}.${python_next_minor})"
  python3-numpy
  python3-paraview
  python3-tqdm)
# Imports of some helpers, for pictures, maps, reports, plans and scenarios, fits, tables, bags.
string(JOIN ", " CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS
  python3-matplotlib python3-gdal python3-jinja2 python3-jsonschema python3-scipy python3-pandas python3-lz4 python3-zstandard
  libjs-three)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${avianlidar_debian}/postinst"
  "${avianlidar_debian}/prerm")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python package and command of the avian-lidar simulator
${avianlidar_description}
.
This package has the Python package avianlidar and the command avianlidar.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libavian-lidar-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "${avianlidar_same_version}"
  paraview-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "headers and CMake package of the avian-lidar simulator
${avianlidar_description}
.
This package has what find_package(AvianLidar) finds for programs in C++.")

set(CPACK_DEBIAN_DOC_PACKAGE_NAME avian-lidar-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOC_PACKAGE_SUGGESTS python3-avianlidar)
set(CPACK_COMPONENT_DOC_DESCRIPTION "documentation and examples of the avian-lidar simulator
${avianlidar_description}
.
This package has the pages, and the scenes, plans and scripts to copy from.")
install(FILES README.md CONTRIBUTING.md DESTINATION share/doc/avian-lidar-doc COMPONENT doc EXCLUDE_FROM_ALL)
install(DIRECTORY Documentation Examples DESTINATION share/doc/avian-lidar-doc COMPONENT doc EXCLUDE_FROM_ALL
  PATTERN site EXCLUDE PATTERN make_site.sh EXCLUDE PATTERN page_tables.py EXCLUDE PATTERN __pycache__ EXCLUDE)

# Files by which paraview, pvpython, pvbatch and pvserver find and load the plugin. At start, these programs read one file
# paraview.conf, which names lists of plugins. Debian 13's paraview.conf names the list /usr/share/paraview/plugins for other
# packages, and this project installs that list. Debian 12 does not have a paraview.conf. There this project installs a
# paraview.conf beside the programs, which names the list of ParaView's own plugins and this project's list.
set(folder "${CMAKE_BINARY_DIR}/packages.in")
set(plugins "${AVIANLIDAR_PLUGIN_SUBDIR}")
if (EXISTS "${ParaView_DIR}/../../${plugins}/../paraview.conf")
  file(WRITE "${folder}/plugins"
    "<?xml version=\"1.0\"?>\n<Plugins>\n"
    "  <Plugin name=\"AvianLidarPlugin\" auto_load=\"1\""
    " filename=\"${CPACK_PACKAGING_INSTALL_PREFIX}/${AVIANLIDAR_PLUGIN_PATH}\"/>\n"
    "</Plugins>\n")
  install(FILES "${folder}/plugins" DESTINATION "${CMAKE_INSTALL_DATADIR}/paraview" COMPONENT runtime EXCLUDE_FROM_ALL)
else ()
  file(WRITE "${folder}/paraview.conf"
    "../lib/${CMAKE_LIBRARY_ARCHITECTURE}/${plugins}/paraview.plugins.xml\n"
    "../${CMAKE_INSTALL_LIBDIR}/${plugins}/avianlidar.plugins.xml\n")
  install(FILES "${folder}/paraview.conf" DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime EXCLUDE_FROM_ALL)
endif ()

# Not CPack's shlibs, because CPack would add the file to every package and warn of each module without a version.
file(WRITE "${folder}/shlibs"
  "libvtkAvianLidar ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} ${avianlidar_same_version}\n")

# Files that Debian requires in every package.
file(COPY_FILE "${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${folder}/changelog")
file(COPY_FILE "${avianlidar_debian}/changelog" "${folder}/changelog.Debian")
execute_process(COMMAND gzip -9nf "${folder}/changelog" "${folder}/changelog.Debian" COMMAND_ERROR_IS_FATAL ANY)
foreach (component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER "${component}" upper)
  install(FILES "${avianlidar_debian}/copyright" "${folder}/changelog.gz" "${folder}/changelog.Debian.gz"
    DESTINATION "share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}"
    COMPONENT "${component}"
    EXCLUDE_FROM_ALL)
endforeach ()

include(CPack)
