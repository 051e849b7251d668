// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarMaterial
 * @brief Gives surfaces a material, which says how they reflect the light of the lidar.
 *
 * - Input port 0: vtkPolyData, or a composite whose leaves are vtkPolyData.
 * - Output port 0: shallow copies of the input. Leaves that match BlockNamePattern have the cell
 *   array `object_id` and, unless Material is unchanged, `material_id` (index into
 *   `material_names`) and an array for each coefficient. The field data of these leaves are
 *   `material_names` (the names of the input, or else the four names of the paper, and the name of
 *   the material), `object_names` (one value) and `object_classes`, if the input has classes. A
 *   leaf that becomes one object has one class, which is empty if the classes of the leaf differ. A
 *   composite also has `material_names`.
 *
 * A chain of these filters, with different patterns, can set the material of each part of a scene.
 * Coefficients are defined as in "Research on Ground Object Echo Simulation of Avian Lidar",
 * Photonics 2024, 11(2), 153 (Eq. 6, 7, Table 1). Documentation: method/reflectance.md.
 *
 * Coefficients out of range, kd + ks above 1, an unknown material or a matching leaf that is not
 * vtkPolyData gives an error and an empty output. A pattern that matches no block gives a warning.
 *
 * Example: `glass->SetMaterialToGlass(); glass->SetBlockNamePattern("window*");`
 *
 * @sa vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter, vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarMaterial_h
#define vtkAvianLidarMaterial_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPassInputTypeAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarMaterial : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarMaterial* New();
  vtkTypeMacro(vtkAvianLidarMaterial, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

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
  /// Material of the surfaces: wall, glass, metal or wood (paper, Table 1); one of the diffuse
  /// materials concrete, asphalt, grass (USGS Spectral Library 7, 905 nm) and plumage (assumed);
  /// custom, by Kd, Ks, Kp and Roughness; or unchanged, to name surfaces only. Default
  /// MATERIAL_WALL.
  vtkAvianLidarPropertyMacro(Material, int, MATERIAL_WALL);
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
  /// Name of a value of Material, source of its coefficients ("assumed" if not measured), one of
  /// its coefficients (0 kd, 1 ks, 2 kp, 3 roughness) and its colour (red, green, blue, 0 to 1).
  /// MATERIAL_CUSTOM and unknown values give null, NaN, or false with the colour unchanged.
  static const char* GetMaterialName(int material);
  static const char* GetMaterialSource(int material);
  static double GetMaterialCoefficient(int material, int coefficient);
  static bool GetMaterialColor(int material, double color[3]);
  ///@}

  /// Name of the cell array of a coefficient, counted from 0; null beyond the last coefficient.
  static const char* GetCoefficientName(int coefficient);

  /// Diffuse coefficient of a custom material, 1, 0 to 1 - Ks. Default 0.146.
  vtkAvianLidarPropertyMacro(Kd, double, 0.146);

  /// Specular coefficient of a custom material, 1, 0 to 1 - Kd. Default 0.054.
  vtkAvianLidarPropertyMacro(Ks, double, 0.054);

  /// Glossiness of a custom material, 1, 0 to 1e6. Default 112.
  vtkAvianLidarPropertyMacro(Kp, double, 112.0);

  /// Standard deviation of facet slopes of a custom material, rad, 0 to pi/2. Default 0.
  vtkAvianLidarPropertyMacro(Roughness, double, 0.0);

  /// Object id of the surfaces, at least -1. With -1, the default, leaves keep their ids. The id of
  /// a leaf without ids is then its number in leaf order. Ids that are not unique in a scene are
  /// replaced when surfaces are merged.
  vtkAvianLidarPropertyMacro(ObjectId, int, -1);

  /// Name of the object that each leaf becomes. Default: empty, which keeps the name that the leaf
  /// has, or else uses the name of the block.
  vtkAvianLidarPropertyMacro(NameOfObject, std::string, {});

  /// Pattern of names, with `*` (any text) and `?` (any character). The material is set in blocks
  /// whose names match and in all blocks inside these blocks. Default `*`: all blocks, as with an
  /// empty pattern.
  vtkAvianLidarPropertyMacro(BlockNamePattern, std::string, "*");

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarMaterial() = default;
  ~vtkAvianLidarMaterial() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarMaterial(const vtkAvianLidarMaterial&) = delete;
  void operator=(const vtkAvianLidarMaterial&) = delete;
};

#endif
