// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "CloudData.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace avianlidar::formats
{
namespace fs = std::filesystem;

namespace
{
/// So many may write one file at the same time: the last that ends gives it its content.
constexpr int MostParts = 16;

std::string partOf(const std::string& name, int number)
{
  return name + ".avianpart" + std::to_string(number);
}

bool isStillCalled(std::FILE* file, const std::string& name)
{
  struct stat open = {}, named = {};
  return fstat(fileno(file), &open) == 0 && lstat(name.c_str(), &named) == 0 &&
    open.st_dev == named.st_dev && open.st_ino == named.st_ino;
}

bool lock(std::FILE* file)
{
  return flock(fileno(file), LOCK_EX | LOCK_NB) == 0;
}

/// Removes a part whose writer was killed: nobody holds its lock.
void removeAbandoned(const std::string& part)
{
  std::error_code ignored;
  if (!fs::is_regular_file(fs::symlink_status(part, ignored)))
  {
    return;
  }
  std::FILE* file = std::fopen(part.c_str(), "r+be");
  if (!file) // it may have the permissions of a file that is only read
  {
    file = std::fopen(part.c_str(), "rbe");
  }
  if (file)
  {
    if (lock(file) && isStillCalled(file, part))
    {
      std::remove(part.c_str());
    }
    std::fclose(file);
  }
}

/// Exchanges the names of two files; false where the file system cannot do so.
bool exchangeNames(const std::string& one, const std::string& two)
{
  return renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, two.c_str(), RENAME_EXCHANGE) == 0;
}
}

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
    throw FormatError("it exists and is not a regular file");
  }
  this->openPart();
  if (fs::exists(status))
  {
    fs::permissions(this->Part, status.permissions() & fs::perms::mask, ignored);
  }
}

OutputFile::~OutputFile()
{
  if (this->File)
  {
    std::remove(this->Part.c_str());
    std::fclose(this->File);
  }
}

void OutputFile::openPart()
{
  for (int i = 0; i < MostParts; ++i)
  {
    removeAbandoned(partOf(this->Name, i));
  }
  for (int i = 0; i < MostParts && !this->File; ++i)
  {
    this->Part = partOf(this->Name, i);
    errno = 0;
    // 'x': never somebody else's file.
    this->File = std::fopen(this->Part.c_str(), "wbxe");
    if (!this->File && errno != EEXIST)
    {
      break;
    }
    // Another writer may have taken it for abandoned. Some file systems have no locks.
    if (this->File &&
      ((!lock(this->File) && errno == EWOULDBLOCK) || !isStillCalled(this->File, this->Part)))
    {
      std::fclose(this->File);
      this->File = nullptr;
    }
  }
  if (!this->File)
  {
    this->fail("cannot be opened for writing");
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

void OutputFile::seek(std::uint64_t at)
{
  errno = 0;
  if (fseeko(this->File, static_cast<off_t>(at), SEEK_SET) != 0)
  {
    this->fail("cannot be written to its end");
  }
}

bool OutputFile::isSameAs(const OutputFile& other) const
{
  return fs::weakly_canonical(this->Name) == fs::weakly_canonical(other.Name);
}

void OutputFile::commit()
{
  this->finish();
  this->takeName();
}

void OutputFile::commitBoth(OutputFile& first, OutputFile& second)
{
  first.finish();
  second.finish();
  std::error_code ignored;
  const bool replaces = fs::exists(first.Name, ignored);
  // The old file is kept under the name of the part.
  const bool isKept = replaces && exchangeNames(first.Part, first.Name);
  if (!isKept)
  {
    first.takeName();
  }
  try
  {
    second.takeName();
  }
  catch (const FormatError& error)
  {
    if (!replaces)
    {
      fs::remove(first.Name, ignored);
    }
    else if (!isKept || !exchangeNames(first.Part, first.Name))
    {
      throw FormatError(error.what() + ("; the old " + first.Name + " is replaced already"));
    }
    throw;
  }
}

void OutputFile::finish()
{
  errno = 0;
  // What was buffered may fail only now, and on some file systems when a descriptor is closed.
  if (std::fflush(this->File) != 0 || close(dup(fileno(this->File))) != 0)
  {
    this->fail("cannot be written to its end");
  }
}

void OutputFile::takeName()
{
  errno = 0;
  if (std::rename(this->Part.c_str(), this->Name.c_str()) != 0)
  {
    this->fail("cannot be given its name");
  }
  std::fclose(this->File);
  this->File = nullptr;
}
}
