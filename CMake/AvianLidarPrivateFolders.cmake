# SPDX-License-Identifier: BSD-3-Clause
# Folders of Filters/Private. Files have unique names and are included by name. A folder uses only folders before it in this
# list. IO may use all these folders, but the folders do not use IO (Testing/Python/TestSources.py tests this order).
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
get_filename_component(private_dir "${CMAKE_CURRENT_LIST_DIR}/../Filters/Private" ABSOLUTE)
list(TRANSFORM private_folders PREPEND "${private_dir}/" OUTPUT_VARIABLE private_include_dirs)
