// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file XmlTags.h
 * @brief The tags of an XML file in their order, read without a stack; text between them is passed
 * over.
 */
#ifndef AvianLidarXmlTags_h
#define AvianLidarXmlTags_h

#include "LookedBytes.h"

#include <string>

namespace avianlidar::scene
{
struct XmlTag
{
  std::string name;
  std::string attributes; ///< as written
  bool opens = false;
  bool closes = false; ///< both: an element without content

  /// The value of an attribute, or nothing.
  std::string Attribute(const std::string& key) const;
};

class XmlTags
{
public:
  explicit XmlTags(const std::string& file)
    : Bytes(file)
  {
  }

  /// The next tag; false at the end. Throws Error where tags are nested more than 1000 deep.
  bool Next(XmlTag& tag);

  /// Open elements, the one of an opening tag included.
  int Depth() const { return this->Open; }

private:
  int Get();
  void SkipBehind(const std::string& end);
  bool ReadContent(std::string& content);

  LookedBytes Bytes;
  int Open = 0;
  bool Closing = false; // the last tag has no content: it is closed by now
};
}

#endif
