// SPDX-License-Identifier: BSD-3-Clause
#include "AvailableMemory.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace avianlidar
{
namespace
{
constexpr double Kilobyte = 1024.0;
constexpr double Unlimited = std::numeric_limits<double>::infinity();
// Least request that is checked, bytes.
constexpr double LeastToLookAt = 64e6;

/// Number after a word of a file ("MemAvailable:"), in the file's unit; `otherwise` if the word is
/// missing.
double numberBehind(const std::string& file, const std::string& word, double otherwise)
{
  std::ifstream stream(file);
  std::string line;
  while (std::getline(stream, line))
  {
    std::istringstream words(line);
    std::string first;
    double number = 0.0;
    if (words >> first && first == word && words >> number)
    {
      return number;
    }
  }
  return otherwise;
}

/// The only number of a file, or `otherwise` if there is no file or no number ("max").
double numberIn(const std::string& file, double otherwise)
{
  std::ifstream stream(file);
  double number = 0.0;
  return stream >> number ? number : otherwise;
}

/// Bytes that one control group leaves free.
double leftByGroup(const std::string& folder, const char* limit, const char* usage)
{
  const double cached = numberBehind(folder + "/memory.stat", "inactive_file", 0.0) +
    numberBehind(folder + "/memory.stat", "active_file", 0.0);
  const double used = numberIn(folder + "/" + usage, 0.0);
  return numberIn(folder + "/" + limit, Unlimited) - std::max(0.0, used - cached);
}

/// Least number of bytes that the group at `path` or a group above it leaves free.
double leftByGroups(
  const std::string& mount, std::string path, const char* limit, const char* usage)
{
  double left = Unlimited;
  for (;;)
  {
    left = std::min(left, leftByGroup(mount + path, limit, usage));
    if (path.empty())
    {
      return left;
    }
    path.resize(path.rfind('/') == std::string::npos ? 0 : path.rfind('/'));
  }
}

/// Bytes that control groups leave free. Lines of /proc/self/cgroup are "0::/path" (version 2) and
/// "4:memory:/path" (version 1).
double leftByControlGroups(const std::string& root)
{
  double left = Unlimited;
  std::ifstream groups(root + "/proc/self/cgroup");
  std::string line;
  while (std::getline(groups, line))
  {
    const std::size_t kind = line.find(':');
    const std::size_t path = line.find(':', kind + 1);
    if (kind == std::string::npos || path == std::string::npos)
    {
      continue;
    }
    const std::string controllers = line.substr(kind + 1, path - kind - 1);
    if (controllers.empty())
    {
      left = std::min(left,
        leftByGroups(
          root + "/sys/fs/cgroup", line.substr(path + 1), "memory.max", "memory.current"));
    }
    else if (controllers.find("memory") != std::string::npos)
    {
      left = std::min(left,
        leftByGroups(root + "/sys/fs/cgroup/memory", line.substr(path + 1), "memory.limit_in_bytes",
          "memory.usage_in_bytes"));
    }
  }
  return left;
}

/// 100000000 as "100,000,000", or as "1.2e+18" if a double cannot count so far.
std::string grouped(double count)
{
  char text[64];
  std::snprintf(text, sizeof text, count < 1e15 ? "%.0f" : "%.2g", count);
  std::string digits(text);
  for (std::size_t place = digits.size(); count < 1e15 && place > 3; place -= 3)
  {
    digits.insert(place - 3, ",");
  }
  return digits;
}

/// "12 GB", "0.4 GB", "1.2e+09 GB".
std::string gigabytes(double bytes)
{
  const double amount = std::max(0.0, bytes) / 1e9;
  char text[64];
  std::snprintf(
    text, sizeof text, amount < 10.0 ? "%.1f GB" : (amount < 1e6 ? "%.0f GB" : "%.2g GB"), amount);
  return text;
}

double addressLimit()
{
#ifdef __linux__
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
  {
    return static_cast<double>(limit.rlim_cur);
  }
#endif
  return Unlimited;
}

double leftByAddressLimit(const std::string& root, double limit)
{
  return limit == Unlimited
    ? Unlimited
    : limit - Kilobyte * numberBehind(root + "/proc/self/status", "VmSize:", 0.0);
}
}

double availableMemory(const std::string& root, double addressLimit)
{
  const double free = Kilobyte * numberBehind(root + "/proc/meminfo", "MemAvailable:", Unlimited);
  return std::max(
    0.0, std::min({ leftByAddressLimit(root, addressLimit), free, leftByControlGroups(root) }));
}

double availableAddresses()
{
  return std::max(0.0, leftByAddressLimit("", addressLimit()));
}

double availableMemory()
{
  return availableMemory("", addressLimit());
}

void requireMemory(double count, const std::string& what, double bytes)
{
  if (bytes < LeastToLookAt)
  {
    return;
  }
  const double available = availableMemory();
  if (bytes > available)
  {
    throw MemoryError(grouped(count) + " " + what + " need about " + gigabytes(bytes) + ", " +
      gigabytes(available) + " are available");
  }
}
}
