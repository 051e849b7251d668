// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ShownNames.h
 * @brief Writes names from untrusted files into notes: short, and on one line.
 */
#ifndef AvianLidarShownNames_h
#define AvianLidarShownNames_h

#include <string>

namespace avianlidar::scene
{
/// Returns a name for a message: control characters as "\x0a", and at most 80 bytes of UTF-8.
std::string ShownName(const std::string& name);

/// Counts names, and lists the first five.
class Names
{
public:
  void Add(const std::string& name)
  {
    if (this->Count < Listed)
    {
      this->Text += (this->Count > 0 ? ", " : "") + ShownName(name);
    }
    ++this->Count;
  }
  int GetCount() const { return this->Count; }
  std::string GetText() const { return this->Text + (this->Count > Listed ? ", ..." : ""); }

private:
  static constexpr int Listed = 5;
  int Count = 0;
  std::string Text;
};
}

#endif
