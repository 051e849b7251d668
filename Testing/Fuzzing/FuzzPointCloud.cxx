// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target: the first byte says which format of cloudFormats() the others are of (L, P, Y,
// K, or any number); the last fifth of a KITTI scan is taken for labels. Reading ends with a cloud
// whose arrays fit its points or with an error that says something.
#include "ByteSource.h"
#include "LasFormat.h"
#include "ReadCloud.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <set>
#include <string>
#include <vector>

namespace
{
using namespace avianlidar::formats;

[[noreturn]] void fail(const char* what)
{
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

class MemorySource : public avianlidar::ByteSource
{
public:
  MemorySource(const std::uint8_t* data, std::uint64_t size)
    : Data(data)
    , Size(size)
  {
  }
  std::uint64_t size() const override { return this->Size; }
  void read(std::uint64_t offset, std::uint64_t count, unsigned char* into) override
  {
    if (!this->holds(offset, count))
    {
      throw FormatError("the file ends before its data do");
    }
    std::copy_n(this->Data + offset, count, into);
  }

private:
  const std::uint8_t* Data;
  std::uint64_t Size;
};

/// A LAZ file of a few bytes may say that it has any number of points: those are not looked at.
bool hasTooMany(const std::uint8_t* data, std::size_t size)
{
  constexpr double most = 1e7; // bytes
  if (size < 255 || (data[104] & 0xC0) == 0)
  {
    return false;
  }
  // From LAS 1.4 on.
  const double many = data[25] >= 4 ? static_cast<double>(load<std::uint64_t>(data + 247)) : 0.0;
  const double points = std::max<double>(load<std::uint32_t>(data + 107), many);
  return points * load<std::uint16_t>(data + 105) > most;
}

Cloud read(const CloudFormat& format, const std::uint8_t* data, std::size_t size)
{
  const avianlidar::KeepGoing keepGoing = [](double progress)
  {
    if (!(progress >= 0.0 && progress <= 1.0))
    {
      fail("a progress outside 0 to 1");
    }
    return true;
  };
  const std::size_t first = format.hasLabels ? size / 5 * 4 : size;
  MemorySource points(data, first);
  MemorySource labels(data + first, size - first);
  return format.read(points, format.hasLabels ? &labels : nullptr, keepGoing);
}

void check(const Cloud& cloud, bool finite)
{
  std::set<std::string> names;
  for (const Column& column : cloud.columns)
  {
    if (column.components < 1 || sizeOf(column.values) != cloud.size() * column.components)
    {
      fail("an array that does not fit the points");
    }
    if (column.name.empty() || !names.insert(column.name).second)
    {
      fail("an array without a name of its own");
    }
  }
  for (std::size_t i = 0; finite && i < cloud.points.size(); ++i)
  {
    if (!std::isfinite(cloud.points[i]))
    {
      fail("an empty cell that was not left out");
    }
  }
  for (const Note& note : cloud.notes)
  {
    if (note.numbers.empty() && note.texts.empty())
    {
      fail("a note that says nothing");
    }
  }
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  if (size == 0 || (data[0] == 'L' && hasTooMany(data + 1, size - 1)))
  {
    return 0;
  }
  const std::vector<CloudFormat>& formats = cloudFormats();
  const std::size_t letter = std::string("LPYKV").find(static_cast<char>(data[0]));
  const std::size_t number = (letter < formats.size() ? letter : data[0]) % formats.size();
  try
  {
    Cloud cloud = read(formats[number], data + 1, size - 1);
    harmonise(cloud);
    const std::string& ending = formats[number].endings[0];
    check(cloud, ending != ".las" && ending != ".bin");
  }
  catch (const std::exception& error)
  {
    if (std::string(error.what()).empty())
    {
      fail("an error that says nothing");
    }
  }
  return 0;
}
