// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarTracks
 * @brief Flights of birds, by patterns or from tracks, as movers for the echo filter.
 *
 * **Input** (port 0, optional, for the pattern Lines): vtkPolyData whose lines and polylines are
 * tracks in scene coordinates (m), with the point array `time` (s) and, optionally, the cell array
 * `species` (text) or field data `species` (one text for all lines, or one for each).
 *
 * **Output port 0**, the movers (vtkMultiBlockDataSet): one block for each bird, named as the
 * object ("herring gull 17"): the triangles of vtkAvianLidarBirdSource in the bird's own frame, in
 * metres (x right, y forward, z up, wings at angle 0, or 5 degrees up in a glide), with its cell
 * arrays, and field data:
 *
 * - `pose_time` (double, s, rising), `pose_position` (3 doubles, m) and `pose_orientation`
 *   (4 doubles: unit quaternion w, x, y, z, from the bird's frame to the scene's). Between poses:
 *   linear, and slerp; before the first and after the last the bird is absent.
 * - where wings flap, a row for each: `flap_hinge` (3, m), `flap_axis` (3, unit),
 *   `flap_amplitude` (rad), `flap_frequency` (Hz), `flap_phase` (wingbeats). The cells whose `part`
 *   is p turn about row p - 1 by amplitude sin(2 pi (frequency t + phase)) at the time t, by the
 *   right-hand rule. In a glide there are neither these nor `part`.
 * - `object_names` (the block's name), `material_names`, `species`.
 *
 * **Output port 1**, the trails (vtkPolyData), to draw: a polyline for each bird through its poses,
 * with the point array `time` (s), cell arrays `object_id` and `species_id` (int) and field data
 * `species_names`.
 *
 * Outputs hold all poses, whatever time or piece is asked for. The times are those of the scan: 0
 * is its beginning.
 *
 * **Patterns.** Of Crossings, Circles, Flock and Approach all birds are there for the whole
 * TimeRange:
 * - Crossings: straight, level flights at random headings past Center, at most Radius away when
 *   they are nearest, at a random time in TimeRange. Before and after they are farther away.
 * - Circles: gliding in level circles whose centres lie within Radius; banked 20 to 40 degrees,
 *   tan(bank) = v^2 / (g r).
 * - Flock: one flock on a straight, level flight, as in Crossings, that is thin, lies flat, and has
 *   sides as 1 : 2.8 : 5.6; starlings were measured so (M. Ballerini et al., "Empirical
 *   investigation of starling flocks", Animal Behaviour 76, 2008). It does not change its shape.
 *   Where a bird flies in it depends on the number of birds.
 * - Approach: birds descend at 3 degrees, one after the other, along the approach to a runway's
 *   threshold: the birds that arriving aircraft meet. At the end of TimeRange they are evenly
 *   spread over 2 Radius before the threshold and over 75 m + 0.15 times the distance to either
 *   side. Center and Heights do not matter.
 * - File: tracks of a CSV file. Lines: tracks of the input. TimeRange, Center and the like do not
 *   matter; heading, pitch and bank follow from the path.
 *
 * Speeds vary by 10 % about the airspeed of the species, cut at 30 %; birds flap but in circles.
 * Banks, speeds, spreads and the density of flocks are assumed. There is no wind.
 *
 * **Determinism**: the same seed gives the same bits. A bird does not depend on how many follow it,
 * but in a flock.
 *
 * **Bad input** (a file that is missing or wrong, times that do not rise, an unknown species, a
 * number out of its range) is an error that names the property, or file and line, or line of the
 * input, with empty outputs. No birds: empty outputs, silence.
 *
 * @sa vtkAvianLidarBirdSource, vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarTracks_h
#define vtkAvianLidarTracks_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarFilePath.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkMultiBlockDataSetAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarTracks : public vtkMultiBlockDataSetAlgorithm
{
public:
  static vtkAvianLidarTracks* New();
  vtkTypeMacro(vtkAvianLidarTracks, vtkMultiBlockDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Values of Pattern.
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
  /**
   * How the birds fly, or where their tracks come from; see above. Default PATTERN_CROSSINGS.
   */
  vtkSetMacro(Pattern, int);
  vtkGetMacro(Pattern, int);
  void SetPatternToCrossings() { this->SetPattern(PATTERN_CROSSINGS); }
  void SetPatternToCircles() { this->SetPattern(PATTERN_CIRCLES); }
  void SetPatternToFlock() { this->SetPattern(PATTERN_FLOCK); }
  void SetPatternToApproach() { this->SetPattern(PATTERN_APPROACH); }
  void SetPatternToFile() { this->SetPattern(PATTERN_FILE); }
  void SetPatternToLines() { this->SetPattern(PATTERN_LINES); }
  ///@}

  ///@{
  /**
   * Tracks for the pattern File (CSV): a header "id,species,time,x,y,z" or
   * "id,species,time,longitude,latitude,height"; then one pose a line: name of the track, species,
   * s, and m in the scene's coordinates, or degrees and m above the WGS84 ellipsoid. Lines that
   * begin with # are comments. A track has at least two poses; its times rise. Default: none.
   */
  vtkAvianLidarFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * Origin of the scene, for longitudes and latitudes in a file: latitude in [-90, 90] and
   * longitude in [-360, 360] degrees, height above the ellipsoid in metres, in the order of
   * vtkAvianLidarGeodeticTransform. Default (0, 0, 0).
   */
  vtkSetVector3Macro(Origin, double);
  vtkGetVector3Macro(Origin, double);
  ///@}

  ///@{
  /**
   * Name of a species, as of vtkAvianLidarBirdSource. Not used where a file or the input's lines
   * have their own. Default: empty, a starling for flocks and a herring gull otherwise.
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
   * Number of birds, 0 to 100,000. Not used by File and Lines. Default 10.
   */
  vtkSetMacro(NumberOfBirds, int);
  vtkGetMacro(NumberOfBirds, int);
  ///@}

  ///@{
  /**
   * Seed of all random numbers, any int. Default 0.
   */
  vtkSetMacro(Seed, int);
  vtkGetMacro(Seed, int);
  ///@}

  ///@{
  /**
   * Begin and end of the flights that are made, in seconds, rising, at most 1e9 in magnitude.
   * Default 0 to 60.
   */
  vtkSetVector2Macro(TimeRange, double);
  vtkGetVector2Macro(TimeRange, double);
  ///@}

  ///@{
  /**
   * Middle of the region, in metres (x east, y north, z up), at most 1e9 in magnitude. Default (0,
   * 0, 0).
   */
  vtkSetVector3Macro(Center, double);
  vtkGetVector3Macro(Center, double);
  ///@}

  ///@{
  /**
   * Half the horizontal width of the region, in metres, 0 to 1e9. Default 500.
   */
  vtkSetMacro(Radius, double);
  vtkGetMacro(Radius, double);
  ///@}

  ///@{
  /**
   * Lowest and highest flight above Center, in metres, at most 1e9 in magnitude; of a flock, whose
   * birds stay between them if it is not too thick. Default 10 to 150.
   */
  vtkSetVector2Macro(Heights, double);
  vtkGetVector2Macro(Heights, double);
  ///@}

  ///@{
  /**
   * The runway's threshold, for the pattern Approach, in metres, at most 1e9 in magnitude. Default
   * (0, 0, 0).
   */
  vtkSetVector3Macro(ThresholdPosition, double);
  vtkGetVector3Macro(ThresholdPosition, double);
  ///@}

  ///@{
  /**
   * Direction in which arrivals land there, in degrees from north (y), clockwise, at most 1e9 in
   * magnitude. Default 0.
   */
  vtkSetMacro(ThresholdHeading, double);
  vtkGetMacro(ThresholdHeading, double);
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
   * Value of `object_id` of the first bird, at least 0; those that follow count upwards. No other
   * object of the scene may have these. Default 10000.
   */
  vtkSetMacro(FirstObjectId, int);
  vtkGetMacro(FirstObjectId, int);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarTracks();
  ~vtkAvianLidarTracks() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int Pattern = PATTERN_CROSSINGS;
  std::string FileName;
  double Origin[3] = { 0.0, 0.0, 0.0 };
  std::string Species;
  std::string SpeciesFileName;
  int NumberOfBirds = 10;
  int Seed = 0;
  double TimeRange[2] = { 0.0, 60.0 };
  double Center[3] = { 0.0, 0.0, 0.0 };
  double Radius = 500.0;
  double Heights[2] = { 10.0, 150.0 };
  double ThresholdPosition[3] = { 0.0, 0.0, 0.0 };
  double ThresholdHeading = 0.0;
  double Reflectance = 0.3;
  int FirstObjectId = 10000;

private:
  vtkAvianLidarTracks(const vtkAvianLidarTracks&) = delete;
  void operator=(const vtkAvianLidarTracks&) = delete;

  class vtkFlights;
};

#endif
