// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarBirdSource
 * @brief Makes a bird of a species: a body and two wings as closed surfaces.
 *
 * The source has no input. Output port 0 is vtkPolyData: 72 triangles, m, with the cell arrays of
 * vtkAvianLidarMaterial and `part` (0 body, 1 left wing, 2 right wing), and the field data
 * `material_names` (entry 4 is Plumage), `object_names` (the species) and `object_classes`
 * ("bird"). The array `kd` has the value of Reflectance.
 *
 * The body has the effective area of an ellipsoid of revolution, exactly and from every direction.
 * The frontal area of this ellipsoid follows from the mass (Hedenstrom and Rosen 2003; Pennycuick
 * 1988). The wings are thin plates that flap. Shape, assumptions and species:
 * Documentation/guide/birds.md.
 *
 * An unknown species, a bad table or a bad number gives an empty output and an error that names the
 * property. Setters accept any value.
 *
 * Example: `bird->SetSpecies("crow"); bird->SetPosition(0, 300, 15); bird->SetHeading(60);`
 *
 * @sa vtkAvianLidarMaterial, vtkAvianLidarTracks
 */
#ifndef vtkAvianLidarBirdSource_h
#define vtkAvianLidarBirdSource_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarBirdSource : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarBirdSource* New();
  vtkTypeMacro(vtkAvianLidarBirdSource, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Name of a species, built in or in SpeciesFileName. Default "herring gull".
  vtkAvianLidarPropertyMacro(Species, std::string, "herring gull");

  /// Table of the user's species (CSV, with the columns of Filters/Birds/species.csv). If a name is
  /// also the name of a built-in species, the species of the table is used. Default: empty.
  vtkAvianLidarFilePathMacro(SpeciesFileName);

  /// Names that Species may have, one in each line: of the built-in species and of SpeciesFileName.
  std::string GetKnownSpecies();

  /// Phase of the wings, wingbeats, any finite number: 0 level and rising, 0.25 up, 0.75 down. Not
  /// used if Gliding is on. Default 0.
  vtkAvianLidarPropertyMacro(WingPhase, double, 0.0);

  /// Whether the wings are held still, 5 degrees up. Default: off.
  vtkAvianLidarSwitchMacro(Gliding, false);

  /// Centre of the body, m, x east, y north, z up, at most 1e30. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Position, 3, 0.0, 0.0, 0.0);

  /// Direction of flight, deg from north, clockwise, any finite angle. Default 0.
  vtkAvianLidarPropertyMacro(Heading, double, 0.0);

  /// Roll to the right, deg, any finite angle. Default 0.
  vtkAvianLidarPropertyMacro(Bank, double, 0.0);

  /// Reflectance of the plumage at the lidar's wavelength, 1, 0 to 1. Default 0.3 (assumed).
  vtkAvianLidarPropertyMacro(Reflectance, double, 0.3);

  /// Value of `object_id`, at least -1. Default 1.
  vtkAvianLidarPropertyMacro(ObjectId, int, 1);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarBirdSource();
  ~vtkAvianLidarBirdSource() override = default;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarBirdSource(const vtkAvianLidarBirdSource&) = delete;
  void operator=(const vtkAvianLidarBirdSource&) = delete;
};

#endif
