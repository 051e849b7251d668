// SPDX-License-Identifier: BSD-3-Clause
#include "ByteSource.h"

#include "FileError.h"
#include "RegularFile.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace avianlidar
{
namespace
{
constexpr const char* CutShort = "the file ends before its data do";
}

std::vector<unsigned char> ByteSource::bytes(std::uint64_t offset, std::uint64_t count)
{
  failIf(!this->holds(offset, count), CutShort);
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
  failIf(!irregular.empty(), irregular);
  errno = 0;
  this->Stream.open(name, std::ios::binary | std::ios::ate);
  const std::streamoff end = this->Stream ? std::streamoff(this->Stream.tellg()) : -1;
  failIf(end < 0, errno ? std::strerror(errno) : "it cannot be opened");
  this->Size = static_cast<std::uint64_t>(end);
}

void FileSource::read(std::uint64_t offset, std::uint64_t count, unsigned char* into)
{
  failIf(!this->holds(offset, count), CutShort);
  this->Stream.seekg(static_cast<std::streamoff>(offset));
  this->Stream.read(reinterpret_cast<char*>(into), static_cast<std::streamsize>(count));
  failIf(!this->Stream, "it cannot be read to its end");
}
}
