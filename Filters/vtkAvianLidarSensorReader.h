// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarSensorReader
 * @brief The sensor of a file (`.lidarsensor.json`): the beam source with the file's values.
 *
 * Outputs and field data are the beam source's. The file is read when FileName is set: what it does
 * not name gets the default of the beam source, but Position, Orientation, NumberOfRevolutions,
 * StepsPerRevolution and MotionSeed stay as they are. Properties that are set later count until
 * the file is read again.
 *
 * **Errors** name the file, the key and what was expected: no file name, not there, no sensor, a
 * value out of its range. Outputs are empty then.
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
  /**
   * The file to read. Default: none, which is an error. A change of the file on disk is not
   * noticed: call Reload().
   */
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
