// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSensorReader
 * @brief Reads a sensor from a file (`.lidarsensor.json`): a beam source with the values of the
 * file.
 *
 * The outputs are the outputs of vtkAvianLidarBeamSource. The file is read when FileName is set.
 * Properties that are not in the file are set to their defaults. Only Position, Orientation,
 * NumberOfRevolutions, StepsPerRevolution and MotionSeed are kept. Values set later are used until
 * the file is read again.
 *
 * Errors name the file, the key and what was expected, and leave empty outputs.
 *
 * Example: `reader->SetFileName("my.lidarsensor.json");` Documentation: reference/sensor-files.md.
 *
 * @sa vtkAvianLidarBeamSource
 */
#ifndef vtkAvianLidarSensorReader_h
#define vtkAvianLidarSensorReader_h

#include "vtkAvianLidarBeamSource.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarSensorReader : public vtkAvianLidarBeamSource
{
public:
  static vtkAvianLidarSensorReader* New();
  vtkTypeMacro(vtkAvianLidarSensorReader, vtkAvianLidarBeamSource);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Name of the file to read. After a change of the file, call Reload(). Default: null.
  void SetFileName(VTK_FILEPATH const char* fileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /// Read the file again.
  void Reload();

protected:
  vtkAvianLidarSensorReader();
  ~vtkAvianLidarSensorReader() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  char* FileName;

private:
  vtkAvianLidarSensorReader(const vtkAvianLidarSensorReader&) = delete;
  void operator=(const vtkAvianLidarSensorReader&) = delete;

  std::string Problem; ///< error text of the file; empty: no error
};

#endif
