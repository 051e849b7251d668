// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "FileError.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>

namespace avianlidar
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

/// Throws FileError with the reason of the system if a call failed.
void requireDone(bool isDone, const char* problem)
{
  if (!isDone)
  {
    fail(problem, ": ", std::strerror(errno));
  }
}

/// Writes the names of a file's folder to the disk, if the folder can be read.
void synchroniseFolderOf(const std::string& name)
{
  const int folder = open(fs::path(name).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0)
  {
    fsync(folder);
    close(folder);
  }
}
}

OutputFile::OutputFile(const std::string& name)
{
  struct stat old = {};
  requireDone(stat(name.c_str(), &old) == 0 || errno == ENOENT, Unopened);
  failIf(old.st_mode && !S_ISREG(old.st_mode), "it exists and is not a regular file");
  this->Mode = old.st_mode;
  std::error_code error;
  fs::path path = name;
  while (fs::is_symlink(path, error)) // the target of a link is replaced, not the link
  {
    path = path.parent_path() / fs::read_symlink(path, error);
  }
  failIf(!path.has_filename(), Unopened);
  const fs::path folder = fs::canonical(path.has_parent_path() ? path.parent_path() : ".", error);
  errno = error.value();
  requireDone(!error, Unopened);
  this->Name = folder / path.filename();
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
      if (made >= 0 && !this->File)
      {
        std::remove(part.c_str());
        close(made);
      }
    }
  }
  requireDone(this->File, Unopened);
}

OutputFile::~OutputFile()
{
  std::remove(this->Part.c_str());
  std::fclose(this->File);
  if (this->Old >= 0)
  {
    close(this->Old);
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

void OutputFile::commit()
{
  this->finish();
  this->takeName();
}

void OutputFile::commitBoth(OutputFile& first, OutputFile& second)
{
  first.finish();
  second.finish();
  // Another writer would remove the old file under the name of the part if it were not locked.
  first.Old = open(first.Name.c_str(), O_RDONLY | O_CLOEXEC);
  const bool isNew = first.Old < 0 && errno == ENOENT;
  if (first.Old >= 0)
  {
    flock(first.Old, LOCK_EX | LOCK_NB);
  }
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
  catch (const std::exception& error)
  {
    const bool isUndone = isKept ? exchange() : isNew && std::remove(first.Name.c_str()) == 0;
    failIf(!isUndone, error.what(), "; the old ", first.Name, " is replaced already");
    throw;
  }
  if (isKept && fs::path(first.Name).parent_path() != fs::path(second.Name).parent_path())
  {
    synchroniseFolderOf(first.Name);
  }
}

/// Writes the contents of the part to the disk.
void OutputFile::finish()
{
  requireDone(std::fflush(this->File) == 0, Unwritten);
  if (this->Mode)
  {
    fchmod(fileno(this->File), this->Mode & ALLPERMS);
  }
  requireDone(fsync(fileno(this->File)) == 0, Unwritten);
}

/// Renames the part and writes the names of the folder to the disk.
void OutputFile::takeName()
{
  requireDone(std::rename(this->Part.c_str(), this->Name.c_str()) == 0, "cannot be given its name");
  this->Part.clear();
  synchroniseFolderOf(this->Name);
}
}
