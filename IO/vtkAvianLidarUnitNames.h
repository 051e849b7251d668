// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarUnitNames
 * @brief Puts the units of arrays into their names, for tables: `energy` becomes `energy [J]`.
 *
 * VTK's XML files keep the unit of an array (vtkDataArray::UNITS_LABEL); CSV files have nothing but
 * names. With this filter before a CSV writer (precision 15) the header says the units.
 *
 * **Input** (port 0): any vtkDataSet or vtkTable. **Output**: the same, shallow, with renamed
 * point, cell and row arrays; values are shared. Arrays without a unit and pure numbers (unit "1")
 * keep their names; field data stay.
 *
 * The brackets are square, as in the descriptions of extra bytes of the LAS writer: a program
 * that takes names apart finds the unit, as names of arrays have round brackets of their own
 * (`speed (mean)`).
 */
#ifndef vtkAvianLidarUnitNames_h
#define vtkAvianLidarUnitNames_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPassInputTypeAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarUnitNames : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarUnitNames* New();
  vtkTypeMacro(vtkAvianLidarUnitNames, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The name with its unit, as every table of this project has it: `energy` and `J` give
   * `energy [J]`; without a unit, or with that of pure numbers ("1"), the name as it is.
   */
  static std::string NameWithUnit(const std::string& name, const std::string& unit);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarUnitNames();
  ~vtkAvianLidarUnitNames() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarUnitNames(const vtkAvianLidarUnitNames&) = delete;
  void operator=(const vtkAvianLidarUnitNames&) = delete;
};

#endif
