// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VirtualFiles.h
 * @brief Files, compressed or not, through GDAL's virtual file system, and GDAL's errors as
 * texts.
 */
#ifndef AvianLidarVirtualFiles_h
#define AvianLidarVirtualFiles_h

#include <cpl_conv.h>
#include <cpl_error.h>

#include <string>

namespace avianlidar::scene
{
/// The name under which GDAL reads a file: "/vsigzip/..." for a name that ends in ".gz", else the
/// name itself.
std::string VirtualName(const std::string& file);

/// While an object exists, GDAL does not use the network in this thread, and PROJ in none; PROJ has
/// one switch for the process, which gets its old value back when the last object ends. GDAL reads
/// compressed files as they are now: it keeps no state of them for the next opening, which it would
/// find by the name alone, and writes no file beside them.
class OfflineGdal
{
public:
  OfflineGdal();
  ~OfflineGdal();
  OfflineGdal(const OfflineGdal&) = delete;
  OfflineGdal& operator=(const OfflineGdal&) = delete;

private:
  // No URL is the only one allowed.
  CPLConfigOptionSetter AllowedUrls{ "CPL_VSIL_CURL_ALLOWED_FILENAME", "none", false };
  CPLConfigOptionSetter NoState{ "CPL_VSIL_GZIP_SAVE_INFO", "NO", false };
  CPLConfigOptionSetter NoSizes{ "CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO", false };
};

/// While an object exists, GDAL's messages of this thread are kept instead of printed.
class QuietGdal
{
public:
  QuietGdal();

  /// Whether GDAL reported an error, warnings aside.
  bool Failed() const { return !this->LastError.empty(); }
  /// ": <the last error>", or nothing.
  std::string Reason() const { return this->Failed() ? ": " + this->LastError : std::string(); }

private:
  std::string LastError;
  CPLErrorHandlerPusher Pusher;
};
}

#endif
