// SPDX-License-Identifier: BSD-3-Clause
// The operator new of a process that preloads this library: it fails where a test wants it to, as
// if memory had run out just there. Only what this project's library asks for fails, or else what
// the standard library's texts and streams ask for: VTK's own lists of pointers are not made for
// it. In place of a failure it may throw what others throw.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>

#include <dlfcn.h>

namespace
{
constexpr std::size_t Never = ~std::size_t{ 0 };

std::atomic<std::size_t> Least{ Never }; // bytes
std::atomic<std::size_t> Most{ Never };  // bytes
std::atomic<long> Seen{ 0 };             // allocations between these since the beginning
std::atomic<const char*> Library{ "" };  // whose allocations they are
std::atomic<long> Failing{ 0 };          // the number of the one that fails; 0: none; below 0:
                                         // all from that number on, then of any size
std::atomic<int> Thrown{ 0 };            // 0: std::bad_alloc, 1: another exception, 2: none of std

bool isMeant(void* caller)
{
  Dl_info from;
  return dladdr(caller, &from) != 0 && std::strstr(from.dli_fname, Library);
}

bool fails(std::size_t bytes, void* caller)
{
  if (Failing < 0 && Seen >= -Failing)
  {
    return isMeant(caller);
  }
  return bytes >= Least && bytes <= Most && isMeant(caller) && ++Seen == std::labs(Failing);
}

void* allocate(std::size_t bytes, std::size_t alignment, void* caller)
{
  if (!fails(bytes, caller))
  {
    const std::size_t units = (std::max<std::size_t>(bytes, 1) + alignment - 1) / alignment;
    if (void* place = std::aligned_alloc(alignment, units * alignment))
    {
      return place;
    }
  }
  if (Thrown == 1)
  {
    throw std::runtime_error("A planted error");
  }
  if (Thrown == 2)
  {
    throw 7;
  }
  throw std::bad_alloc();
}
}

extern "C"
{
  /// From now on the `which`-th allocation of `least` to `most` bytes fails; 0: they are counted;
  /// below 0: after the -`which`-th one, which fails, all fail, of any size. `texts`: those of
  /// texts and streams instead of this project's. `thrown`: what is thrown (see above).
  void failing_new_begin(long which, std::size_t least, std::size_t most, bool texts, int thrown)
  {
    Thrown = thrown;
    Library = texts ? "libstdc++" : "libvtkAvianLidar";
    Seen = 0;
    Failing = which;
    Most = most;
    Least = least;
  }

  /// No longer. @return allocations counted
  long failing_new_end()
  {
    Failing = 0;
    Least = Never;
    return Seen;
  }
}

// The forms that do not throw call these; what they return is free()d, as ever.
void* operator new(std::size_t bytes)
{
  return allocate(bytes, alignof(std::max_align_t), __builtin_return_address(0));
}

void* operator new[](std::size_t bytes)
{
  return allocate(bytes, alignof(std::max_align_t), __builtin_return_address(0));
}

void* operator new(std::size_t bytes, std::align_val_t alignment)
{
  return allocate(bytes, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
