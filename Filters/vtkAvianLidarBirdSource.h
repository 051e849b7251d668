// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarBirdSource
 * @brief A bird: a body and two wings as closed surfaces, by species.
 *
 * No input. **Output** (vtkPolyData): triangles in metres, three closed surfaces: body, left wing,
 * right wing. Cell arrays: those of vtkAvianLidarMaterial (`kd` is Reflectance, `ks` 0, `kp` 1;
 * `material_id` is 4, Plumage, of `material_names`; `object_id`) and `part` (int: 0 body, 1 left
 * wing, 2 right wing). Field data: `material_names`, `object_names` (the species), `object_classes`
 * ("bird").
 *
 * The body is an ellipsoid of revolution, 0.65 of the bird's length, whose frontal area follows
 * from the mass (Hedenstrom and Rosen 2003; Pennycuick 1988). The wings are thin plates with 0.85
 * of the wing area, hinged at the body, with an angle of attack of 6 degrees; they flap by 35
 * degrees, or are held 5 degrees up in a glide. These shares and angles, and the table of species,
 * are assumed. The shape has no head, tail or legs.
 * It has 72 triangles, few enough that beams in which it flies are integrated; the body's effective
 * area is that of the ellipsoid from every direction.
 *
 * **Bad values** (an unknown species, a table that is wrong, a number that is not finite or out of
 * its range) are an error that names the property, with empty output; setters keep what they are
 * given.
 *
 * @sa vtkAvianLidarMaterial, vtkAvianLidarCollisionTree
 */
#ifndef vtkAvianLidarBirdSource_h
#define vtkAvianLidarBirdSource_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarFilePath.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarBirdSource : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarBirdSource* New();
  vtkTypeMacro(vtkAvianLidarBirdSource, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Name of a species of the table. Built in: starling, kestrel, pigeon, crow, herring gull, Canada
   * goose. Default "herring gull".
   */
  vtkSetMacro(Species, std::string);
  vtkGetMacro(Species, std::string);
  ///@}

  ///@{
  /**
   * A table of species of your own (CSV, columns as in Filters/Birds/species.csv), which comes
   * before the built-in one. Default: none.
   */
  vtkAvianLidarFilePathMacro(SpeciesFileName);
  ///@}

  ///@{
  /**
   * Where in its wingbeat the bird is, any finite number, 1 is a whole beat: 0 wings level and
   * rising, 0.25 up, 0.75 down. Not used in a glide. Default 0.
   */
  vtkSetMacro(WingPhase, double);
  vtkGetMacro(WingPhase, double);
  ///@}

  ///@{
  /**
   * Whether the wings are held still, 5 degrees up. Default off.
   */
  vtkSetMacro(Gliding, bool);
  vtkGetMacro(Gliding, bool);
  vtkBooleanMacro(Gliding, bool);
  ///@}

  ///@{
  /**
   * Where the middle of the body is, in metres (x east, y north, z up), at most 1e30. Default (0,
   * 0, 0).
   */
  vtkSetVector3Macro(Position, double);
  vtkGetVector3Macro(Position, double);
  ///@}

  ///@{
  /**
   * Direction of flight in degrees from north (y), clockwise. Any finite angle. Default 0.
   */
  vtkSetMacro(Heading, double);
  vtkGetMacro(Heading, double);
  ///@}

  ///@{
  /**
   * Roll to the right in degrees. Any finite angle. Default 0.
   */
  vtkSetMacro(Bank, double);
  vtkGetMacro(Bank, double);
  ///@}

  ///@{
  /**
   * Reflectance of the plumage at the lidar's wavelength, Lambertian, 0 to 1. Default 0.3 (assumed;
   * dark birds 0.15, white ones 0.6).
   */
  vtkSetMacro(Reflectance, double);
  vtkGetMacro(Reflectance, double);
  ///@}

  ///@{
  /**
   * Value of `object_id`, at least -1. Default 1.
   */
  vtkSetMacro(ObjectId, int);
  vtkGetMacro(ObjectId, int);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarBirdSource();
  ~vtkAvianLidarBirdSource() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  std::string Species = "herring gull";
  std::string SpeciesFileName;
  double WingPhase = 0.0;
  bool Gliding = false;
  double Position[3] = { 0.0, 0.0, 0.0 };
  double Heading = 0.0;
  double Bank = 0.0;
  double Reflectance = 0.3;
  int ObjectId = 1;

private:
  vtkAvianLidarBirdSource(const vtkAvianLidarBirdSource&) = delete;
  void operator=(const vtkAvianLidarBirdSource&) = delete;
};

#endif
