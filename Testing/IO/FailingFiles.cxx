// SPDX-License-Identifier: BSD-3-Clause
// File system calls of a process that preloads this library: before a file gets a name that ends
// with RENAMED_TO, the command BEFORE_RENAME runs, once; where it fails, so does the renaming.
// Names cannot be exchanged if NO_EXCHANGE is set. Files cannot be synchronized if NO_SYNC is set.
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <dlfcn.h>
#include <unistd.h>

namespace
{
template <typename Function>
Function* next(Function*, const char* name)
{
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
}

extern "C" int fsync(int file)
{
  if (std::getenv("NO_SYNC"))
  {
    errno = EIO;
    return -1;
  }
  return next(fsync, "fsync")(file);
}

extern "C" int renameat2(
  int fromFolder, const char* from, int toFolder, const char* to, unsigned int flags) noexcept
{
  if (std::getenv("NO_EXCHANGE"))
  {
    errno = EINVAL;
    return -1;
  }
  return next(renameat2, "renameat2")(fromFolder, from, toFolder, to, flags);
}

extern "C" int rename(const char* from, const char* to) noexcept
{
  const char* const end = std::getenv("RENAMED_TO");
  const char* const command = std::getenv("BEFORE_RENAME");
  const std::string name = to;
  const std::string wanted = end ? end : "";
  if (command && name.size() >= wanted.size() &&
    name.compare(name.size() - wanted.size(), wanted.size(), wanted) == 0)
  {
    const std::string once = command;
    unsetenv("BEFORE_RENAME");
    if (std::system(once.c_str()) != 0)
    {
      errno = EIO;
      return -1;
    }
  }
  return next(rename, "rename")(from, to);
}
