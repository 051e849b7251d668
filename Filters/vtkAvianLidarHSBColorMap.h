// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarHSBColorMap
 * @brief The colour of an echo in the HSB mode: Qlow is blue, Qhigh is red.
 *
 * The hue of an energy Q is 240 degrees (Qhigh - Q) / (Qhigh - Qlow), with saturation and
 * brightness 1 (Eq. 13 of "Research on Ground Object Echo Simulation of Avian Lidar", Photonics
 * 2024, 11(2), 153). Energies outside the limits take the colour of the nearer end; with equal
 * limits the hue is 0.
 *
 * - Input port 0: any vtkPointSet with a numeric point array of one component, J; by default
 *   `energy`, another by SetInputArrayToProcess().
 * - Output port 0: a shallow copy with the point arrays `hue` and `rgb`. NaN is black, with one
 *   warning.
 *
 * A missing array or limit, several components, and limits that are not finite or the wrong way
 * round are an error that names them, with an empty output. No points: both arrays without values.
 *
 * Example: `colors->SetInputConnection(echoes->GetOutputPort());` Documentation:
 * colour-and-range-image.md.
 *
 * @sa vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarHSBColorMap_h
#define vtkAvianLidarHSBColorMap_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkNew.h"              // For vtkNew
#include "vtkPointSetAlgorithm.h"

class vtkLookupTable;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarHSBColorMap : public vtkPointSetAlgorithm
{
public:
  static vtkAvianLidarHSBColorMap* New();
  vtkTypeMacro(vtkAvianLidarHSBColorMap, vtkPointSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Take the limits from field data `lower_energy_limit` and `upper_energy_limit`. Default: on. */
  vtkSetMacro(UseFieldDataRange, bool);
  vtkGetMacro(UseFieldDataRange, bool);
  vtkBooleanMacro(UseFieldDataRange, bool);
  ///@}

  ///@{
  /** Qlow and Qhigh if UseFieldDataRange is off, J. Default (2e-6, 6.25e-5), paper, Table 2. */
  vtkSetVector2Macro(EnergyRange, double);
  vtkGetVector2Macro(EnergyRange, double);
  ///@}

  /// Lookup table of these colours over the limits of the last execution (before: EnergyRange), for
  /// a mapper or a scalar bar. This object owns it, and the next call changes it.
  vtkLookupTable* GetLookupTable();

  /// Give `table` these colours and limits; it keeps its number of colours (at least 2). Its ends
  /// are exactly blue and red; values below, above and NaN are blue, red and black.
  void FillLookupTable(vtkLookupTable* table);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarHSBColorMap();
  ~vtkAvianLidarHSBColorMap() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  bool UseFieldDataRange;
  double EnergyRange[2];

private:
  vtkAvianLidarHSBColorMap(const vtkAvianLidarHSBColorMap&) = delete;
  void operator=(const vtkAvianLidarHSBColorMap&) = delete;

  // Finds the limits in use, and what is wrong with them.
  std::string FindLimits(vtkPointSet* input, double limits[2]);

  bool Executed;
  double LastLimits[2];
  vtkNew<vtkLookupTable> Table;
};

#endif
