# SPDX-License-Identifier: BSD-3-Clause
# Environment of all tests of the module, of the Python package and of the plugin.

set(AVIANLIDAR_BASELINE_DIR "${PROJECT_SOURCE_DIR}/Testing/Data/Baseline")
set(AVIANLIDAR_TEST_OUTPUT_DIR "${CMAKE_BINARY_DIR}/Testing/Temporary")
file(MAKE_DIRECTORY "${AVIANLIDAR_TEST_OUTPUT_DIR}")

# The baselines are plain files in the repository, but ExternalData needs a store.
include(ExternalData)
set(ExternalData_OBJECT_STORES "${CMAKE_BINARY_DIR}/ExternalData")

# Scenes of the rich sceneries, with their folders.
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
    string(REGEX REPLACE "^zsss_.*" "zsss" template "${scene}") # both sceneries are of the same airport
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
  # Settings of Open MPI: as root, in a container, with more ranks than cores, without ssh.
  "OMPI_ALLOW_RUN_AS_ROOT=1"
  "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"
  "OMPI_MCA_rmaps_base_oversubscribe=1"
  "PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe" # more ranks than cores with Open MPI 5
  "OMPI_MCA_btl_vader_single_copy_mechanism=none"
  "OMPI_MCA_mpi_yield_when_idle=1" # a waiting rank leaves its core to other ranks
  "OMPI_MCA_plm=isolated")

# Not in parallel, because each installation writes its list of files to the same file of the build tree.
set(AVIANLIDAR_INSTALL_LOCK "install-${CMAKE_BINARY_DIR}")

# Exit code of a test that did not run because AVIANLIDAR_DATA_DIR is empty.
set(AVIANLIDAR_SKIP_RETURN_CODE 77)
