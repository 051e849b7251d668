# SPDX-License-Identifier: BSD-3-Clause
# What every test of the module, of the Python package and of the plugin finds in its environment.

set(AVIANLIDAR_BASELINE_DIR "${PROJECT_SOURCE_DIR}/Testing/Data/Baseline")
set(AVIANLIDAR_TEST_OUTPUT_DIR "${CMAKE_BINARY_DIR}/Testing/Temporary")
file(MAKE_DIRECTORY "${AVIANLIDAR_TEST_OUTPUT_DIR}")

# Baselines are plain files in the repository; ExternalData wants a store all the same.
include(ExternalData)
set(ExternalData_OBJECT_STORES "${CMAKE_BINARY_DIR}/ExternalData")

# Scenes of the rich sceneries, with the folder that they are in.
set(AVIANLIDAR_SCENES_DIR "${CMAKE_BINARY_DIR}/Testing/Scenes")
if (BUILD_TESTING OR AVIANLIDAR_BUILD_BENCHMARKS)
  foreach (scene IN ITEMS
      avz_office
      ingolstadt
      neubrandenburg
      neubrandenburg_osm
      phnl
      shanghai_cbd
      zsss_all
      zsss_structures)
    string(REGEX REPLACE "^zsss_" "" AVIANLIDAR_SCENERY "${scene}")
    string(REGEX REPLACE "^zsss_.*" "zsss" template "${scene}") # two sceneries of one airport
    configure_file(
      "${PROJECT_SOURCE_DIR}/Testing/Data/Scenes/${template}.lidarscene.json.in"
      "${AVIANLIDAR_SCENES_DIR}/${scene}.lidarscene.json"
      @ONLY)
  endforeach ()
endif ()

set(AVIANLIDAR_TEST_ENVIRONMENT
  "AVIANLIDAR_SOURCE_DIR=${PROJECT_SOURCE_DIR}"
  "AVIANLIDAR_BUILD_DIR=${CMAKE_BINARY_DIR}"
  "AVIANLIDAR_TEST_OUTPUT_DIR=${AVIANLIDAR_TEST_OUTPUT_DIR}"
  "AVIANLIDAR_BASELINE_DIR=${AVIANLIDAR_BASELINE_DIR}"
  "AVIANLIDAR_DATA_DIR=${AVIANLIDAR_DATA_DIR}"
  "AVIANLIDAR_SCENES_DIR=${AVIANLIDAR_SCENES_DIR}"
  "AVIANLIDAR_LASZIP=$<BOOL:${AVIANLIDAR_LASZIP_LIBRARY}>"
  # Open MPI as root, in a container, with more ranks than cores, without ssh.
  "OMPI_ALLOW_RUN_AS_ROOT=1"
  "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"
  "OMPI_MCA_rmaps_base_oversubscribe=1"
  "PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe" # the same for Open MPI 5
  "OMPI_MCA_btl_vader_single_copy_mechanism=none"
  "OMPI_MCA_mpi_yield_when_idle=1" # a rank that waits leaves its core to others
  "OMPI_MCA_plm=isolated")

# One at a time: each installation writes its list of files to the same place in the build tree.
set(AVIANLIDAR_INSTALL_LOCK "install-${CMAKE_BINARY_DIR}")

# The exit code of a test that did not run because AVIANLIDAR_DATA_DIR is empty.
set(AVIANLIDAR_SKIP_RETURN_CODE 77)
