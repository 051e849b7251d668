// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VirtualFiles.h
 * @brief Lets GDAL read compressed files, without the network, and keeps GDAL's errors and
 * reference systems as text.
 */
#ifndef AvianLidarVirtualFiles_h
#define AvianLidarVirtualFiles_h

#include <cpl_conv.h>
#include <cpl_error.h>
#include <ogr_spatialref.h>

#include <string>

namespace avianlidar
{
/// Returns the name under which GDAL reads a file: "/vsigzip/..." for a name that ends in ".gz",
/// else the name itself. Throws Error if a compressed file holds too much (UnpackedSize.h).
std::string VirtualName(const std::string& file);

/// Returns a system as WKT, or an empty text if GDAL cannot write it with these options.
std::string WktOf(
  const OGRSpatialReference& system, const char* format, const char* option = nullptr);

/// While an object exists, GDAL does not use the network in this thread, and PROJ does not use the
/// network in any thread. PROJ has one switch for the whole process. This switch is set back when
/// the last object ends. GDAL does not keep the state of a compressed file, because GDAL would use
/// this state for a later file of the same name. GDAL does not write a file beside a compressed
/// file.
class OfflineGdal
{
public:
  OfflineGdal();
  ~OfflineGdal();
  OfflineGdal(const OfflineGdal&) = delete;
  OfflineGdal& operator=(const OfflineGdal&) = delete;

private:
  // The only allowed URL is "none", which does not exist.
  CPLConfigOptionSetter AllowedUrls{ "CPL_VSIL_CURL_ALLOWED_FILENAME", "none", false };
  CPLConfigOptionSetter NoState{ "CPL_VSIL_GZIP_SAVE_INFO", "NO", false };
  CPLConfigOptionSetter NoSizes{ "CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO", false };
};

/// While an object exists, GDAL does not print messages of this thread. The last error is kept.
class QuietGdal
{
public:
  QuietGdal();

  /// Returns whether GDAL reported an error. Warnings do not count.
  bool Failed() const { return !this->LastError.empty(); }
  /// Returns ": <last error>", or an empty text without an error.
  std::string Reason() const { return this->Failed() ? ": " + this->LastError : std::string(); }

private:
  std::string LastError;
  CPLErrorHandlerPusher Pusher;
};
}

#endif
