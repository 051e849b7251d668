// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCoverage
 * @brief Where a lidar would detect a bird, where not, and why: beams and surfaces in, a map of
 * probabilities out.
 *
 * For each place: which beams hold it, whether a surface stands before it (one descent of the
 * collision tree), which of the beams have an echo of a surface in the range units that the bird's
 * echo would share (clutter), and with what probability the others detect it, in closed form,
 * averaged over headings and wing phases of the bird. No bird is traced. Lines of sight are kept:
 * another bird, air or receiver traces none (and of clutter at most what was too faint before), and
 * the result is that of a fresh run, bit for bit. Clutter is that of the scan without noise that
 * vtkAvianLidarEchoFilter makes with the same properties, with one echo per range unit.
 *
 * A beam receives the light of that part of the bird's silhouette that it covers, whichever of both
 * is wider; the part's depth spreads its echo over range units. Pulses' noise is independent, the
 * bird the same within a scan. A surface hides the whole bird or nothing of it. See
 * Documentation/coverage.md. It says nothing about real birds: no measured ranges of birds are
 * known for this kind of lidar.
 *
 * Input ports 0, beams, and 1, surfaces: see vtkAvianLidarEchoFilter. All beams of one sensor: they
 * begin at one point. Whatever piece is asked for, all of them are.
 *
 * Input port 2, places (optional): any vtkDataSet, whose points are looked at. Without it they are
 * the points of an image: Bounds and Spacing. Point array `region_id` (int, optional) and field
 * data `region_names` (its texts by number, optional) divide the table.
 *
 * Output port 0: vtkImageData, or the places with all they have. Point arrays (float unless said):
 * `detection_probability` of one scan; `track_probability` that RequiredDetections of NumberOfScans
 * scans detect it (independent scans with the same beams: a bird that shows the same side for long
 * is seen more often or less, and of rotating prisms, which give each scan other beams, a warning
 * says that the one at hand stands for all); `photoelectrons` in a beam that holds all of the bird,
 * of the mean effective area (0 without a photon receiver and where no clear beam reaches the
 * place); `beams_per_scan` (int: whose cones hold it, at most 255); `status` (unsigned char; the
 * first that holds, but for a bird that is partly in a beam and seen though no beam holds the
 * place): 0 outside the range gate, 1 above all beams, 2 below them, 3 between beams, 4 shadowed, 5
 * in clutter, 6 too weak (probability below 0.1), 7 seen; `minimum_effective_area` m2, the mean
 * effective area of which half would be detected if they lay in the beams as a whole (infinite
 * where nothing is); with PoseProbabilities `pose_probabilities` of one scan (a component for each
 * pose: 16 headings for each of 5 wing phases, of gliding birds 80 headings, each pose equally
 * likely; without a species 1). Field data: `status_names`, `species`, `effective_area` m2, what
 * was set here in snake case, and all that vtkAvianLidarEchoFilter writes.
 *
 * Output port 1: vtkTable, one row per region, species and height band, then for all bands and all
 * regions: `region`, `species`, `height_from`, `height_to` m, `places`, `detection_probability` and
 * `track_probability` (means) with `detection_std_error` and `track_std_error` (of the mean, if the
 * places were drawn at random), and `share_outside_the_gate`, `share_above_the_band` and so on, of
 * each status. Places below the bands count for all heights. Of the piece asked for, or of all
 * ranks (then on rank 0).
 *
 * Output port 2, clutter: vtkPolyData, a vertex per range unit with an echo of a surface, with the
 * arrays of the echo filter's echoes, and `detection_probability`: in which share of scans it is
 * perceived. With piece 0.
 *
 * Bad input gives an error that names port and array, or the property, and empty outputs. An
 * aborted run leaves empty outputs. On several ranks each scans all beams, and counts its own
 * rays. Deterministic: points have the same bits for any number of
 * threads and pieces; sums over ranks may differ in the last digits.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarBeamSource, vtkAvianLidarBirdSource
 */
#ifndef vtkAvianLidarCoverage_h
#define vtkAvianLidarCoverage_h

#include "vtkAvianLidarFilePath.h"
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

  ///@{
  /**
   * Region of the image: least and greatest x, y and z of its points, m, in the scene's
   * coordinates. Not used with places. Default: (-1000, 1000, -1000, 1000, 0, 150).
   */
  vtkSetVector6Macro(Bounds, double);
  vtkGetVector6Macro(Bounds, double);
  ///@}

  ///@{
  /**
   * Distances between the image's points in x, y and z, m, above 0. The last point along an axis
   * lies at the end of the region or before it. Default: (20, 20, 15).
   */
  vtkSetVector3Macro(Spacing, double);
  vtkGetVector3Macro(Spacing, double);
  ///@}

  ///@{
  /**
   * Species of the bird, one of the table that ships (starling, kestrel, pigeon, crow, herring
   * gull, Canada goose; all numbers assumed) or of SpeciesFileName. Headings and wing phases are
   * equally likely; it is seen from the elevation of its place. Empty: a target that always shows
   * EffectiveArea. Default: herring gull.
   */
  vtkSetMacro(Species, std::string);
  vtkGetMacro(Species, std::string);
  ///@}

  ///@{
  /**
   * A table of species of your own, as for vtkAvianLidarBirdSource. Default: none.
   */
  vtkAvianLidarFilePathMacro(SpeciesFileName);
  ///@}

  ///@{
  /**
   * Whether the bird glides instead of flapping. Default: off.
   */
  vtkSetMacro(Gliding, bool);
  vtkGetMacro(Gliding, bool);
  vtkBooleanMacro(Gliding, bool);
  ///@}

  ///@{
  /**
   * Mean effective area of the target from the side at 3 degrees of elevation, m2, 0 to 1e6. 0:
   * that of the species; otherwise the whole bird is scaled to it. Needed without a species; 0.018
   * is the standard avian optical target, about a crow. Default: 0.
   */
  vtkSetMacro(EffectiveArea, double);
  vtkGetMacro(EffectiveArea, double);
  ///@}

  ///@{
  /**
   * Reflectance of the plumage at the lidar's wavelength, above 0 to 1. Default: 0.3 (assumed; 0.15
   * dark, 0.6 white).
   */
  vtkSetMacro(Reflectance, double);
  vtkGetMacro(Reflectance, double);
  ///@}

  ///@{
  /**
   * Whether clutter is looked for. Off: no scan is made, no beam is in clutter, and the clutter map
   * is empty; as many sites are compared much faster. Default: on.
   */
  vtkSetMacro(Clutter, bool);
  vtkGetMacro(Clutter, bool);
  vtkBooleanMacro(Clutter, bool);
  ///@}

  ///@{
  /**
   * How many of NumberOfScans scans must detect a bird for a track, 1 to NumberOfScans. Default: 2.
   */
  vtkSetMacro(RequiredDetections, int);
  vtkGetMacro(RequiredDetections, int);
  ///@}

  ///@{
  /**
   * Scans of which RequiredDetections must detect a bird, 1 to 100. Default: 3.
   */
  vtkSetMacro(NumberOfScans, int);
  vtkGetMacro(NumberOfScans, int);
  ///@}

  ///@{
  /**
   * Limits of the table's height bands, m (z), rising; each band holds its lower limit. Default: 0,
   * 15, 30, 60, 150.
   */
  void AddHeightLimit(double height);
  void RemoveAllHeightLimits();
  int GetNumberOfHeightLimits() const;
  double GetHeightLimit(int index);
  ///@}

  ///@{
  /**
   * Weight the places of the table by the heights (z, the ground being 0) of bird strikes: 74 % at
   * or below 152.4 m (500 ft; evenly, which is assumed), above falling by 32 % per 304.8 m (Dolbeer
   * 2006). Default: off.
   */
  vtkSetMacro(StrikeHeightWeights, bool);
  vtkGetMacro(StrikeHeightWeights, bool);
  vtkBooleanMacro(StrikeHeightWeights, bool);
  ///@}

  /**
   * Density of bird strikes over height (m above ground), 1/m, as StrikeHeightWeights takes it; 0
   * below ground.
   */
  static double StrikeHeightDensity(double height);

  ///@{
  /**
   * Whether the table has rows for all species that are known, too. Default: off.
   */
  vtkSetMacro(AllSpecies, bool);
  vtkGetMacro(AllSpecies, bool);
  vtkBooleanMacro(AllSpecies, bool);
  ///@}

  ///@{
  /**
   * Whether the point array `pose_probabilities` is made: of the bird in each of its poses, by the
   * heading from north, so that what several sensors see of one bird is compared pose by pose: the
   * probability that one of them detects it is the mean over poses of 1 - product (1 - p).
   * Default: off.
   */
  vtkSetMacro(PoseProbabilities, bool);
  vtkGetMacro(PoseProbabilities, bool);
  vtkBooleanMacro(PoseProbabilities, bool);
  ///@}

  ///@{
  /**
   * Connect the places (port 2).
   */
  void SetPlacesConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  void SetPlacesData(vtkDataObject* places) { this->SetInputData(2, places); }
  ///@}

  /**
   * Places to which the last execution looked for a line of sight on this rank; 0 when all were
   * known.
   */
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

  double Bounds[6] = { -1000.0, 1000.0, -1000.0, 1000.0, 0.0, 150.0 };
  double Spacing[3] = { 20.0, 20.0, 15.0 };
  std::string Species = "herring gull";
  std::string SpeciesFileName;
  bool Gliding = false;
  double EffectiveArea = 0.0;
  double Reflectance = 0.3;
  bool Clutter = true;
  int RequiredDetections = 2;
  int NumberOfScans = 3;
  std::vector<double> HeightLimits = { 0.0, 15.0, 30.0, 60.0, 150.0 };
  bool StrikeHeightWeights = false;
  bool AllSpecies = false;
  bool PoseProbabilities = false;

private:
  vtkAvianLidarCoverage(const vtkAvianLidarCoverage&) = delete;
  void operator=(const vtkAvianLidarCoverage&) = delete;

  int RequestDataObject(vtkInformationVector** inputVector, vtkInformationVector* outputVector);

  // Passes of an execution, as those of the superclass.
  bool PrepareTargets(const vtkAvianLidarRanks& ranks);
  bool PreparePlaces(const vtkAvianLidarRanks& ranks, vtkDataSet* places, vtkInformation* info);
  bool View(const vtkAvianLidarRanks& ranks, bool isFirst, vtkPolyData* clutter);
  bool Evaluate(const vtkAvianLidarRanks& ranks, vtkDataSet* output, vtkTable* table);

  std::string CheckTarget() const;
  void MakeFields(vtkFieldData* beamFields, vtkFieldData* fields) const;

  struct vtkTargets;
  std::unique_ptr<vtkTargets> Targets;
};

#endif
