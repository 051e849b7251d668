// SPDX-License-Identifier: BSD-3-Clause
#include "VirtualFiles.h"

#include "FileNames.h"
#include "UnpackedSize.h"

#include <cpl_http.h>
#include <cpl_vsi.h>
#include <ogr_srs_api.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace avianlidar
{
namespace
{
// Returns a message without the file and line of GDAL's source code.
std::string WithoutPlace(const std::string& message)
{
  const std::string line = ", at line ";
  const std::size_t number = message.find(line);
  const std::size_t end =
    number == std::string::npos ? number : message.find(", ", number + line.size());
  return end == std::string::npos || message.compare(0, 8, "In file ") != 0
    ? message
    : message.substr(end + 2);
}

// The objects of all threads are counted, because PROJ has one switch for the process.
std::mutex ProjMutex;
int ProjUsers = 0;
int ProjNetworkBefore = FALSE;

CPLHTTPResult* Refuse(
  const char* url, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc, void*, void*)
{
  constexpr const char* reason = "%s is not fetched: scenes are read only from files";
  CPLError(CE_Failure, CPLE_AppDefined, reason, url);
  // Without a result GDAL would fetch the URL.
  auto* result = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  result->nStatus = 1;
  result->pszErrBuf = CPLStrdup(CPLSPrintf(reason, url));
  return result;
}

void CPL_STDCALL Keep(CPLErr severity, CPLErrorNum, const char* message)
{
  if (severity >= CE_Failure)
  {
    *static_cast<std::string*>(CPLGetErrorHandlerUserData()) = WithoutPlace(message);
  }
}
}

std::string VirtualName(const std::string& file)
{
  if (EndingOf(file) != ".gz")
  {
    return file;
  }
  const std::string name = "/vsigzip/" + file;
  VSIStatBufL packed;
  VSILFILE* stream = VSIStatL(file.c_str(), &packed) == 0 ? VSIFOpenL(name.c_str(), "rb") : nullptr;
  if (stream)
  {
    const std::unique_ptr<VSILFILE, int (*)(VSILFILE*)> closing(stream, &VSIFCloseL);
    std::vector<char> chunk(1u << 20);
    std::uint64_t unpacked = 0;
    for (std::size_t got = chunk.size(); got == chunk.size(); unpacked += got)
    {
      CheckUnpacked(unpacked, static_cast<std::uint64_t>(packed.st_size));
      got = VSIFReadL(chunk.data(), 1, chunk.size(), stream);
    }
    CheckUnpacked(unpacked, static_cast<std::uint64_t>(packed.st_size));
  }
  return name;
}

std::string WktOf(const OGRSpatialReference& system, const char* format, const char* option)
{
  const char* const options[] = { format, option, nullptr };
  char* text = nullptr;
  const bool isDone = system.exportToWkt(&text, options) == OGRERR_NONE && text;
  const std::string wkt = isDone ? text : "";
  CPLFree(text);
  return wkt;
}

OfflineGdal::OfflineGdal()
{
  const std::lock_guard<std::mutex> lock(ProjMutex);
  if (ProjUsers++ == 0)
  {
    ProjNetworkBefore = OSRGetPROJEnableNetwork();
    OSRSetPROJEnableNetwork(FALSE);
  }
  CPLHTTPPushFetchCallback(&Refuse, nullptr);
}

OfflineGdal::~OfflineGdal()
{
  CPLHTTPPopFetchCallback();
  const std::lock_guard<std::mutex> lock(ProjMutex);
  if (--ProjUsers == 0)
  {
    OSRSetPROJEnableNetwork(ProjNetworkBefore);
  }
}

QuietGdal::QuietGdal()
  : Pusher(&Keep, &this->LastError)
{
}
}
