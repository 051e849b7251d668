# SPDX-License-Identifier: BSD-3-Clause
# Built-in data files of Filters/. The beam source has a preset for each built-in sensor, and the plugin makes a source
# from each.

set(beam_source "${CMAKE_CURRENT_LIST_DIR}/../Filters/vtkAvianLidarBeamSource.h")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${beam_source}")
file(STRINGS "${beam_source}" built_in_files REGEX "vtkAvianLidarPresetMacro\\(")
list(TRANSFORM built_in_files REPLACE ".*\\((.+)\\).*" "Sensors/\\1.lidarsensor.json")
list(SORT built_in_files)
list(PREPEND built_in_files Birds/species.csv Media/media.json)
