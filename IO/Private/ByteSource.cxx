// SPDX-License-Identifier: BSD-3-Clause
#include "ByteSource.h"

#include "CloudData.h"
#include "RegularFile.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace avianlidar::formats
{
namespace
{
[[noreturn]] void cutShort()
{
  throw FormatError("the file ends before its data do");
}
}

std::vector<unsigned char> ByteSource::bytes(std::uint64_t offset, std::uint64_t count)
{
  if (!this->holds(offset, count))
  {
    cutShort();
  }
  std::vector<unsigned char> copy(count);
  this->read(offset, count, copy.data());
  return copy;
}

const unsigned char* ByteSource::at(std::uint64_t offset, std::uint64_t count)
{
  constexpr std::uint64_t atOnce = 1 << 20;
  if (offset < this->PieceBegin || offset + count > this->PieceBegin + this->Piece.size())
  {
    const std::uint64_t left = this->size() - std::min(this->size(), offset);
    this->Piece = this->bytes(offset, std::max(count, std::min(atOnce, left)));
    this->PieceBegin = offset;
  }
  return this->Piece.data() + (offset - this->PieceBegin);
}

FileSource::FileSource(const std::string& name)
{
  const std::string irregular = whyNotRegular(name);
  if (!irregular.empty())
  {
    throw FormatError(irregular);
  }
  errno = 0;
  this->Stream.open(name, std::ios::binary | std::ios::ate);
  const std::streamoff end = this->Stream ? std::streamoff(this->Stream.tellg()) : -1;
  if (end < 0)
  {
    throw FormatError(errno ? std::strerror(errno) : "it cannot be opened");
  }
  this->Size = static_cast<std::uint64_t>(end);
}

void FileSource::read(std::uint64_t offset, std::uint64_t count, unsigned char* into)
{
  if (!this->holds(offset, count))
  {
    cutShort();
  }
  this->Stream.seekg(static_cast<std::streamoff>(offset));
  this->Stream.read(reinterpret_cast<char*>(into), static_cast<std::streamsize>(count));
  if (!this->Stream)
  {
    throw FormatError("it cannot be read to its end");
  }
}
}
