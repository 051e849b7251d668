// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCoverage
 * @brief Computes from beams and surfaces where a lidar would detect a bird, where the lidar would
 * miss the bird, and why.
 *
 * For each place the filter finds the beams that contain the place, the surfaces in front of the
 * place, the clutter in the same range units, and the probability of detection in closed form,
 * averaged over the bird's poses. No ray is traced to a bird. Lines of sight are kept: for another
 * bird, air or receiver the filter only evaluates these lines again. The result has the same bits
 * as the result of a new run. Method and limits: Documentation/guide/coverage.md. We found no
 * measured detection ranges of birds for this kind of lidar.
 *
 * - Input port 0, beams of one sensor: as for vtkAvianLidarEchoFilter. The filter requests all
 *   beams for any piece of the output.
 * - Input port 1, surfaces: as for vtkAvianLidarEchoFilter.
 * - Input port 2, places (optional): any vtkDataSet, whose points are evaluated instead of the
 *   image given by Bounds and Spacing. The point array `region_id` (int) and the field data
 *   `region_names` give the regions of the table.
 * - Output port 0: vtkImageData, or the places with their data. Point arrays (float):
 *   `detection_probability`, `track_probability`, `photoelectrons`, `minimum_effective_area`
 *   (infinite where nothing is detected), `beams_per_scan` (int), `status` (unsigned char, a
 *   StatusType) and, with PoseProbabilities on, `pose_probabilities` (16 headings for each of 5
 *   wing phases; 80 headings for gliding birds; 1 value without a species). Field data: the field
 *   data of the echo filter, the settings of this filter, and `status_names`.
 * - Output port 1: vtkTable, a row per region, species and height band, then rows for all bands and
 *   all regions. Columns: means of both probabilities, their standard errors, and a share for each
 *   status, such as `share_outside_the_gate`. With several ranks, rank 0 has the table.
 * - Output port 2, clutter: vtkPolyData, a vertex per range unit with an echo of a surface, with
 *   the arrays of echoes and `detection_probability`. Piece 0 has the clutter.
 *
 * A bad input or setting gives empty outputs and an error that names the property, or port and
 * array. An aborted run leaves empty outputs. Points have the same bits for any number of threads
 * and pieces. Sums over ranks may differ in the last digits.
 *
 * @code
 * coverage->SetInputConnection(sensor->GetOutputPort());
 * coverage->SetSurfacesConnection(tree->GetOutputPort());
 * coverage->SetSpecies("crow");
 * @endcode
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarBeamSource, vtkAvianLidarBirdSource
 */
#ifndef vtkAvianLidarCoverage_h
#define vtkAvianLidarCoverage_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarScanFilter.h"

#include <memory> // For std::unique_ptr
#include <string> // For names
#include <vector> // For height limits

class vtkDataSet;
class vtkFieldData;
class vtkPolyData;
class vtkTable;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarCoverage : public vtkAvianLidarScanFilter
{
public:
  static vtkAvianLidarCoverage* New();
  vtkTypeMacro(vtkAvianLidarCoverage, vtkAvianLidarScanFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum StatusType
  {
    STATUS_OUTSIDE_GATE = 0,
    STATUS_ABOVE_BAND = 1,
    STATUS_BELOW_BAND = 2,
    STATUS_BETWEEN_BEAMS = 3,
    STATUS_SHADOWED = 4,
    STATUS_IN_CLUTTER = 5,
    STATUS_TOO_WEAK = 6,
    STATUS_SEEN = 7
  };

  /// Limits of the image in x, y and z, m, at most 1e30 in magnitude. Default: (-1000, 1000, -1000,
  /// 1000, 0, 150).
  vtkAvianLidarVectorMacro(Bounds, 6, -1000.0, 1000.0, -1000.0, 1000.0, 0.0, 150.0);

  /// Distances between the image's points in x, y and z, m, above 0. Default: (20, 20, 15).
  vtkAvianLidarVectorMacro(Spacing, 3, 20.0, 20.0, 15.0);

  /// Name of a species, or empty for a target with EffectiveArea from all sides. Default: herring
  /// gull.
  vtkAvianLidarPropertyMacro(Species, std::string, "herring gull");

  /// Table of the user's species, as for vtkAvianLidarBirdSource. Default: empty.
  vtkAvianLidarFilePathMacro(SpeciesFileName);

  /// Names that Species may have, one in each line: of the built-in species and of SpeciesFileName.
  std::string GetKnownSpecies();

  /// Whether the bird glides instead of flapping. Default: off.
  vtkAvianLidarSwitchMacro(Gliding, false);

  /// Effective area to which the bird is scaled, m2, 0 to 1e6: the mean over all headings and wing
  /// phases, for a bird at an elevation of 3 degrees. The standard avian optical target has 0.018
  /// m2. Default: 0, area of the species.
  vtkAvianLidarPropertyMacro(EffectiveArea, double, 0.0);

  /// Reflectance of the plumage, 1, above 0 to 1. Default: 0.3 (assumed; 0.15 dark, 0.6 white).
  vtkAvianLidarPropertyMacro(Reflectance, double, 0.3);

  /// Whether the filter scans the surfaces to find clutter. Without this scan, the filter is much
  /// faster. Default: on.
  vtkAvianLidarSwitchMacro(Clutter, true);

  /// Number of detections in NumberOfScans scans that make a track, 1 to NumberOfScans. Default: 2.
  vtkAvianLidarPropertyMacro(RequiredDetections, int, 2);

  /// Number of scans of which RequiredDetections must detect a bird, 1 to 100. Default: 3.
  vtkAvianLidarPropertyMacro(NumberOfScans, int, 3);

  ///@{
  /// Limits of the height bands in z, m, rising. Each limit belongs to the band above the limit.
  /// Default: 0, 15, 30, 60, 150.
  void AddHeightLimit(double height);
  void RemoveAllHeightLimits();
  int GetNumberOfHeightLimits() const;
  double GetHeightLimit(int index);
  ///@}

  /// Whether the table weights places by StrikeHeightDensity() at their z. Default: off.
  vtkAvianLidarSwitchMacro(StrikeHeightWeights, false);

  /// Density of bird strikes by height above ground, 1/m. Below 152.4 m the density is uniform
  /// (assumed) and contains 74 % of the strikes. Above 152.4 m the density decreases by 32 % per
  /// 304.8 m (Dolbeer 2006). Below ground the density is 0. @param height height above ground, m
  static double StrikeHeightDensity(double height);

  /// Whether the table also has rows for all other species. Default: off.
  vtkAvianLidarSwitchMacro(AllSpecies, false);

  /// Whether the output has `pose_probabilities`, to compare several sensors pose by pose. Default:
  /// off.
  vtkAvianLidarSwitchMacro(PoseProbabilities, false);

  ///@{
  /// Input port 2, the places (optional).
  void SetPlacesConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  void SetPlacesData(vtkDataObject* places) { this->SetInputData(2, places); }
  ///@}

  /// Number of places whose line of sight the last execution traced on this rank; 0 if all lines of
  /// sight were kept.
  double GetNumberOfTracedPlaces() const;

  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

protected:
  vtkAvianLidarCoverage();
  ~vtkAvianLidarCoverage() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  std::vector<double> HeightLimits = { 0.0, 15.0, 30.0, 60.0, 150.0 };

private:
  vtkAvianLidarCoverage(const vtkAvianLidarCoverage&) = delete;
  void operator=(const vtkAvianLidarCoverage&) = delete;

  int RequestDataObject(vtkInformationVector** inputVector, vtkInformationVector* outputVector);

  // Passes of an execution. All ranks must call the functions that take `ranks`.
  void PrepareTargets();
  void PreparePlaces(const vtkAvianLidarRanks& ranks, vtkDataSet* places, vtkInformation* info);
  void View(const vtkAvianLidarRanks& ranks, vtkPolyData* clutter);
  void Evaluate(const vtkAvianLidarRanks& ranks, vtkDataSet* output, vtkTable* table);

  void CheckTarget() const;
  void MakeFields(vtkFieldData* beamFields, vtkFieldData* fields) const;

  struct vtkTargets;
  std::unique_ptr<vtkTargets> Targets;
};

#endif
