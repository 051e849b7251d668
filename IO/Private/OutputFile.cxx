// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "CloudData.h"

#include <sys/file.h>
#include <sys/stat.h>

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

/// What a file that is being replaced is called until its partner is replaced, too.
std::string keptOf(const std::string& name)
{
  return name + ".avianpart-old";
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
  if (std::FILE* file = std::fopen(part.c_str(), "r+be"))
  {
    if (lock(file) && isStillCalled(file, part))
    {
      std::remove(part.c_str());
    }
    std::fclose(file);
  }
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
    throw FormatError("it is there and no ordinary file");
  }
  this->openPart();
  if (fs::exists(status))
  {
    fs::permissions(this->Part, status.permissions() & fs::perms::all, ignored);
  }
}

OutputFile::~OutputFile()
{
  if (this->File)
  {
    std::fclose(this->File);
  }
  if (this->Lock)
  {
    std::remove(this->Part.c_str());
    std::fclose(this->Lock);
  }
}

void OutputFile::openPart()
{
  for (int i = 0; i < MostParts; ++i)
  {
    removeAbandoned(partOf(this->Name, i));
  }
  removeAbandoned(keptOf(this->Name));
  for (int i = 0; i < MostParts && !this->Lock; ++i)
  {
    this->Part = partOf(this->Name, i);
    errno = 0;
    // 'x': never somebody else's file.
    this->Lock = std::fopen(this->Part.c_str(), "wbxe");
    if (!this->Lock && errno != EEXIST)
    {
      break;
    }
    // Another writer may have taken it for abandoned. Some file systems have no locks.
    if (this->Lock &&
      ((!lock(this->Lock) && errno == EWOULDBLOCK) || !isStillCalled(this->Lock, this->Part)))
    {
      std::fclose(this->Lock);
      this->Lock = nullptr;
    }
  }
  this->File = this->Lock ? std::fopen(this->Part.c_str(), "r+be") : nullptr;
  if (!this->File)
  {
    const int reason = errno;
    if (this->Lock)
    {
      std::remove(this->Part.c_str());
      std::fclose(this->Lock);
      this->Lock = nullptr;
    }
    errno = reason;
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
  const std::string kept = keptOf(first.Name);
  std::error_code problem;
  const bool replaces = fs::exists(first.Name, problem);
  if (replaces)
  {
    fs::create_hard_link(first.Name, kept, problem);
    if (problem) // not every file system has them
    {
      fs::copy_file(first.Name, kept);
    }
  }
  bool begun = false;
  try
  {
    first.takeName();
    begun = true;
    second.takeName();
  }
  catch (const FormatError&)
  {
    if (replaces)
    {
      fs::rename(kept, first.Name, problem);
    }
    else if (begun)
    {
      fs::remove(first.Name, problem);
    }
    throw;
  }
  fs::remove(kept, problem);
}

void OutputFile::finish()
{
  errno = 0;
  std::FILE* file = this->File;
  this->File = nullptr;
  // What was buffered may fail only now.
  if (std::fclose(file) != 0)
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
  std::fclose(this->Lock);
  this->Lock = nullptr;
}
}
