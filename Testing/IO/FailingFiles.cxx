// SPDX-License-Identifier: BSD-3-Clause
// File system calls of a process that preloads this library. There are no hard links; a copy ends
// half-way if FAILING_COPY is set; and before a file gets a name that ends with RENAMED_TO, the
// command BEFORE_RENAME runs, once.
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <dlfcn.h>
#include <sys/sendfile.h>
#include <unistd.h>

namespace
{
template <typename Function>
Function* next(Function*, const char* name)
{
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// One byte gets there.
ssize_t fillDisk(int out)
{
  if (write(out, "x", 1) == 1)
  {
    errno = ENOSPC;
  }
  return -1;
}
}

extern "C" int link(const char*, const char*) noexcept
{
  errno = EPERM;
  return -1;
}

extern "C" ssize_t sendfile(int out, int in, off_t* offset, std::size_t count) noexcept
{
  return std::getenv("FAILING_COPY") ? fillDisk(out)
                                     : next(sendfile, "sendfile")(out, in, offset, count);
}

extern "C" ssize_t copy_file_range(
  int in, off64_t* from, int out, off64_t* to, std::size_t count, unsigned int flags)
{
  return std::getenv("FAILING_COPY")
    ? fillDisk(out)
    : next(copy_file_range, "copy_file_range")(in, from, out, to, count, flags);
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
