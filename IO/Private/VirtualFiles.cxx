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

void CPL_STDCALL Keep(CPLErr severity, CPLErrorNum, const char* message)
{
  if (severity >= CE_Failure)
  {
    *static_cast<std::string*>(CPLGetErrorHandlerUserData()) = message;
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
