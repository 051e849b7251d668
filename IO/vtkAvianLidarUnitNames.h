// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarUnitNames
 * @brief Appends units to the names of arrays, for tables: `energy` becomes `energy [J]`.
 *
 * VTK's XML files store the unit of an array (vtkDataArray::UNITS_LABEL). CSV files store only the
 * name. Put this filter before a CSV writer with the precision 15. The brackets are square, because
 * names of arrays may have round brackets, as in `speed (mean)`.
 *
 * - Input port 0: any vtkDataSet or vtkTable.
 * - Output port 0: a shallow copy with renamed point, cell and row arrays. Field data and arrays
 *   without a unit or with the unit "1" keep their names.
 */
#ifndef vtkAvianLidarUnitNames_h
#define vtkAvianLidarUnitNames_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPassInputTypeAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarUnitNames : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarUnitNames* New();
  vtkTypeMacro(vtkAvianLidarUnitNames, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Returns the name with the unit, such as `energy [J]`. Returns only the name if the unit is
  /// empty or "1".
  static std::string NameWithUnit(const std::string& name, const std::string& unit);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarUnitNames() = default;
  ~vtkAvianLidarUnitNames() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarUnitNames(const vtkAvianLidarUnitNames&) = delete;
  void operator=(const vtkAvianLidarUnitNames&) = delete;
};

#endif
