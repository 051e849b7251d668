// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScanStream.h
 * @brief When and where the clouds of a stream were scanned, for filters that remember. Not
 * installed.
 *
 * The time of a cloud, s: `DATA_TIME_STEP` of its information, else field data `TimeValue`, else
 * the start of its `revolution`, else the time before + 1 if it is another cloud or was made anew.
 * Steps of a revolution that sweeps (`steps_per_revolution` above 1) are one scan: their time is
 * the start of their revolution.
 */
#ifndef vtkAvianLidarScanStream_h
#define vtkAvianLidarScanStream_h

#include "vtkType.h"

#include <string>

class vtkDataObject;

class vtkAvianLidarScanStream
{
public:
  /// Read the time of a cloud; nothing is remembered yet. @return what is wrong, or nothing
  std::string ReadTime(vtkDataObject* cloud, double& time) const;

  /// The cloud, whose time was read, is the last one now.
  void Accept(vtkDataObject* cloud, double time);

  bool Begun() const { return this->Has; }
  double Time() const { return this->Last; } ///< time of the last cloud

  /// Where the sensor was: field data `position` if there is, else `position` stays.
  /// @return what is wrong, or nothing
  static std::string ReadPosition(vtkDataObject* cloud, double position[3]);

private:
  static vtkMTimeType Made(vtkDataObject* cloud);

  bool Has = false;
  double Last = 0.0;
  const void* Cloud = nullptr; ///< compared only
  vtkMTimeType MadeAt = 0;
};

#endif
