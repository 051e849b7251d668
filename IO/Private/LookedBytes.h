// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LookedBytes.h
 * @brief What looks at files share: their bytes, compressed or not, one after the other, and how
 * deep they may be nested.
 */
#ifndef AvianLidarLookedBytes_h
#define AvianLidarLookedBytes_h

#include "SceneTypes.h"
#include "VirtualFiles.h"

#include <cpl_vsi.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace avianlidar::scene
{
/// Readers call themselves level by level, and the stack is finite.
constexpr int DeepestLevel = 1000;

inline void RefuseLevel(int level)
{
  if (level > DeepestLevel)
  {
    throw Error("is nested more than " + std::to_string(DeepestLevel) + " deep");
  }
}

/// What cannot be opened, or is no file but a device or an address, has no bytes: its reader says
/// so.
class LookedBytes
{
public:
  static constexpr int End = -1;

  explicit LookedBytes(const std::string& file)
  {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored))
    {
      this->File.reset(VSIFOpenL(VirtualName(file).c_str(), "rb"));
    }
  }

  /// The next byte, or End.
  int Get()
  {
    const int byte = this->Peek();
    this->At += byte != End;
    return byte;
  }

  int Peek()
  {
    if (this->At == this->Block.size() && this->File)
    {
      this->Block.resize(BlockSize);
      this->Block.resize(VSIFReadL(this->Block.data(), 1, BlockSize, this->File.get()));
      this->At = 0;
    }
    return this->At < this->Block.size() ? this->Block[this->At] : End;
  }

  /// So many bytes from here on, or fewer at the end.
  std::string Text(std::size_t most)
  {
    std::string text;
    for (int byte = 0; text.size() < most && (byte = this->Get()) != End;)
    {
      text += static_cast<char>(byte);
    }
    return text;
  }

private:
  static constexpr std::size_t BlockSize = 1 << 18;
  struct Closer
  {
    void operator()(VSILFILE* file) const { VSIFCloseL(file); }
  };

  const QuietGdal Quiet;
  std::unique_ptr<VSILFILE, Closer> File;
  std::vector<unsigned char> Block;
  std::size_t At = 0;
};
}

#endif
