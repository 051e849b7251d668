// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBytes.h
 * @brief Numbers, texts and arrays one after the other in a string of bytes, for processes of one
 * byte order. Not installed.
 */
#ifndef vtkAvianLidarBytes_h
#define vtkAvianLidarBytes_h

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

class vtkAvianLidarByteWriter
{
public:
  std::string Bytes;

  template <class T>
  void Put(const T& value)
  {
    this->Put(&value, 1);
  }
  template <class T>
  void Put(const T* values, std::size_t count)
  {
    static_assert(std::is_trivially_copyable<T>::value, "written as bytes");
    this->Bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  void Put(const std::string& text)
  {
    this->Put<std::uint64_t>(text.size());
    this->Put(text.data(), text.size());
  }
  void Put(const std::vector<std::string>& texts)
  {
    this->Put<std::uint64_t>(texts.size());
    for (const std::string& text : texts)
    {
      this->Put(text);
    }
  }
};

/// Reads in the order of writing; std::out_of_range where there is less than asked for.
class vtkAvianLidarByteReader
{
public:
  vtkAvianLidarByteReader(const char* begin, std::size_t bytes)
    : Place(begin)
    , End(begin + bytes)
  {
  }
  bool AtEnd() const { return this->Place == this->End; }

  template <class T>
  T Get()
  {
    T value;
    this->Get(&value, 1);
    return value;
  }
  template <class T>
  void Get(T* values, std::size_t count)
  {
    static_assert(std::is_trivially_copyable<T>::value, "read as bytes");
    const char* from = this->Skip(count * sizeof(T));
    if (count > 0)
    {
      std::memcpy(values, from, count * sizeof(T));
    }
  }
  std::string GetText()
  {
    const auto size = this->Get<std::uint64_t>();
    const char* from = this->Skip(size);
    return std::string(from, size);
  }
  std::vector<std::string> GetTexts()
  {
    const auto count = this->Get<std::uint64_t>();
    std::vector<std::string> texts;
    for (std::uint64_t i = 0; i < count; ++i)
    {
      texts.push_back(this->GetText());
    }
    return texts;
  }
  /// The place before the skipped bytes.
  const char* Skip(std::size_t bytes)
  {
    if (bytes > static_cast<std::size_t>(this->End - this->Place))
    {
      throw std::out_of_range("A message of another rank is shorter than it says");
    }
    const char* from = this->Place;
    this->Place += bytes;
    return from;
  }

private:
  const char* Place;
  const char* End;
};

#endif
