# SPDX-License-Identifier: BSD-3-Clause
# The module's own lines. Add a public class to `classes`; what shells share goes to Filters/Private.

set(classes
  Filters/vtkAvianLidarBeamSource
  Filters/vtkAvianLidarBirdSource
  Filters/vtkAvianLidarCloudComparison
  Filters/vtkAvianLidarCollisionTree
  Filters/vtkAvianLidarCoverage
  Filters/vtkAvianLidarEchoFilter
  Filters/vtkAvianLidarGeodeticTransform
  Filters/vtkAvianLidarHSBColorMap
  Filters/vtkAvianLidarMaterial
  Filters/vtkAvianLidarRangeImage
  Filters/vtkAvianLidarScanFilter
  Filters/vtkAvianLidarSensorReader
  Filters/vtkAvianLidarTracks
  IO/vtkAvianLidarCloudWriter
  IO/vtkAvianLidarGeoJSONWriter
  IO/vtkAvianLidarKITTIWriter
  IO/vtkAvianLidarLASWriter
  IO/vtkAvianLidarPCDWriter
  IO/vtkAvianLidarPLYWriter
  IO/vtkAvianLidarPointCloudReader
  IO/vtkAvianLidarSceneReader
  IO/vtkAvianLidarUnitNames)

set(private_sources
  Filters/Private/vtkAvianLidarBeamSourceFile.cxx
  Filters/Private/vtkAvianLidarBeams.cxx
  Filters/Private/vtkAvianLidarBirdTargets.cxx
  Filters/Private/vtkAvianLidarBirds.cxx
  Filters/Private/vtkAvianLidarContent.cxx
  Filters/Private/vtkAvianLidarCoverageOutput.cxx
  Filters/Private/vtkAvianLidarEchoOutput.cxx
  Filters/Private/vtkAvianLidarGather.cxx
  Filters/Private/vtkAvianLidarGuard.cxx
  Filters/Private/vtkAvianLidarIdRuns.cxx
  Filters/Private/vtkAvianLidarImageArrays.cxx
  Filters/Private/vtkAvianLidarImageBeams.cxx
  Filters/Private/vtkAvianLidarModelNotes.cxx
  Filters/Private/vtkAvianLidarMovers.cxx
  Filters/Private/vtkAvianLidarPlaces.cxx
  Filters/Private/vtkAvianLidarRanks.cxx
  Filters/Private/vtkAvianLidarRevolutions.cxx
  Filters/Private/vtkAvianLidarScanArrays.cxx
  Filters/Private/vtkAvianLidarScanShape.cxx
  Filters/Private/vtkAvianLidarSensorFile.cxx
  Filters/Private/vtkAvianLidarSurfaceExchange.cxx
  Filters/Private/vtkAvianLidarSurfaceIds.cxx
  Filters/Private/vtkAvianLidarSurfaceLeaf.cxx
  Filters/Private/vtkAvianLidarSurfaceState.cxx
  Filters/Private/vtkAvianLidarSurfaces.cxx
  Filters/Private/vtkAvianLidarSurfacesMerge.cxx
  Filters/Private/vtkAvianLidarSurfacesToPolyData.cxx
  Filters/Private/vtkAvianLidarTreeAccess.cxx
  Filters/Private/vtkAvianLidarTreeDisplay.cxx
  Filters/Private/vtkAvianLidarTriangles.cxx
  IO/Private/AssimpFileLook.cxx
  IO/Private/AssimpFiles.cxx
  IO/Private/ByteSource.cxx
  IO/Private/CloudData.cxx
  IO/Private/CloudNotes.cxx
  IO/Private/CoordinateSystem.cxx
  IO/Private/Extrusion.cxx
  IO/Private/FieldTable.cxx
  IO/Private/Footprints.cxx
  IO/Private/GeoJsonFormat.cxx
  IO/Private/KittiFormat.cxx
  IO/Private/LasReading.cxx
  IO/Private/LasWriting.cxx
  IO/Private/LazFormat.cxx
  IO/Private/MeshImport.cxx
  IO/Private/NodeGraph.cxx
  IO/Private/ObjectDescription.cxx
  IO/Private/OrganisedCells.cxx
  IO/Private/OutputFile.cxx
  IO/Private/PcdHeader.cxx
  IO/Private/PcdReading.cxx
  IO/Private/PcdWriting.cxx
  IO/Private/PlyReading.cxx
  IO/Private/PlyWriting.cxx
  IO/Private/Polygons.cxx
  IO/Private/ReadCloud.cxx
  IO/Private/Scalars.cxx
  IO/Private/SceneBuilder.cxx
  IO/Private/SceneDescription.cxx
  IO/Private/SceneFrame.cxx
  IO/Private/SceneJson.cxx
  IO/Private/SceneReport.cxx
  IO/Private/SemanticLabels.cxx
  IO/Private/SensorPose.cxx
  IO/Private/TextLines.cxx
  IO/Private/VirtualFiles.cxx
  IO/Private/VtkCellCheck.cxx
  IO/Private/VtkFileLook.cxx
  IO/Private/VtkMeshImport.cxx
  IO/Private/XmlTags.cxx
  IO/Private/vtkAvianLidarCloudFields.cxx)

vtk_module_add_module(AvianLidar::AvianLidar
  CLASSES ${classes}
  NOWRAP_HEADERS Filters/vtkAvianLidarDeprecatedSettings.h Filters/vtkAvianLidarErrorsAsData.h
  SOURCES ${private_sources})

include("${CMAKE_CURRENT_LIST_DIR}/AvianLidarSourcesWithJson.cmake")

# Data files that are built in, as text.
set(built_in_texts "")
foreach(built_in IN ITEMS
  Birds/species.csv
  Sensors/Airport16.lidarsensor.json
  Sensors/Airport32.lidarsensor.json
  Sensors/Automotive16.lidarsensor.json
  Sensors/CorridorC16.lidarsensor.json
  Sensors/HDL32E.lidarsensor.json
  Sensors/Helios16P.lidarsensor.json
  Sensors/OS1_64.lidarsensor.json
  Sensors/Pandar40P.lidarsensor.json
  Sensors/PandarXT32.lidarsensor.json
  Sensors/Search1550.lidarsensor.json
  Sensors/Search905.lidarsensor.json
  Sensors/VLP16.lidarsensor.json
  Sensors/VLP32C.lidarsensor.json)
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
    "${CMAKE_CURRENT_SOURCE_DIR}/Filters/Private"
    "$<TARGET_PROPERTY:avianlidarKernel,INTERFACE_INCLUDE_DIRECTORIES>")

# None of these shows in an installed header.
vtk_module_link(AvianLidar::AvianLidar
  PRIVATE
    avianlidarKernel
    AvianLidar::xxhash
    assimp::assimp
    AvianLidar::geos
    AvianLidar::utf8
    GDAL::GDAL
    AvianLidar::laszip
    liblzf::liblzf
    nlohmann_json::nlohmann_json)
vtk_module_definitions(AvianLidar::AvianLidar
  PRIVATE "AVIANLIDAR_VERSION=\"${PROJECT_VERSION}\"")
