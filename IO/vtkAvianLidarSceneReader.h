// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSceneReader
 * @brief Reads a scene file (.lidarscene.json): meshes, building footprints and ground, with
 * positions and materials.
 *
 * Keys, formats (by VTK, Assimp and GDAL), placement and limits:
 * Documentation/reference/scene-files.md. The reader has no input.
 *
 * Output port 0 is vtkMultiBlockDataSet: one block per object in the order of the file, or per
 * feature of footprints with `"features": "separate"`. Each block is vtkPolyData of triangles with
 * double points, m, with the cell arrays of vtkAvianLidarMaterial (`object_id` is the index of the
 * block; materials from 4 on are the scene's own) and its own `object_names`, `object_classes` and
 * `material_names`. Field data of the output: the names and classes of all blocks, `attribution`,
 * `scene_report`, and `geodetic_origin` and `lidar_position` where the scene has them.
 *
 * Material names of a mesh are mapped by `material_map`; names without a rule become Wall. One
 * warning lists these names, objects farther than 100 km from the origin, and a lidar inside or
 * under objects.
 *
 * A bad key, file or number gives an error that names the scene file and the key. The output is
 * empty after an error or an abort. Only regular files are opened, and nothing is fetched over the
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
  /** The scene file. After a change on disk call Modified(). Default: none, which is an error. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * The scene as JSON text instead of the contents of FileName, which need not exist. Messages name
   * FileName, and other files are sought in its folder. Default: empty.
   */
  vtkSetMacro(Text, std::string);
  vtkGetMacro(Text, std::string);
  ///@}

  /// 1 if the name of a file ends with .lidarscene.json and it can be opened, else 0.
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
