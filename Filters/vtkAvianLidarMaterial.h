// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarMaterial
 * @brief Gives surfaces a material: how they reflect the light of the lidar.
 *
 * **Input** (port 0): vtkPolyData, or a composite (vtkMultiBlockDataSet, vtkPartitionedDataSet,
 * vtkPartitionedDataSetCollection) whose leaves are vtkPolyData. **Output**: the same, shallow
 * copies with these cell arrays, one component each, always all six, so that appending such
 * surfaces never loses one:
 *
 * - `object_id` (int): see ObjectId
 * - `material_id` (int): index into `material_names`; 0 to 3 are Wall, Glass, Metal, Wood
 * - `kd` (double, unit 1): diffuse coefficient (paper, Eq. 6)
 * - `ks` (double, unit 1): specular coefficient (paper, Eq. 7)
 * - `kp` (double, unit 1): glossiness, the exponent of the specular lobe (paper, Eq. 7)
 * - `roughness` (double, rad): standard deviation of the slope of its facets (Oren and Nayar 1994)
 *
 * Field data of each leaf: `material_names`, the materials that are there already or the four
 * standard ones, with another one put behind them when it is used; and `object_names`, one value:
 * NameOfObject, else the name that the leaf already has, else the name of its block; a leaf without
 * any name stays without, and is given one when the surfaces are merged. `object_classes` are kept;
 * several become one where the leaf becomes one object, an empty one if they differ. A composite
 * carries `material_names` too.
 *
 * In a composite, only blocks that fit BlockNamePattern get the material; the others are passed on
 * as they are, so that one filter after the other can name the materials of a scene.
 *
 * **Bad input**: coefficients that are negative, not finite, kd + ks > 1, kp > 1e6 or roughness >
 * pi/2, an unknown material, an ObjectId below -1, a chosen leaf that is not vtkPolyData: an error,
 * empty output. A pattern that fits no block: one warning. Empty surfaces are legal. The
 * coefficients are those of "Research on Ground Object Echo Simulation of Avian Lidar", Photonics
 * 2024, 11(2), 153, Table 1, and of Material.
 *
 * @sa vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter, vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarMaterial_h
#define vtkAvianLidarMaterial_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPassInputTypeAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarMaterial : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarMaterial* New();
  vtkTypeMacro(vtkAvianLidarMaterial, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Values of Material.
  enum MaterialChoices
  {
    MATERIAL_UNCHANGED = -1,
    MATERIAL_WALL = 0,
    MATERIAL_GLASS = 1,
    MATERIAL_METAL = 2,
    MATERIAL_WOOD = 3,
    MATERIAL_CUSTOM = 4,
    MATERIAL_CONCRETE = 5,
    MATERIAL_ASPHALT = 6,
    MATERIAL_GRASS = 7,
    MATERIAL_PLUMAGE = 8
  };

  ///@{
  /**
   * The material: one of the paper's Table 1 (kd, ks, kp: wall 0.146, 0.054, 112; glass 0.020,
   * 0.852, 8046; metal 0.075, 0.634, 6803; wood 0.107, 0.100, 82); one that only scatters, at
   * 905 nm (kd: concrete 0.3104, asphalt 0.1298, grass 0.2204, of the USGS Spectral Library 7;
   * plumage 0.3, assumed); or custom, which takes Kd, Ks, Kp and Roughness. MATERIAL_UNCHANGED, to
   * name surfaces alone: materials stay as they are, or missing. Default MATERIAL_WALL.
   */
  vtkSetMacro(Material, int);
  vtkGetMacro(Material, int);
  void SetMaterialToWall() { this->SetMaterial(MATERIAL_WALL); }
  void SetMaterialToGlass() { this->SetMaterial(MATERIAL_GLASS); }
  void SetMaterialToMetal() { this->SetMaterial(MATERIAL_METAL); }
  void SetMaterialToWood() { this->SetMaterial(MATERIAL_WOOD); }
  void SetMaterialToCustom() { this->SetMaterial(MATERIAL_CUSTOM); }
  void SetMaterialToConcrete() { this->SetMaterial(MATERIAL_CONCRETE); }
  void SetMaterialToAsphalt() { this->SetMaterial(MATERIAL_ASPHALT); }
  void SetMaterialToGrass() { this->SetMaterial(MATERIAL_GRASS); }
  void SetMaterialToPlumage() { this->SetMaterial(MATERIAL_PLUMAGE); }
  ///@}

  ///@{
  /**
   * What a value of Material stands for, without an execution: its name; where its numbers are
   * from, "assumed" where nobody measured them; a coefficient by its number (0 kd, 1 ks, 2 kp, 3
   * roughness); and a colour to look at (red, green, blue, 0 to 1). For MATERIAL_CUSTOM and unknown
   * values null, not a number, or false, and the colour stays as it is.
   */
  static const char* GetMaterialName(int material);
  static const char* GetMaterialSource(int material);
  static double GetMaterialCoefficient(int material, int coefficient);
  static bool GetMaterialColor(int material, double color[3]);
  ///@}

  /**
   * Name of a coefficient's cell array, from 0 on; null beyond the last.
   */
  static const char* GetCoefficientName(int coefficient);

  ///@{
  /**
   * Diffuse coefficient of a custom material, at least 0; kd + ks is at most 1. Default 0.146.
   */
  vtkSetMacro(Kd, double);
  vtkGetMacro(Kd, double);
  ///@}

  ///@{
  /**
   * Specular coefficient of a custom material, at least 0; kd + ks is at most 1. Default 0.054.
   */
  vtkSetMacro(Ks, double);
  vtkGetMacro(Ks, double);
  ///@}

  ///@{
  /**
   * Glossiness of a custom material, within [0, 1e6]. Default 112.
   */
  vtkSetMacro(Kp, double);
  vtkGetMacro(Kp, double);
  ///@}

  ///@{
  /**
   * Roughness of a custom material, rad, within [0, pi/2]: the standard deviation of the slope of
   * its facets, which reflectance model OrenNayar of the echo filter uses. Default 0, even.
   */
  vtkSetMacro(Roughness, double);
  vtkGetMacro(Roughness, double);
  ///@}

  ///@{
  /**
   * Object id of the surfaces, at least 0, or -1, automatic: ids that are there are kept (a leaf
   * that becomes one object has that of its first cell), other leaves get their number in leaf
   * order. Ids that are not unique over a whole scene are given
   * anew when its surfaces are merged. Default -1.
   */
  vtkSetMacro(ObjectId, int);
  vtkGetMacro(ObjectId, int);
  ///@}

  ///@{
  /**
   * Name of the object, written to `object_names` of each leaf, which then is one object. Empty:
   * names that are there are kept, else the block's name is taken. Default: empty.
   */
  vtkSetMacro(NameOfObject, std::string);
  vtkGetMacro(NameOfObject, std::string);
  ///@}

  ///@{
  /**
   * Which blocks of a composite input get the material: those whose name, or the name of a block
   * around them, fits this pattern of text, `*` (any text) and `?` (any character). Not used for
   * vtkPolyData. Default `*`, all blocks; empty means the same.
   */
  vtkSetMacro(BlockNamePattern, std::string);
  vtkGetMacro(BlockNamePattern, std::string);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarMaterial();
  ~vtkAvianLidarMaterial() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int Material;
  double Kd;
  double Ks;
  double Kp;
  double Roughness;
  int ObjectId;
  std::string NameOfObject;
  std::string BlockNamePattern;

private:
  vtkAvianLidarMaterial(const vtkAvianLidarMaterial&) = delete;
  void operator=(const vtkAvianLidarMaterial&) = delete;
};

#endif
