// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "CloudData.h"

#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

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

/// The name of a file that is being replaced, until its partner is replaced, too.
std::string keptOf(const std::string& name, int number)
{
  return partOf(name, number) + "-old";
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

/// Removes a part, or a kept file, whose writer was killed: nobody holds its lock.
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

/// A second name, never one that is there, or a copy where the file system has no links.
std::error_code linkOrCopy(const std::string& name, const std::string& second)
{
  std::error_code problem;
  fs::create_hard_link(name, second, problem);
  if (problem && problem != std::errc::file_exists)
  {
    fs::copy_file(name, second, problem);
    if (problem && problem != std::errc::file_exists)
    {
      std::error_code ignored;
      fs::remove(second, ignored); // half a copy
    }
  }
  return problem;
}

/// A file that is about to be replaced, kept under another name as long as one lives. It is locked,
/// or other writers would take it for what a killed one left.
class KeptFile
{
public:
  KeptFile() = default;
  ~KeptFile()
  {
    if (!this->Kept.empty())
    {
      std::remove(this->Kept.c_str());
    }
    this->unlock();
  }
  KeptFile(const KeptFile&) = delete;
  KeptFile& operator=(const KeptFile&) = delete;

  /// Keeps that file; false, with errno, if it cannot be kept.
  bool keep(const std::string& name)
  {
    std::error_code problem = std::make_error_code(std::errc::file_exists);
    for (int i = 0; i < MostParts && problem == std::errc::file_exists; ++i)
    {
      const std::string kept = keptOf(name, i);
      problem = linkOrCopy(name, kept);
      if (!problem)
      {
        this->Kept = kept;
        if (this->lockKept())
        {
          return true;
        }
        this->Kept.clear();
        problem = std::make_error_code(std::errc::file_exists);
      }
    }
    errno = problem.value();
    return false;
  }

  /// Gives the file its name again. Where that is not possible it stays, under the name that is
  /// returned.
  std::string giveBack(const std::string& name)
  {
    const std::string kept = std::exchange(this->Kept, std::string());
    return std::rename(kept.c_str(), name.c_str()) == 0 ? std::string() : kept;
  }

private:
  /// False if another writer took it for abandoned before it was locked.
  bool lockKept()
  {
    errno = 0;
    this->Lock = std::fopen(this->Kept.c_str(), "rbe");
    if (!this->Lock)
    {
      return errno != ENOENT; // nor can others open it
    }
    // Shared: two writers may keep the same file. Some file systems have no locks.
    flock(fileno(this->Lock), LOCK_SH | LOCK_NB);
    if (isStillCalled(this->Lock, this->Kept))
    {
      return true;
    }
    this->unlock();
    return false;
  }

  void unlock()
  {
    if (this->Lock)
    {
      std::fclose(this->Lock);
      this->Lock = nullptr;
    }
  }

  std::string Kept;
  std::FILE* Lock = nullptr;
};
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
    fs::permissions(this->Part, status.permissions() & fs::perms::mask, ignored);
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
    removeAbandoned(keptOf(this->Name, i));
  }
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
  KeptFile kept;
  if (replaces && !kept.keep(first.Name))
  {
    first.fail("the old " + first.Name + " cannot be kept while it is replaced");
  }
  first.takeName();
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
    else if (const std::string left = kept.giveBack(first.Name); !left.empty())
    {
      throw FormatError(error.what() + ("; the old " + first.Name + " is now " + left));
    }
    throw;
  }
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
