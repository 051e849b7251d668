# SPDX-License-Identifier: BSD-3-Clause
# The ParaView plugin AvianLidarPlugin.

set(AVIANLIDAR_PLUGIN_SUBDIR "${PARAVIEW_PLUGIN_SUBDIR}")

# Path of the plugin in the build tree and, relative to the prefix, in the install tree. Tests and scripts pass this path to
# LoadPlugin().
set(AVIANLIDAR_PLUGIN_PATH
  "${CMAKE_INSTALL_LIBDIR}/${AVIANLIDAR_PLUGIN_SUBDIR}/AvianLidarPlugin/AvianLidarPlugin.so")
set(AVIANLIDAR_PLUGIN_FILE "${CMAKE_BINARY_DIR}/${AVIANLIDAR_PLUGIN_PATH}")

paraview_plugin_scan(
  PLUGIN_FILES "${PROJECT_SOURCE_DIR}/Plugin/paraview.plugin"
  PROVIDES_PLUGINS avianlidar_plugins
  ENABLE_BY_DEFAULT ON
  HIDE_PLUGINS_FROM_CACHE ON)
paraview_plugin_build(
  PLUGINS ${avianlidar_plugins}
  PLUGINS_FILE_NAME avianlidar.plugins.xml
  AUTOLOAD ${avianlidar_plugins} # for programs that read this file
  PLUGINS_COMPONENT runtime
  TARGET_COMPONENT runtime
  LIBRARY_SUBDIRECTORY "${AVIANLIDAR_PLUGIN_SUBDIR}"
  INSTALL_HEADERS OFF)
