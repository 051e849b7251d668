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
/// Greatest number of writers of one file at the same time. The writer that ends last gives the
/// contents.
constexpr int MostParts = 16;
constexpr const char* Unwritten = "cannot be written to its end";

/// Opens and locks a part. Returns the descriptor, or -1 on failure or if another writer holds the
/// part.
int hold(const std::string& part, int flags, unsigned int mode)
{
  const int file =
    open(part.c_str(), flags | O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, mode & ALLPERMS);
  if (file < 0)
  {
    return -1;
  }
  // Some file systems do not have locks. On such file systems a newly made part counts as locked.
  const bool isLocked =
    flock(file, LOCK_EX | LOCK_NB) == 0 || ((flags & O_EXCL) && errno != EWOULDBLOCK);
  // Before the lock, another writer may have renamed or removed the part.
  struct stat locked = {}, named = {};
  if (isLocked && fstat(file, &locked) == 0 && lstat(part.c_str(), &named) == 0 &&
    locked.st_dev == named.st_dev && locked.st_ino == named.st_ino)
  {
    return file;
  }
  close(file);
  return -1;
}

/// Exchanges the names of two files. Returns false if the file system cannot exchange names.
bool exchangeNames(const std::string& one, const std::string& two)
{
  return renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, two.c_str(), RENAME_EXCHANGE) == 0;
}

/// Throws FormatError with the reason of the system if a call failed.
void requireDone(bool isDone, const char* problem)
{
  if (!isDone)
  {
    fail(problem, ": ", std::strerror(errno));
  }
}
}

OutputFile::OutputFile(const std::string& name)
  : Name(name)
{
  std::error_code ignored;
  // The target of a symbolic link is replaced, not the link.
  constexpr int mostLinks = 40;
  for (int i = 0; i < mostLinks && fs::is_symlink(this->Name, ignored); ++i)
  {
    const fs::path target = fs::read_symlink(this->Name, ignored);
    this->Name = (fs::path(this->Name).parent_path() / target).string();
  }
  struct stat old = {};
  failIf(stat(this->Name.c_str(), &old) == 0 && !S_ISREG(old.st_mode),
    "it exists and is not a regular file");
  this->Mode = old.st_mode;
  for (int i = 0; i < MostParts; ++i)
  {
    const std::string part = this->Name + ".avianpart" + std::to_string(i);
    const int abandoned = hold(part, 0, 0);
    if (abandoned >= 0) // the writer of the part was killed
    {
      std::remove(part.c_str());
      close(abandoned);
    }
    if (!this->File)
    {
      const int made =
        hold(part, O_CREAT | O_EXCL, this->Mode ? this->Mode | S_IWUSR : DEFFILEMODE);
      this->File = made < 0 ? nullptr : fdopen(made, "wb");
      this->Part = part;
    }
  }
  requireDone(this->File, "cannot be opened for writing");
}

OutputFile::~OutputFile()
{
  if (this->File)
  {
    std::remove(this->Part.c_str());
    std::fclose(this->File);
  }
}

void OutputFile::write(const void* bytes, std::size_t count)
{
  requireDone(count == 0 || std::fwrite(bytes, 1, count, this->File) == count, Unwritten);
}

void OutputFile::seek(std::uint64_t at)
{
  requireDone(fseeko(this->File, static_cast<off_t>(at), SEEK_SET) == 0, Unwritten);
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
  // The old file is kept under the name of the part.
  const bool isKept = exchangeNames(first.Part, first.Name);
  std::error_code ignored;
  const bool isNew = !isKept && !fs::exists(first.Name, ignored);
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
    if (isKept ? exchangeNames(first.Part, first.Name)
               : isNew && std::remove(first.Name.c_str()) == 0)
    {
      throw;
    }
    fail(error.what(), "; the old ", first.Name, " is replaced already");
  }
}

void OutputFile::finish()
{
  // Writing of buffered bytes may fail here or, on some file systems, when a descriptor is closed.
  requireDone(std::fflush(this->File) == 0 && close(dup(fileno(this->File))) == 0, Unwritten);
  if (this->Mode)
  {
    fchmod(fileno(this->File), this->Mode & ALLPERMS);
  }
}

void OutputFile::takeName()
{
  requireDone(std::rename(this->Part.c_str(), this->Name.c_str()) == 0, "cannot be given its name");
  std::fclose(this->File);
  this->File = nullptr;
}
}
