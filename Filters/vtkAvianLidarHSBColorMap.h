// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarHSBColorMap
 * @brief The colour of an echo in the HSB mode: Qlow is blue, Qhigh is red.
 *
 * The hue of an energy Q is 240 degrees * (Qhigh - Q) / (Qhigh - Qlow), saturation and brightness
 * are 1 (paper, Eq. 13: "Research on Ground Object Echo Simulation of Avian Lidar", Photonics 2024,
 * 11(2), 153; the sentence before the equation swaps the two ends, the equation is right). An
 * energy outside the limits takes the colour of the nearer end, and where both limits are equal the
 * hue is 0.
 *
 * **Input** (port 0): any vtkPointSet with a numeric point array of one component in joules; by
 * default `energy`, another by SetInputArrayToProcess(). **Output**: a shallow copy with two point
 * arrays more:
 *
 * - `hue` (double, deg): 240 (Qlow) to 0 (Qhigh)
 * - `rgb` (unsigned char, 3 components): the colour in 0 to 255, rounded; for VTK's mappers and
 *   writers
 *
 * An energy that is not a number has a hue that is not a number and is black; their count is said
 * in one warning.
 *
 * **Bad input**: no such array, more than one component, limits that are missing in the field data,
 * more than one number, not finite or the wrong way round are an error that names them, with an
 * empty output. No points: no points with both arrays, silence.
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
  /**
   * Take the limits from the input's field data `lower_energy_limit` and `upper_energy_limit`,
   * where the sensor leaves them, instead of EnergyRange. Default on.
   */
  vtkSetMacro(UseFieldDataRange, bool);
  vtkGetMacro(UseFieldDataRange, bool);
  vtkBooleanMacro(UseFieldDataRange, bool);
  ///@}

  ///@{
  /**
   * Qlow and Qhigh in joules, used when UseFieldDataRange is off; Qlow must not exceed Qhigh.
   * Default (2e-6, 6.25e-5), the paper's Table 2.
   */
  vtkSetVector2Macro(EnergyRange, double);
  vtkGetVector2Macro(EnergyRange, double);
  ///@}

  /**
   * A lookup table of these colours over the limits of the last execution (before the first:
   * EnergyRange), for a mapper that colours by energy itself, or for a scalar bar. Owned by this
   * object and changed by the next call.
   */
  vtkLookupTable* GetLookupTable();

  /**
   * Make `table` such a lookup table: its range and its colours, of which it keeps its number (at
   * least 2). Its ends are exactly blue and red; below, above and NaN are blue, red and black.
   */
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
