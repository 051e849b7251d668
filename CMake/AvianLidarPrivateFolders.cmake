# SPDX-License-Identifier: BSD-3-Clause
# Folders of Filters/Private, whose files are named uniquely and included by name. A folder uses those before it in this list,
# never those after it, and nothing of IO, which may use all of them (Testing/Python/TestSources.py holds them to that).
set(private_folders
  Common
  Surfaces
  Beams
  Movers
  Echoes
  Coverage)
get_filename_component(private_dir "${CMAKE_CURRENT_LIST_DIR}/../Filters/Private" ABSOLUTE)
list(TRANSFORM private_folders PREPEND "${private_dir}/" OUTPUT_VARIABLE private_include_dirs)
