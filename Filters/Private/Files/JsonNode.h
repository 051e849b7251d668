// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file JsonNode.h
 * @brief Declares a JSON value with its file and its path, so that every error names the file and
 * the key.
 */
#ifndef AvianLidarJsonNode_h
#define AvianLidarJsonNode_h

#include "FileError.h"
#include "Json.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace avianlidar
{
/**
 * Read a file as JSON. A file that cannot be opened or parsed, an object with one key twice, or
 * values nested more than 100 deep give a FileError.
 */
Json ReadJson(const std::string& file);

/// Read a text as JSON. @param file name for messages
Json ParseJson(const std::string& text, const std::string& file);

/**
 * A view of one value with its path, such as "objects[3].scale". All getters throw FileError if the
 * value has another type than the getter returns. All numbers are finite.
 */
class JsonNode
{
public:
  JsonNode(const Json& value, std::string path, const std::string& file)
    : Value(value)
    , Path(std::move(path))
    , File(file)
  {
  }

  [[noreturn]] void Fail(const std::string& message) const;
  /// Fails with the joined parts if `isBad` is true.
  template <class... Parts>
  void FailIf(bool isBad, const Parts&... parts) const
  {
    if (isBad)
    {
      this->Fail(joined(parts...));
    }
  }

  const std::string& GetPath() const { return this->Path; }
  const Json& Content() const { return this->Value; }
  bool IsNumber() const { return this->Value.is_number(); }
  bool IsArray() const { return this->Value.is_array(); }

  bool Has(const char* key) const;
  /// The value of a key, which must exist.
  JsonNode Get(const std::string& key) const;
  /// The result of `get`, such as &JsonNode::Number, for the value of a key. Empty if the key is
  /// missing.
  template <class Getter>
  auto Find(const char* key, Getter get) const
  {
    using Result = std::decay_t<std::invoke_result_t<Getter, JsonNode>>;
    return this->Has(key) ? std::optional<Result>(std::invoke(get, this->Get(key))) : std::nullopt;
  }
  /// Throws unless the value is an object whose keys are all in `known`.
  void RequireKeys(const std::vector<std::string>& known) const;
  /// Keys and values of an object, as written.
  std::vector<std::pair<std::string, JsonNode>> Members() const;
  /// Values of an array. @param size required number of values; 0: any number
  std::vector<JsonNode> Items(std::size_t size = 0) const;

  double Number() const;
  double NumberIn(double lowest, double highest) const;
  double PositiveNumber() const;
  bool Bool() const;
  std::string String() const;
  /// A string that is not empty.
  std::string Name() const;
  std::array<double, 3> Vector() const;
  /// The strings of an array, or one string.
  std::vector<std::string> Strings() const;

private:
  void RequireNoNul(const std::string& text) const;

  const Json& Value;
  std::string Path;
  const std::string& File;
};
}

#endif
