// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VirtualFiles.h
 * @brief Files, compressed or not, through GDAL's virtual file system, and GDAL's complaints as
 * texts.
 */
#ifndef AvianLidarVirtualFiles_h
#define AvianLidarVirtualFiles_h

#include <string>

namespace avianlidar::scene
{
/// The name under which GDAL reads a file: "/vsigzip/..." for a name that ends in ".gz", else the
/// name itself.
std::string VirtualName(const std::string& file);

/// The name without ".gz": it tells the format.
std::string UncompressedName(const std::string& file);

/// While one lives, GDAL and PROJ ask nobody over the network in this thread.
class OfflineGdal
{
public:
  OfflineGdal();
  ~OfflineGdal();
  OfflineGdal(const OfflineGdal&) = delete;
  OfflineGdal& operator=(const OfflineGdal&) = delete;

private:
  int ProjNetwork;
};

/// While one lives, GDAL's messages of this thread are kept instead of printed.
class QuietGdal
{
public:
  QuietGdal();
  ~QuietGdal();
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;

  /// Whether GDAL reported an error, warnings aside.
  bool Failed() const;
  /// ": <the last error>", or nothing.
  std::string Reason() const;

private:
  std::string LastError;
};
}

#endif
