// SPDX-License-Identifier: BSD-3-Clause
#include "XmlTags.h"

#include <algorithm>

namespace avianlidar::scene
{
namespace
{
constexpr const char* Blanks = " \t\r\n";
// Bytes of a tag's attributes; what is longer is passed over.
constexpr std::size_t LongestContent = 1 << 16;
}

std::string XmlTag::Attribute(const std::string& key) const
{
  for (std::size_t at = this->attributes.find(key); at != std::string::npos;
       at = this->attributes.find(key, at + 1))
  {
    const std::size_t quote = this->attributes.find_first_not_of(" \t\r\n=", at + key.size());
    const bool whole =
      at > 0 && std::string(Blanks).find(this->attributes[at - 1]) != std::string::npos;
    if (!whole || quote == std::string::npos ||
      (this->attributes[quote] != '"' && this->attributes[quote] != '\''))
    {
      continue;
    }
    const std::size_t end = this->attributes.find(this->attributes[quote], quote + 1);
    return this->attributes.substr(quote + 1, end == std::string::npos ? end : end - quote - 1);
  }
  return {};
}

// Texts in UTF-16, too: every other byte of what matters is zero there.
int XmlTags::Get()
{
  int byte = 0;
  do
  {
    byte = this->Bytes.Get();
  } while (byte == 0);
  return byte;
}

void XmlTags::SkipBehind(const std::string& end)
{
  std::string last;
  for (int byte = 0; last != end && (byte = this->Get()) != LookedBytes::End;)
  {
    last += static_cast<char>(byte);
    last.erase(0, last.size() - std::min(last.size(), end.size()));
  }
}

// What stands between "<" and ">"; false at the end.
bool XmlTags::ReadContent(std::string& content)
{
  content.clear();
  int quote = 0;
  for (int byte = 0; (byte = this->Get()) != LookedBytes::End;)
  {
    if (byte == '>' && quote == 0)
    {
      return true;
    }
    quote = byte == quote ? 0 : (quote == 0 && (byte == '"' || byte == '\'') ? byte : quote);
    if (content.size() < LongestContent)
    {
      content += static_cast<char>(byte);
    }
    else if (quote == 0)
    {
      content.back() = static_cast<char>(byte); // the slash of an element without content
    }
    if (content == "!--" || content == "![CDATA[")
    {
      this->SkipBehind(content == "!--" ? "-->" : "]]>");
      content = "!";
      return true;
    }
  }
  return false;
}

bool XmlTags::Next(XmlTag& tag)
{
  this->Open -= this->Closing;
  this->Closing = false;
  std::string content;
  do
  {
    int byte = 0;
    while (byte != '<')
    {
      byte = this->Get();
      if (byte == LookedBytes::End)
      {
        return false;
      }
    }
    if (!this->ReadContent(content))
    {
      return false;
    }
  } while (content.empty() || content[0] == '!' || content[0] == '?');
  tag.opens = content[0] != '/';
  tag.closes = !tag.opens || content.back() == '/';
  const std::size_t begin = tag.opens ? 0 : 1;
  const std::size_t end = std::min(content.find_first_of(" \t\r\n/", begin), content.size());
  tag.name = content.substr(begin, end - begin);
  tag.attributes = content.substr(end);
  this->Open += tag.opens;
  RefuseLevel(this->Open);
  this->Closing = tag.closes;
  return true;
}
}
