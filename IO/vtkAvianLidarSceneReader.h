// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSceneReader
 * @brief Reads a scene file (.lidarscene.json): meshes, building footprints and ground, placed and
 * with materials.
 *
 * A scene file is JSON; its keys are described in Documentation/scene-format.md: `version`,
 * `origin`, `lidar`, `materials`, `material_map`, `objects`, `attribution`, `comment`. Objects are
 * mesh files (VTK's own formats through VTK, all others through Assimp: OBJ/MTL, glTF, Collada,
 * STL, PLY, IFC, AC3D, ..., also followed by .gz), footprints to extrude (formats of files that
 * GDAL reads: GeoJSON, OSM, GeoPackage, Shapefile, ...) or a level ground. Each is placed in double
 * precision after it was read, in metres east, north and up of the origin, at longitude, latitude
 * and height, or by the coordinates of a reference system.
 *
 * Output port 0: vtkMultiBlockDataSet, one block (a vtkPolyData of triangles with double points)
 * per object, in the order of the file, with block names. Footprints with `"features": "separate"`
 * give a block per feature.
 *
 * Cell arrays: `object_id` (int, the index of the block), `material_id` (int; 0 to 3: Wall, Glass,
 * Metal, Wood with the coefficients of the paper, Table 1; from 4 on the scene's own), and the
 * coefficients of vtkAvianLidarMaterial (double).
 *
 * Field data of the output: `object_names`, `object_classes` (strings, by object_id),
 * `material_names` (strings, by material_id), `geodetic_origin` (3 doubles: latitude deg, longitude
 * deg, height above the ellipsoid m) and `lidar_position` (3 doubles, m) where the scene has them,
 * `attribution` (strings: whom to credit), `scene_report` (strings: triangles, degenerate triangles
 * and extents of every object, what was repaired or left out, what is above and below the lidar).
 * Every block carries its own `object_names` and `object_classes` (one value) and `material_names`,
 * so that it can be taken out of the scene.
 *
 * Colours of a mesh are never coefficients: its material names are mapped by `material_map`, names
 * without a rule are Wall. That, objects farther than 100 km from the origin, and a lidar inside an
 * object or under all of them are said in one warning. An unknown key, a missing file, a number out
 * of its range or a file that cannot be read is an error that names the scene file and the key; the
 * output is then empty. After an abort it is empty, too. Only regular files are opened, of any
 * folder, and links to them; pipes and devices are errors, and nothing is fetched over the network.
 *
 * Pieces: the whole scene is in piece 0, which alone reads the meshes; other pieces have the same
 * blocks, empty, and the same field data but for `scene_report`, which is empty. For them the scene
 * file is read, and footprints with `"features": "separate"`, whose blocks follow from their
 * features. The output depends on nothing but the files.
 *
 * @sa vtkAvianLidarMaterial vtkAvianLidarCollisionTree vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarSceneReader_h
#define vtkAvianLidarSceneReader_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkMultiBlockDataSetAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarSceneReader : public vtkMultiBlockDataSetAlgorithm
{
public:
  static vtkAvianLidarSceneReader* New();
  vtkTypeMacro(vtkAvianLidarSceneReader, vtkMultiBlockDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The scene file. Default: none, which is an error. Files that it names are sought from its own
   * folder. A change of the file on disk is not noticed: call Modified().
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * The scene as text, JSON as in a scene file. If it is not empty it stands for the contents of
   * the file: FileName then need not exist; its folder is where other files are sought, and
   * messages name it. Default: empty.
   */
  vtkSetMacro(Text, std::string);
  vtkGetMacro(Text, std::string);
  ///@}

  /**
   * Whether a file is a scene by its name (ending .lidarscene.json, case aside) and can be opened.
   * Its contents are judged on reading, where a fault gets a message. 1 or 0.
   */
  static int CanReadFile(VTK_FILEPATH const char* fileName);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarSceneReader();
  ~vtkAvianLidarSceneReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarSceneReader(const vtkAvianLidarSceneReader&) = delete;
  void operator=(const vtkAvianLidarSceneReader&) = delete;

  char* FileName = nullptr;
  std::string Text;
};

#endif
