# SPDX-License-Identifier: BSD-3-Clause
# avianlidar_define_python_targets(<folder>...): defines the targets that the CMake packages of VTK and ParaView in these
# folders have for their own Python modules. Debian 13's packages name the files of these modules without their suffix
# (.cpython-313-x86_64-linux-gnu), and CMake stops at an imported file that is not there. Targets that exist already it
# does not import. Nothing here links to them.
function (avianlidar_define_python_targets)
  foreach (folder IN LISTS ARGN)
    foreach (package IN ITEMS VTKPython ParaViewPython ParaViewPythonIncubator)
      set(file "${folder}/${package}-targets.cmake")
      if (EXISTS "${file}")
        file(STRINGS "${file}" targets REGEX "^add_library\\(.* IMPORTED\\)$")
        list(TRANSFORM targets REPLACE "^add_library\\(([^ ]+) .*" "\\1")
        foreach (target IN LISTS targets)
          if (NOT TARGET "${target}")
            add_library("${target}" INTERFACE IMPORTED)
          endif ()
        endforeach ()
      endif ()
    endforeach ()
  endforeach ()
endfunction ()
