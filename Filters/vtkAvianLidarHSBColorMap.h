// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarHSBColorMap
 * @brief Colours echoes in the HSB mode: Qlow is blue, Qhigh is red.
 *
 * The hue of an energy Q is 240 degrees (Qhigh - Q) / (Qhigh - Qlow), with saturation and
 * brightness 1 (Eq. 13 of "Research on Ground Object Echo Simulation of Avian Lidar", Photonics
 * 2024, 11(2), 153). Energies outside the limits have the colour of the nearer limit. With equal
 * limits the hue is 0.
 *
 * - Input port 0: any vtkPointSet with a numeric point array of one component, J, by default
 *   `energy`. SetInputArrayToProcess() chooses another array.
 * - Output port 0: a shallow copy with the point arrays `hue` and `rgb`. NaN is black, with one
 *   warning.
 *
 * A missing array or limit, several components, or limits that are not finite or in the wrong order
 * give an empty output and an error that names the fault. Without points, `hue` and `rgb` are
 * empty.
 *
 * Example: `colors->SetInputConnection(echoes->GetOutputPort());` Documentation:
 * guide/clouds.md.
 *
 * @sa vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarHSBColorMap_h
#define vtkAvianLidarHSBColorMap_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkNew.h" // For vtkNew
#include "vtkPointSetAlgorithm.h"

class vtkLookupTable;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarHSBColorMap : public vtkPointSetAlgorithm
{
public:
  static vtkAvianLidarHSBColorMap* New();
  vtkTypeMacro(vtkAvianLidarHSBColorMap, vtkPointSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Whether the field data `lower_energy_limit` and `upper_energy_limit` are the limits. Default:
  /// on.
  vtkAvianLidarSwitchMacro(UseFieldDataRange, true);

  /// Qlow and Qhigh if UseFieldDataRange is off, J. Default (2e-6, 6.25e-5), as in the paper's
  /// Table 2.
  vtkAvianLidarVectorMacro(EnergyRange, 2, 2e-6, 6.25e-5);

  /// Lookup table of the colours for a mapper or a scalar bar, between the limits of the last
  /// execution or, before the first execution, of EnergyRange. The filter owns the table. The next
  /// call of this function changes the table.
  vtkLookupTable* GetLookupTable();

  /// Set the colours and limits of `table` as in GetLookupTable(). The number of colours (at least
  /// 2) is kept. The ends are exactly blue and red. Values below the limits are blue, values above
  /// the limits are red, and NaN is black.
  void FillLookupTable(vtkLookupTable* table);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarHSBColorMap();
  ~vtkAvianLidarHSBColorMap() override = default;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarHSBColorMap(const vtkAvianLidarHSBColorMap&) = delete;
  void operator=(const vtkAvianLidarHSBColorMap&) = delete;

  // Finds the limits in use. Throws std::runtime_error if the limits are bad.
  void FindLimits(vtkPointSet* input, double limits[2]);

  bool Executed = false;
  double LastLimits[2] = { 2e-6, 6.25e-5 };
  vtkNew<vtkLookupTable> Table;
};

#endif
