// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "CloudData.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace avianlidar::formats
{
namespace fs = std::filesystem;

OutputFile::OutputFile(const std::string& name)
  : Name(name)
{
  std::error_code ignored;
  // What a link leads to is written, not the link itself.
  constexpr int mostLinks = 40;
  for (int i = 0; i < mostLinks && fs::is_symlink(this->Name, ignored); ++i)
  {
    const fs::path target = fs::read_symlink(this->Name, ignored);
    this->Name = (fs::path(this->Name).parent_path() / target).string();
  }
  const fs::file_status status = fs::status(this->Name, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
  {
    throw FormatError("it is there and no ordinary file");
  }
  // 'x': never somebody else's file.
  constexpr int attempts = 1000;
  for (int i = 0; i < attempts && !this->File; ++i)
  {
    this->Temporary = this->Name + ".part" + std::to_string(i);
    errno = 0;
    this->File = std::fopen(this->Temporary.c_str(), "wbx");
    if (!this->File && errno != EEXIST)
    {
      break;
    }
  }
  if (!this->File)
  {
    this->fail("cannot be opened for writing");
  }
}

OutputFile::~OutputFile()
{
  if (this->File)
  {
    std::fclose(this->File);
    std::remove(this->Temporary.c_str());
  }
}

void OutputFile::fail(const std::string& what) const
{
  throw FormatError(what + (errno ? std::string(": ") + std::strerror(errno) : std::string()));
}

void OutputFile::write(const void* bytes, std::size_t count)
{
  errno = 0;
  if (count > 0 && std::fwrite(bytes, 1, count, this->File) != count)
  {
    this->fail("cannot be written to its end");
  }
}

void OutputFile::commit()
{
  errno = 0;
  std::FILE* file = this->File;
  this->File = nullptr;
  // What was buffered may fail only now.
  if (std::fclose(file) != 0)
  {
    const int reason = errno;
    std::remove(this->Temporary.c_str());
    errno = reason;
    this->fail("cannot be written to its end");
  }
  if (std::rename(this->Temporary.c_str(), this->Name.c_str()) != 0)
  {
    const int reason = errno;
    std::remove(this->Temporary.c_str());
    errno = reason;
    this->fail("cannot be given its name");
  }
}
}
