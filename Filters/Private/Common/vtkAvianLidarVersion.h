// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarVersion.h
 * @brief Version of this library, as written into the field data of echoes. Not installed.
 */
#ifndef vtkAvianLidarVersion_h
#define vtkAvianLidarVersion_h

/// The version of the project, from CMakeLists.txt.
inline const char* vtkAvianLidarVersion()
{
  return AVIANLIDAR_VERSION;
}

#endif
