// SPDX-License-Identifier: BSD-3-Clause
#include "VirtualFiles.h"

#include <vtksys/SystemTools.hxx>

#include <cpl_error.h>

namespace avianlidar::scene
{
namespace
{
bool IsCompressed(const std::string& file)
{
  return vtksys::SystemTools::StringEndsWith(vtksys::SystemTools::LowerCase(file), ".gz");
}

// Without the place in GDAL's own sources.
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
  return IsCompressed(file) ? "/vsigzip/" + file : file;
}

std::string UncompressedName(const std::string& file)
{
  return IsCompressed(file) ? file.substr(0, file.size() - 3) : file;
}

QuietGdal::QuietGdal()
{
  CPLPushErrorHandlerEx(&Keep, &this->LastError);
}

QuietGdal::~QuietGdal()
{
  CPLPopErrorHandler();
}

bool QuietGdal::Failed() const
{
  return !this->LastError.empty();
}

std::string QuietGdal::Reason() const
{
  return this->LastError.empty() ? std::string() : ": " + this->LastError;
}
}
