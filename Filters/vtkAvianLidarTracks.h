// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarTracks
 * @brief Makes flights of birds, by patterns or from tracks, as movers for the echo filter.
 *
 * - Input port 0 (optional, for PATTERN_LINES): vtkPolyData whose lines are tracks in scene
 *   coordinates, m, with the point array `time` (s) and the cell array or field data `species`
 *   (optional).
 * - Output port 0, movers: vtkMultiBlockDataSet, a block for each bird, with the name of the
 *   object. Each block has the triangles of vtkAvianLidarBirdSource in the bird's own frame (x
 *   right, y forward, z up). Field data: `pose_time`, `pose_position`, `pose_orientation`; for
 *   flapping wings `flap_hinge` and the other `flap_` arrays; `object_names`, `material_names` and
 *   `species` (Documentation/guide/moving.md, Movers).
 * - Output port 1, trails: vtkPolyData, a polyline for each bird, with the point array `time`, the
 *   cell arrays `object_id` and `species_id`, and the field data `species_names`.
 *
 * Outputs hold all poses for any requested time or piece. Time 0 is the start of the scan. The same
 * seed gives the same bits. Except in a flock, the flight of a bird does not depend on the number
 * of birds. Patterns, file format and assumptions: Documentation/guide/birds.md.
 *
 * A bad file, times that do not rise, an unknown species or a number out of its range gives an
 * error and empty outputs. The error names the property, the file and its line, or the line of the
 * input. Without birds the outputs are empty.
 *
 * @code
 * birds->SetPatternToCircles();
 * birds->SetTimeRange(0, 20);
 * echoes->SetMoversConnection(birds->GetOutputPort());
 * @endcode
 *
 * @sa vtkAvianLidarBirdSource, vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarTracks_h
#define vtkAvianLidarTracks_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkMultiBlockDataSetAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarTracks : public vtkMultiBlockDataSetAlgorithm
{
public:
  static vtkAvianLidarTracks* New();
  vtkTypeMacro(vtkAvianLidarTracks, vtkMultiBlockDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Patterns
  {
    PATTERN_CROSSINGS = 0,
    PATTERN_CIRCLES = 1,
    PATTERN_FLOCK = 2,
    PATTERN_APPROACH = 3,
    PATTERN_FILE = 4,
    PATTERN_LINES = 5
  };

  ///@{
  /// Pattern of the flights, or source of the tracks. Default PATTERN_CROSSINGS.
  vtkAvianLidarPropertyMacro(Pattern, int, PATTERN_CROSSINGS);
  void SetPatternToCrossings() { this->SetPattern(PATTERN_CROSSINGS); }
  void SetPatternToCircles() { this->SetPattern(PATTERN_CIRCLES); }
  void SetPatternToFlock() { this->SetPattern(PATTERN_FLOCK); }
  void SetPatternToApproach() { this->SetPattern(PATTERN_APPROACH); }
  void SetPatternToFile() { this->SetPattern(PATTERN_FILE); }
  void SetPatternToLines() { this->SetPattern(PATTERN_LINES); }
  ///@}

  /// File of tracks for PATTERN_FILE (CSV), with the header "id,species,time,x,y,z" (s, m) or
  /// "id,species,time,longitude,latitude,height" (s, deg, m above the level of Origin). Default:
  /// empty.
  vtkAvianLidarFilePathMacro(FileName);

  /// Origin of the scene for a file with longitude and latitude: latitude in [-90, 90] and
  /// longitude in [-360, 360], deg, height above the ellipsoid or the sea, as in the file, m.
  /// Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Origin, 3, 0.0, 0.0, 0.0);

  /// Name of a species. Default: empty (starling for flocks, herring gull otherwise).
  vtkAvianLidarPropertyMacro(Species, std::string, {});

  /// Table of the user's species, as for vtkAvianLidarBirdSource. Default: empty.
  vtkAvianLidarFilePathMacro(SpeciesFileName);

  /// Names that Species may have, one in each line: of the built-in species and of SpeciesFileName.
  std::string GetKnownSpecies();

  /// Number of birds, 0 to 100,000. Not used with PATTERN_FILE and PATTERN_LINES. Default 10.
  vtkAvianLidarPropertyMacro(NumberOfBirds, int, 10);

  /// Seed of all random numbers, any int. Default 0.
  vtkAvianLidarPropertyMacro(Seed, int, 0);

  /// Start and end of the flights, s, rising, at most 1e9 in magnitude. Default (0, 60).
  vtkAvianLidarVectorMacro(TimeRange, 2, 0.0, 60.0);

  /// Centre of the region, m, at most 1e9 in magnitude. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Center, 3, 0.0, 0.0, 0.0);

  /// Half of the horizontal width of the region, m, 0 to 1e9. Default 500.
  vtkAvianLidarPropertyMacro(Radius, double, 500.0);

  /// Least and greatest height of flights above Center, m, at most 1e9 in magnitude. Default (10,
  /// 150).
  vtkAvianLidarVectorMacro(Heights, 2, 10.0, 150.0);

  /// Position of the runway's threshold, for PATTERN_APPROACH, m, at most 1e9 in magnitude. Default
  /// (0, 0, 0).
  vtkAvianLidarVectorMacro(ThresholdPosition, 3, 0.0, 0.0, 0.0);

  /// Direction of landing, deg from north, clockwise, at most 1e9 in magnitude. Default 0.
  vtkAvianLidarPropertyMacro(ThresholdHeading, double, 0.0);

  /// Reflectance of the plumage at the lidar's wavelength, 1, 0 to 1. Default 0.3 (assumed).
  vtkAvianLidarPropertyMacro(Reflectance, double, 0.3);

  /// `object_id` of the first bird, at least 0. The ids of the birds are successive and must be
  /// unique in the scene. Default 10000.
  vtkAvianLidarPropertyMacro(FirstObjectId, int, 10000);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarTracks();
  ~vtkAvianLidarTracks() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarTracks(const vtkAvianLidarTracks&) = delete;
  void operator=(const vtkAvianLidarTracks&) = delete;

  class vtkFlights;
};

#endif
