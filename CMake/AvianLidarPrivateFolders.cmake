# SPDX-License-Identifier: BSD-3-Clause
# Folders of Filters/Private, and folders of IO that the classes there share. Files have unique names and are included by
# name. A folder uses only folders before it in its list. IO may use all folders of Filters/Private, which do not use IO
# (Testing/Python/TestSources.py tests this order).
set(private_folders
  Files
  Arrays
  Errors
  Ranks
  Surfaces
  Beams
  Movers
  Echoes
  Tracks
  Coverage)
set(io_folders
  Files
  Clouds
  Scenes)
get_filename_component(private_dir "${CMAKE_CURRENT_LIST_DIR}/../Filters/Private" ABSOLUTE)
list(TRANSFORM private_folders PREPEND "${private_dir}/" OUTPUT_VARIABLE private_include_dirs)
get_filename_component(io_dir "${CMAKE_CURRENT_LIST_DIR}/../IO" ABSOLUTE)
foreach (io_folder IN LISTS io_folders)
  list(APPEND private_include_dirs "${io_dir}/${io_folder}")
endforeach ()
