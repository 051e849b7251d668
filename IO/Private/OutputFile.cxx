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
constexpr const char* Unopened = "cannot be opened for writing";
constexpr const char* Unwritten = "cannot be written to its end";

/// Opens and locks a part. Returns the descriptor, or -1 on failure or if another writer holds the
/// part.
int hold(const std::string& part, int flags, unsigned int mode)
{
  const int file = open(part.c_str(), flags | O_RDWR | O_CLOEXEC | O_NOFOLLOW, mode & ALLPERMS);
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
  struct stat old = {};
  requireDone(stat(name.c_str(), &old) == 0 || errno == ENOENT, Unopened);
  failIf(old.st_mode && !S_ISREG(old.st_mode), "it exists and is not a regular file");
  this->Mode = old.st_mode;
  while (fs::is_symlink(this->Name)) // the target of a link is replaced, not the link
  {
    this->Name = fs::path(this->Name).parent_path() / fs::read_symlink(this->Name);
  }
  this->Name = fs::weakly_canonical(fs::absolute(this->Name));
  constexpr int mostParts = 16; // greatest number of writers of one file at the same time
  for (int i = 0; i < mostParts; ++i)
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
  requireDone(this->File, Unopened);
}

OutputFile::~OutputFile()
{
  std::remove(this->Part.c_str());
  std::fclose(this->File);
}

void OutputFile::write(const void* bytes, std::size_t count)
{
  requireDone(count == 0 || std::fwrite(bytes, 1, count, this->File) == count, Unwritten);
}

void OutputFile::seek(std::uint64_t at)
{
  requireDone(fseeko(this->File, static_cast<off_t>(at), SEEK_SET) == 0, Unwritten);
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
  const auto exchange = [&]
  {
    return renameat2(AT_FDCWD, first.Part.c_str(), AT_FDCWD, first.Name.c_str(), RENAME_EXCHANGE) ==
      0;
  };
  const bool isKept = exchange(); // whether the part is now the old file
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
    const bool isUndone = isKept ? exchange() : !first.Mode && std::remove(first.Name.c_str()) == 0;
    failIf(!isUndone, error.what(), "; the old ", first.Name, " is replaced already");
    throw;
  }
}

/// Writes the contents of the part to the disk.
void OutputFile::finish()
{
  requireDone(std::fflush(this->File) == 0 && fsync(fileno(this->File)) == 0, Unwritten);
  if (this->Mode)
  {
    fchmod(fileno(this->File), this->Mode & ALLPERMS);
  }
}

/// Renames the part and writes the names of the folder to the disk.
void OutputFile::takeName()
{
  requireDone(std::rename(this->Part.c_str(), this->Name.c_str()) == 0, "cannot be given its name");
  this->Part.clear();
  const int folder = open(fs::path(this->Name).parent_path().c_str(), O_RDONLY | O_CLOEXEC);
  fsync(folder);
  close(folder);
}
}
