# SPDX-License-Identifier: BSD-3-Clause
# The module's own lines. Add a public class to `classes`; what shells share goes to a folder of Filters/Private.

set(classes
  Filters/vtkAvianLidarBeamSource
  Filters/vtkAvianLidarBeamView
  Filters/vtkAvianLidarBirdSource
  Filters/vtkAvianLidarCloudComparison
  Filters/vtkAvianLidarClutterFilter
  Filters/vtkAvianLidarCollisionTree
  Filters/vtkAvianLidarCoverage
  Filters/vtkAvianLidarEchoFilter
  Filters/vtkAvianLidarGeodeticTransform
  Filters/vtkAvianLidarHSBColorMap
  Filters/vtkAvianLidarMaterial
  Filters/vtkAvianLidarMedium
  Filters/vtkAvianLidarRangeImage
  Filters/vtkAvianLidarScanFilter
  Filters/vtkAvianLidarSensorReader
  Filters/vtkAvianLidarTracker
  Filters/vtkAvianLidarTracks
  IO/vtkAvianLidarCloudWriter
  IO/vtkAvianLidarGeoJSONWriter
  IO/vtkAvianLidarKITTIWriter
  IO/vtkAvianLidarLASWriter
  IO/vtkAvianLidarPCDWriter
  IO/vtkAvianLidarPLYWriter
  IO/vtkAvianLidarPointCloudReader
  IO/vtkAvianLidarSceneReader
  IO/vtkAvianLidarSequenceReader
  IO/vtkAvianLidarUnitNames)

include("${CMAKE_CURRENT_LIST_DIR}/AvianLidarPrivateFolders.cmake")
set(private_sources
  Filters/Private/Common/JsonNode.cxx
  Filters/Private/Common/vtkAvianLidarArrays.cxx
  Filters/Private/Common/vtkAvianLidarContent.cxx
  Filters/Private/Common/vtkAvianLidarGather.cxx
  Filters/Private/Common/vtkAvianLidarGuard.cxx
  Filters/Private/Common/vtkAvianLidarIdRuns.cxx
  Filters/Private/Common/vtkAvianLidarRanks.cxx
  Filters/Private/Common/vtkAvianLidarScanStream.cxx
  Filters/Private/Surfaces/vtkAvianLidarMedia.cxx
  Filters/Private/Surfaces/vtkAvianLidarSurfaceExchange.cxx
  Filters/Private/Surfaces/vtkAvianLidarSurfaceIds.cxx
  Filters/Private/Surfaces/vtkAvianLidarSurfaceLeaf.cxx
  Filters/Private/Surfaces/vtkAvianLidarSurfaceState.cxx
  Filters/Private/Surfaces/vtkAvianLidarSurfaces.cxx
  Filters/Private/Surfaces/vtkAvianLidarSurfacesMerge.cxx
  Filters/Private/Surfaces/vtkAvianLidarSurfacesToPolyData.cxx
  Filters/Private/Surfaces/vtkAvianLidarScene.cxx
  Filters/Private/Surfaces/vtkAvianLidarTreeDisplay.cxx
  Filters/Private/Surfaces/vtkAvianLidarTriangles.cxx
  Filters/Private/Beams/vtkAvianLidarBeamSourceFile.cxx
  Filters/Private/Beams/vtkAvianLidarBeams.cxx
  Filters/Private/Beams/vtkAvianLidarRevolutions.cxx
  Filters/Private/Beams/vtkAvianLidarScanArrays.cxx
  Filters/Private/Beams/vtkAvianLidarScanShape.cxx
  Filters/Private/Beams/vtkAvianLidarSensorFile.cxx
  Filters/Private/Movers/vtkAvianLidarBirdTargets.cxx
  Filters/Private/Movers/vtkAvianLidarBirds.cxx
  Filters/Private/Movers/vtkAvianLidarMovers.cxx
  Filters/Private/Echoes/vtkAvianLidarEchoOutput.cxx
  Filters/Private/Echoes/vtkAvianLidarImageArrays.cxx
  Filters/Private/Echoes/vtkAvianLidarImageBeams.cxx
  Filters/Private/Echoes/vtkAvianLidarModelNotes.cxx
  Filters/Private/Coverage/vtkAvianLidarCoverageOutput.cxx
  Filters/Private/Coverage/vtkAvianLidarPlaces.cxx
  IO/Private/ByteSource.cxx
  IO/Private/CloudNotes.cxx
  IO/Private/CoordinateSystem.cxx
  IO/Private/Extrusion.cxx
  IO/Private/FieldTable.cxx
  IO/Private/Footprints.cxx
  IO/Private/KittiFormat.cxx
  IO/Private/LasReading.cxx
  IO/Private/LasWriting.cxx
  IO/Private/LazFormat.cxx
  IO/Private/MeshImport.cxx
  IO/Private/MeshStream.cxx
  IO/Private/OutputFile.cxx
  IO/Private/PacketReading.cxx
  IO/Private/PcdFormat.cxx
  IO/Private/PlyFormat.cxx
  IO/Private/Polygons.cxx
  IO/Private/ReadCloud.cxx
  IO/Private/Scalars.cxx
  IO/Private/SceneBuilder.cxx
  IO/Private/SceneDescription.cxx
  IO/Private/SceneFrame.cxx
  IO/Private/SceneReport.cxx
  IO/Private/SemanticLabels.cxx
  IO/Private/SensorPose.cxx
  IO/Private/Terrain.cxx
  IO/Private/TextLines.cxx
  IO/Private/VirtualFiles.cxx
  IO/Private/vtkAvianLidarCloudFields.cxx)

vtk_module_add_module(AvianLidar::AvianLidar
  CLASSES ${classes}
  NOWRAP_HEADERS Filters/vtkAvianLidarErrorsAsData.h
    Filters/vtkAvianLidarSensorPresets.h
    Filters/vtkAvianLidarFilePath.h
  SOURCES ${private_sources})

# Data files that are built in, as text.
set(built_in_texts "")
include("${CMAKE_CURRENT_LIST_DIR}/AvianLidarBuiltIn.cmake")
foreach(built_in IN LISTS built_in_files)
  set(built_in_file "${CMAKE_CURRENT_SOURCE_DIR}/Filters/${built_in}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${built_in_file}")
  file(READ "${built_in_file}" built_in_text)
  get_filename_component(built_in_name "${built_in}" NAME)
  string(APPEND built_in_texts "  { \"${built_in_name}\", R\"TEXT(${built_in_text})TEXT\" },\n")
endforeach()
configure_file(CMake/BuiltInTexts.cxx.in "${CMAKE_CURRENT_BINARY_DIR}/BuiltInTexts.cxx" @ONLY)
target_sources(AvianLidar PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/BuiltInTexts.cxx")

# Classes live in folders: users and wrappers still include them by name.
vtk_module_include(AvianLidar::AvianLidar
  PUBLIC
    "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/Filters>"
    "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/IO>"
  PRIVATE
    ${private_include_dirs}
    "$<TARGET_PROPERTY:avianlidarKernel,INTERFACE_INCLUDE_DIRECTORIES>"
    "$<TARGET_PROPERTY:avianlidarVolumeTree,INTERFACE_INCLUDE_DIRECTORIES>")

# None of these shows in an installed header.
vtk_module_link(AvianLidar::AvianLidar
  PRIVATE
    avianlidarVolumeTree
    avianlidarKernel
    AvianLidar::boost
    AvianLidar::xxhash
    AvianLidar::geos
    AvianLidar::utf8
    GDAL::GDAL
    AvianLidar::laszip
    liblzf::liblzf
    nlohmann_json::nlohmann_json)
vtk_module_definitions(AvianLidar::AvianLidar
  PRIVATE "AVIANLIDAR_VERSION=\"${PROJECT_VERSION}\"")
target_compile_options(AvianLidar PRIVATE -Wall -Wextra -Wshadow)
