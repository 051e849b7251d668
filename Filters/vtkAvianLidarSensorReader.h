// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSensorReader
 * @brief The sensor of a file (`.lidarsensor.json`): the beam source with the file's values.
 *
 * Outputs are those of vtkAvianLidarBeamSource. The file is read when FileName is set; what it does
 * not name gets its default, but Position, Orientation, NumberOfRevolutions, StepsPerRevolution and
 * MotionSeed stay. Properties that are set later count until the file is read again.
 *
 * Errors name the file, the key and what was expected, with empty outputs.
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
  /** The file to read. Changes on disk are noticed by Reload() only. Default: none. */
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

  std::string Problem; ///< what is wrong with the file
};

#endif
