// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarHSBColorMap
 * @brief Adds the hue of each echo's energy (paper, Eq. 13).
 */
#ifndef vtkAvianLidarHSBColorMap_h
#define vtkAvianLidarHSBColorMap_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarHSBColorMap : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarHSBColorMap* New();
  vtkTypeMacro(vtkAvianLidarHSBColorMap, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkAvianLidarHSBColorMap() = default;
  ~vtkAvianLidarHSBColorMap() override = default;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarHSBColorMap(const vtkAvianLidarHSBColorMap&) = delete;
  void operator=(const vtkAvianLidarHSBColorMap&) = delete;
};

#endif
