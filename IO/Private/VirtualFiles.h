// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VirtualFiles.h
 * @brief Files, compressed or not, through GDAL's virtual file system, and GDAL's errors as
 * texts.
 */
#ifndef AvianLidarVirtualFiles_h
#define AvianLidarVirtualFiles_h

#include <optional>
#include <string>

namespace avianlidar::scene
{
/// The name under which GDAL reads a file: "/vsigzip/..." for a name that ends in ".gz", else the
/// name itself.
std::string VirtualName(const std::string& file);

/// An option of GDAL for this thread, which has its old value again afterwards.
class GdalOption
{
public:
  GdalOption(const char* name, const char* value);
  ~GdalOption();
  GdalOption(const GdalOption&) = delete;
  GdalOption& operator=(const GdalOption&) = delete;

private:
  const char* Name;
  std::optional<std::string> Before;
};

/// While one lives, GDAL reads compressed files of this thread as they are now: it keeps no state
/// of them for the next opening, which it would find by the name alone, and writes no file beside
/// them.
class UncachedGdal
{
private:
  const GdalOption NoState{ "CPL_VSIL_GZIP_SAVE_INFO", "NO" };
  const GdalOption NoSizes{ "CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO" };
};

/// While an object exists, GDAL does not use the network in this thread, and PROJ in none. PROJ has
/// one switch for the process, which gets its old value back when the last object ends.
class OfflineGdal
{
public:
  OfflineGdal();
  ~OfflineGdal();
  OfflineGdal(const OfflineGdal&) = delete;
  OfflineGdal& operator=(const OfflineGdal&) = delete;

private:
  // No URL is the only one allowed.
  const GdalOption AllowedUrls{ "CPL_VSIL_CURL_ALLOWED_FILENAME", "none" };
};

/// While an object exists, GDAL's messages of this thread are kept instead of printed.
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
