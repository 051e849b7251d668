// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScanStream.h
 * @brief Finds when and where the clouds of a stream were scanned, for filters that keep results of
 * earlier clouds. Not installed.
 *
 * The time of a cloud, s: `DATA_TIME_STEP` of its information, else field data `TimeValue`, else
 * the start of its `revolution`, else the time of the last cloud, plus 1 s if the cloud is another
 * object or was made anew. The first cloud then has the time 0. The steps of a revolution
 * (`steps_per_revolution` above 1) are one scan, whose time is the start of the revolution.
 */
#ifndef vtkAvianLidarScanStream_h
#define vtkAvianLidarScanStream_h

#include "vtkType.h"

class vtkDataObject;

class vtkAvianLidarScanStream
{
public:
  /// Time of a cloud, s, which is not stored. Throws std::runtime_error.
  double TimeOf(vtkDataObject* cloud) const;

  /// Store the cloud and its time as the last cloud and time.
  void Accept(vtkDataObject* cloud, double time);

  bool Begun() const { return this->Has; }
  double Time() const { return this->Last; } ///< time of the last cloud

  /// Read the position of the sensor from field data `position`. Without this array, `position` is
  /// kept. Throws std::runtime_error.
  static void ReadPosition(vtkDataObject* cloud, double position[3]);

private:
  static vtkMTimeType Made(vtkDataObject* cloud);

  bool Has = false;
  double Last = 0.0;
  const void* Cloud = nullptr; ///< address of the last cloud, only for comparison
  vtkMTimeType MadeAt = 0;
};

#endif
