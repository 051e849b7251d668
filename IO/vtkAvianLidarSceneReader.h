// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSceneReader
 * @brief Reads a scene file (.lidarscene.json): meshes, building footprints and ground, with
 * positions and materials.
 *
 * Documentation/reference/scene-files.md describes keys, formats (those of VTK, Assimp and GDAL),
 * placement and limits. The reader does not have an input.
 *
 * Output port 0 is vtkMultiBlockDataSet: one block per object in the order of the file, or per
 * feature of footprints with `"features": "separate"`. Each block is vtkPolyData of triangles with
 * double points, m. The cell arrays are the arrays of vtkAvianLidarMaterial. `object_id` is the
 * index of the block. Material ids from 4 on are materials of the scene. Field data of a block are
 * its `object_names`, `object_classes` and `material_names`. Field data of the output are the names
 * and classes of all blocks, `attribution`, `scene_report`, and `geodetic_origin` and
 * `lidar_position` if the scene has them.
 *
 * Material names of a mesh are mapped by `material_map`. Names without a rule become Wall. One
 * warning lists these names, objects farther than 100 km from the origin, and a lidar inside or
 * under objects.
 *
 * A bad key, file or number gives an error that names the scene file and the key. The output is
 * empty after an error or an abort. The reader opens only regular files and does not use the
 * network. Piece 0 is the whole scene. Other pieces have the same blocks without cells, and the
 * same field data except an empty `scene_report`.
 *
 * @code
 * reader->SetFileName("airport.lidarscene.json");
 * tree->SetInputConnection(reader->GetOutputPort());
 * @endcode
 *
 * @sa vtkAvianLidarMaterial, vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarSceneReader_h
#define vtkAvianLidarSceneReader_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkMultiBlockDataSetAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarSceneReader : public vtkMultiBlockDataSetAlgorithm
{
public:
  static vtkAvianLidarSceneReader* New();
  vtkTypeMacro(vtkAvianLidarSceneReader, vtkMultiBlockDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Scene file. Call Modified() if the file changes. Default: no file, which gives an error. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /// Scene as JSON text that replaces the contents of FileName, which need not exist. Messages name
  /// FileName. Paths of other files are relative to the folder of FileName. Default: an empty text.
  vtkAvianLidarPropertyMacro(Text, std::string, {});

  /// Returns 1 if the file name ends with .lidarscene.json and the file can be opened, else 0.
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
};

#endif
