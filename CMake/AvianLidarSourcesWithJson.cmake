# SPDX-License-Identifier: BSD-3-Clause
# VTK 9.3's headers give the JSON library's namespace another name in whatever follows them: in the folder that includes this
# file these sources, of any target, are compiled by themselves.
set(sources_with_json
  Filters/Private/Beams/vtkAvianLidarSensorFile.cxx
  Filters/Private/Common/JsonNode.cxx
  Filters/Private/Surfaces/vtkAvianLidarMedia.cxx
  Filters/vtkAvianLidarMedium.cxx
  IO/Private/AssimpFileLook.cxx
  IO/Private/CloudNotes.cxx
  IO/Private/Footprints.cxx
  IO/Private/GeoJsonFormat.cxx
  IO/Private/ObjectDescription.cxx
  IO/Private/SceneBuilder.cxx
  IO/Private/SceneDescription.cxx)
list(TRANSFORM sources_with_json PREPEND "${CMAKE_CURRENT_LIST_DIR}/../")
foreach (source IN LISTS sources_with_json)
  get_filename_component(source "${source}" ABSOLUTE)
  set_source_files_properties("${source}" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endforeach ()
