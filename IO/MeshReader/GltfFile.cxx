// SPDX-License-Identifier: BSD-3-Clause
#include "GltfFile.h"

#include "FileNames.h"
#include "Json.h"
#include "SceneTypes.h"

#include <vtksys/Base64.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <string_view>
#include <type_traits>

namespace avianlidar::scene
{
namespace
{
constexpr const char* Instances = "EXT_mesh_gpu_instancing";
constexpr const char* Quantized = "KHR_mesh_quantization";
constexpr const char* Draco = "KHR_draco_mesh_compression";
constexpr int Single = 5126; ///< component type of numbers of single precision

/// Returns chunk 0 or 1 of a binary file: JSON or the first buffer. A binary file begins with a
/// header of 12 bytes. A chunk begins with its length and a mark. Returns the whole text as the
/// JSON of another file.
std::string_view ChunkOf(const std::string& text, int number)
{
  constexpr std::size_t header = 12, mark = 8;
  if (!StartsWith(text, "glTF") || text.size() < header + mark)
  {
    return number == 0 ? text : std::string_view();
  }
  std::string_view rest = std::string_view(text).substr(header);
  for (; rest.size() >= mark; --number)
  {
    std::uint32_t length = 0;
    std::memcpy(&length, rest.data(), sizeof length);
    const std::string_view chunk = rest.substr(mark, length);
    if (number == 0)
    {
      return chunk;
    }
    rest.remove_prefix(mark + chunk.size());
  }
  return {};
}

/// Returns the document of a file, or a discarded value if the file is not JSON.
Json DocumentOf(const std::string& text)
{
  std::string json(ChunkOf(text, 0));
  json.erase(0, std::min(json.find('{'), json.size())); // byte-order mark
  Json document = Json::parse(json, nullptr, /*allow_exceptions=*/false);
  if (document.is_discarded())
  {
    // Assimp accepts bytes of other encodings in names.
    std::replace_if(
      json.begin(), json.end(), [](char byte) { return (byte & 0x80) != 0; }, '?');
    document = Json::parse(json, nullptr, /*allow_exceptions=*/false);
  }
  return document;
}

/// Returns the value of a key or an index, or null.
const Json& ValueIn(const Json& holder, const Json& key)
{
  static const Json none;
  if (holder.is_array() && key.is_number_unsigned() && key.get<std::size_t>() < holder.size())
  {
    return holder[key.get<std::size_t>()];
  }
  const auto value = holder.is_object() && key.is_string()
    ? holder.find(key.get_ref<const std::string&>())
    : holder.end();
  return value != holder.end() ? *value : none;
}

/// Returns a list of an object, or an empty list if the object has no such list.
const Json& ListIn(const Json& object, const char* key)
{
  static const Json none = Json::array();
  const Json& list = ValueIn(object, key);
  return list.is_array() ? list : none;
}

/// Returns a number of 0 or more of an object. Throws Error if the number is another value.
/// @param otherwise the number if the object has no such key
std::size_t CountIn(const Json& object, const char* key, std::size_t otherwise)
{
  const Json& value = ValueIn(object, key);
  failIf(!value.is_null() && !value.is_number_unsigned(), "is broken: ", key, " is ", value.dump(),
    ", expected a whole number of 0 or more");
  return value.is_null() ? otherwise : value.get<std::size_t>();
}

/// Returns whether the geometry of a file that requires the extension is read right.
bool IsKnown(const std::string& extension)
{
  static const char* const starts[] = { Draco, Quantized, Instances, "KHR_materials_",
    "KHR_texture_", "EXT_texture_", "MSFT_texture_", "MSFT_packing_", "KHR_lights_", "EXT_lights_",
    "KHR_xmp", "EXT_mesh_features", "EXT_instance_features", "EXT_structural_metadata" };
  return std::any_of(std::begin(starts), std::end(starts),
    [&](const char* start) { return StartsWith(extension, start); });
}

/// A type of a component of an accessor (specification, section 3.6.2.2).
struct Component
{
  int type;
  std::size_t size;              ///< bytes
  double (*number)(const char*); ///< reads a number
  double most;                   ///< number that stands for 1 if numbers are normalized
};

template <class T>
double NumberAt(const char* at)
{
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

template <class T>
constexpr Component ComponentOf(int type)
{
  return { type, sizeof(T), NumberAt<T>,
    std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::max()) : 1.0 };
}

/// Returns the type of the components of an accessor.
const Component& ComponentIn(const Json& accessor)
{
  static constexpr Component all[] = { ComponentOf<std::int8_t>(5120),
    ComponentOf<std::uint8_t>(5121), ComponentOf<std::int16_t>(5122),
    ComponentOf<std::uint16_t>(5123), ComponentOf<std::uint32_t>(5125),
    ComponentOf<float>(Single) };
  const std::size_t type = CountIn(accessor, "componentType", Single);
  const auto found = std::find_if(std::begin(all), std::end(all),
    [type](const Component& one) { return static_cast<std::size_t>(one.type) == type; });
  failIf(found == std::end(all), "has numbers of the component type ", type,
    ", expected 5120 to 5123, 5125 or 5126");
  return *found;
}

/// Writes a document with quantized positions or instances as Assimp can read the document.
class InFloats
{
public:
  InFloats(const std::string& text, const std::function<std::string(const std::string&)>& read)
    : Document(DocumentOf(text))
    , Text(text)
    , Read(read)
  {
  }

  GltfFiles Write()
  {
    if (!this->Document.is_object())
    {
      return {};
    }
    const bool isQuantized = this->DequantizeMeshes();
    const bool hasInstances = this->PlaceInstances();
    if (!isQuantized && !hasInstances)
    {
      return {};
    }
    for (const char* list : { "extensionsRequired", "extensionsUsed" })
    {
      this->Document.erase(list);
    }
    GltfFiles files;
    const Json& first = ValueIn(ListIn(this->Document, "buffers"), std::size_t(0));
    if (const std::string_view own = ChunkOf(this->Text, 1);
        !own.empty() && ValueIn(first, "uri").is_null())
    {
      this->Document["buffers"][0]["uri"] = "avian-lidar-own.bin";
      files.buffers["avian-lidar-own.bin"] = own;
    }
    if (!this->Floats.empty())
    {
      this->Document["buffers"].push_back(
        { { "uri", "avian-lidar-floats.bin" }, { "byteLength", this->Floats.size() } });
      files.buffers["avian-lidar-floats.bin"] = std::move(this->Floats);
    }
    files.json = this->Document.dump(-1, ' ', false, Json::error_handler_t::replace);
    return files;
  }

private:
  /// Makes positions that are not of single precision, and attributes that Assimp would read wrong,
  /// readable. Returns whether the document has such positions.
  bool DequantizeMeshes()
  {
    std::vector<std::size_t> accessors;
    for (const Json& mesh : ListIn(this->Document, "meshes"))
    {
      for (const Json& primitive : ListIn(mesh, "primitives"))
      {
        const Json& position = ValueIn(ValueIn(primitive, "attributes"), "POSITION");
        const Json& accessor = ValueIn(ListIn(this->Document, "accessors"), position);
        if (accessor.is_object() && ComponentIn(accessor).type != Single)
        {
          failIf(!ValueIn(ValueIn(primitive, "extensions"), Draco).is_null(),
            "has quantized positions that Draco packs, which is not supported");
          accessors.push_back(position.get<std::size_t>());
        }
      }
    }
    std::sort(accessors.begin(), accessors.end());
    accessors.erase(std::unique(accessors.begin(), accessors.end()), accessors.end());
    for (const std::size_t number : accessors)
    {
      this->Dequantize(number);
    }
    if (accessors.empty())
    {
      return false;
    }
    for (Json& mesh : this->Document["meshes"])
    {
      if (ListIn(mesh, "primitives").empty())
      {
        continue;
      }
      for (Json& primitive : mesh["primitives"])
      {
        const Json position = ValueIn(ValueIn(primitive, "attributes"), "POSITION");
        primitive["attributes"] = { { "POSITION", position } };
        primitive.erase("targets");
      }
    }
    return true;
  }

  /// Replaces the numbers of an accessor of positions by numbers of single precision.
  void Dequantize(std::size_t accessor)
  {
    const std::vector<double> numbers = this->NumbersOf(this->Document["accessors"][accessor], 3);
    const std::size_t begin = this->Floats.size();
    this->Floats.reserve(begin + numbers.size() * sizeof(float));
    for (const double number : numbers)
    {
      const auto single = static_cast<float>(number);
      this->Floats.append(reinterpret_cast<const char*>(&single), sizeof single);
    }
    Json& views = this->Document["bufferViews"];
    const std::size_t view = views.size();
    views.push_back({ { "buffer", ListIn(this->Document, "buffers").size() },
      { "byteOffset", begin }, { "byteLength", this->Floats.size() - begin } });
    this->Document["accessors"][accessor] = { { "bufferView", view }, { "componentType", Single },
      { "count", numbers.size() / 3 }, { "type", "VEC3" } };
  }

  /// Gives each node with instances a child for each instance. Returns whether there are any.
  bool PlaceInstances()
  {
    Json& nodes = this->Document["nodes"];
    const std::size_t count = nodes.is_array() ? nodes.size() : 0;
    bool found = false;
    for (std::size_t i = 0; i < count; ++i)
    {
      const Json& instances = ValueIn(ValueIn(nodes[i], "extensions"), Instances);
      if (instances.is_null())
      {
        continue;
      }
      found = true;
      bool isPlaced = false;
      const Json attributes = ValueIn(instances, "attributes");
      const Json mesh = ValueIn(nodes[i], "mesh");
      std::vector<Json> children;
      static const std::pair<const char*, std::size_t> parts[] = { { "translation", 3 },
        { "rotation", 4 }, { "scale", 3 } };
      for (const auto& [part, size] : parts)
      {
        std::string attribute = part;
        std::transform(attribute.begin(), attribute.end(), attribute.begin(),
          [](char letter) { return static_cast<char>(letter - 'a' + 'A'); });
        const Json& number = ValueIn(attributes, attribute);
        if (number.is_null())
        {
          continue;
        }
        const Json& accessor = ValueIn(ListIn(this->Document, "accessors"), number);
        failIf(!accessor.is_object(), "is broken: ", attribute, " of instances is ", number.dump(),
          ", expected the number of an accessor");
        const std::vector<double> numbers = this->NumbersOf(accessor, size);
        failIf(isPlaced && children.size() != numbers.size() / size,
          "is broken: the attributes of instances have ", children.size(), " and ",
          numbers.size() / size, " values");
        isPlaced = true;
        children.resize(numbers.size() / size, { { "mesh", mesh } });
        for (std::size_t k = 0; k < children.size(); ++k)
        {
          children[k][part] =
            std::vector<double>(numbers.begin() + k * size, numbers.begin() + (k + 1) * size);
        }
      }
      failIf(!isPlaced, "is broken: instances have no TRANSLATION, ROTATION or SCALE");
      nodes[i].erase("mesh");
      nodes[i].erase("extensions");
      for (Json& child : children)
      {
        if (!mesh.is_null())
        {
          nodes[i]["children"].push_back(nodes.size());
          nodes.push_back(std::move(child));
        }
      }
    }
    if (count == 0)
    {
      this->Document.erase("nodes");
    }
    return found;
  }

  /// Returns all numbers of an accessor, element by element. Throws Error if the accessor reaches
  /// beyond its buffer. @param size number of components of an element
  std::vector<double> NumbersOf(const Json& accessor, std::size_t size)
  {
    const Json& type = ValueIn(accessor, "type");
    failIf(type != "VEC" + std::to_string(size), "is broken: an accessor is of the type ",
      type.dump(), ", expected \"VEC", size, '"');
    const std::size_t count = CountIn(accessor, "count", 0);
    const Component& of = ComponentIn(accessor);
    const double divisor = ValueIn(accessor, "normalized") == true ? of.most : 1.0;
    const auto numberAt = [&](const char* at)
    { return std::max(of.number(at) / divisor, divisor == 1.0 ? -HUGE_VAL : -1.0); };
    std::vector<double> numbers;
    if (const Json& view = ValueIn(accessor, "bufferView"); !view.is_null())
    {
      const auto [bytes, stride] = this->BytesOf(accessor, view, count, size * of.size);
      numbers.reserve(count * size);
      for (std::size_t i = 0; i < count; ++i)
      {
        for (std::size_t k = 0; k < size; ++k)
        {
          numbers.push_back(numberAt(bytes + i * stride + k * of.size));
        }
      }
    }
    else
    {
      constexpr std::size_t most = std::size_t(1) << 32;
      failIf(count > most, "is broken: an accessor without a buffer has ", count, " elements");
      numbers.resize(count * size);
    }
    if (const Json& sparse = ValueIn(accessor, "sparse"); !sparse.is_null())
    {
      const std::size_t changed = CountIn(sparse, "count", 0);
      const Json &where = ValueIn(sparse, "indices"), &what = ValueIn(sparse, "values");
      const Component& index = ComponentIn(where);
      const auto [at, atStride] =
        this->BytesOf(where, ValueIn(where, "bufferView"), changed, index.size);
      const auto [values, valueStride] =
        this->BytesOf(what, ValueIn(what, "bufferView"), changed, size * of.size);
      for (std::size_t i = 0; i < changed; ++i)
      {
        const double number = index.number(at + i * atStride);
        failIf(!(number >= 0.0 && number < static_cast<double>(count)),
          "is broken: a sparse accessor changes element ", number, " of ", count);
        const auto element = static_cast<std::size_t>(number);
        for (std::size_t k = 0; k < size; ++k)
        {
          numbers[element * size + k] = numberAt(values + i * valueStride + k * of.size);
        }
      }
    }
    return numbers;
  }

  /// Returns the first byte of an accessor's elements, and the step from one element to the next.
  std::pair<const char*, std::size_t> BytesOf(
    const Json& accessor, const Json& number, std::size_t count, std::size_t size)
  {
    const Json& view = ValueIn(ListIn(this->Document, "bufferViews"), number);
    const std::string& bytes = this->BufferOf(CountIn(view, "buffer", 0));
    const std::size_t stride = CountIn(view, "byteStride", size);
    const std::size_t begin = CountIn(view, "byteOffset", 0);
    const std::size_t inside = CountIn(accessor, "byteOffset", 0);
    const bool fits = view.is_object() && begin <= bytes.size() && inside <= bytes.size() - begin &&
      (count == 0 ||
        (bytes.size() - begin - inside >= size && stride > 0 &&
          (bytes.size() - begin - inside - size) / stride >= count - 1));
    failIf(!fits, "is broken: an accessor of ", count, " elements reaches beyond its buffer");
    return { bytes.data() + begin + inside, stride };
  }

  /// Returns the contents of a buffer.
  const std::string& BufferOf(std::size_t number)
  {
    const auto known = this->Buffers.find(number);
    if (known != this->Buffers.end())
    {
      return known->second;
    }
    const Json& uri = ValueIn(ValueIn(ListIn(this->Document, "buffers"), number), "uri");
    std::string bytes;
    if (!uri.is_string())
    {
      bytes = number == 0 ? ChunkOf(this->Text, 1) : std::string_view();
    }
    else if (const std::string& text = uri.get_ref<const std::string&>(); StartsWith(text, "data:"))
    {
      const std::size_t begin = std::min(text.find(','), text.size() - 1) + 1;
      bytes.resize(text.size() - begin);
      bytes.resize(vtksysBase64_Decode(reinterpret_cast<const unsigned char*>(text.data() + begin),
        0, reinterpret_cast<unsigned char*>(bytes.data()), bytes.size()));
    }
    else
    {
      bytes = this->Read(text);
    }
    return this->Buffers.emplace(number, std::move(bytes)).first->second;
  }

  Json Document;
  const std::string& Text;
  const std::function<std::string(const std::string&)>& Read;
  std::map<std::size_t, std::string> Buffers;
  std::string Floats;
};

/// Returns whether a URI of a file names a place outside the folder of the file that gives it.
bool IsOutside(const std::string& uri)
{
  int depth = 0;
  const std::string path = PercentDecoded(uri);
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1)
  {
    end = path.find_first_of("/\\", begin);
    const std::string step = path.substr(begin, end - begin);
    depth += step == ".." ? -1 : step.empty() || step == "." ? 0 : 1;
    if (depth < 0)
    {
      return true;
    }
  }
  return path.find_first_of("/\\") == 0;
}
}

std::vector<std::string> CheckGltf(const std::string& text)
{
  constexpr std::size_t lengths[] = { 8, 12 }; // where the lengths of the file and of the JSON are
  for (const std::size_t at : lengths)
  {
    std::uint32_t length = 0;
    if (StartsWith(text, "glTF") && text.size() >= at + sizeof length)
    {
      std::memcpy(&length, &text[at], sizeof length);
      failIf(length > text.size(), "is cut short: it says that it has ", length, " bytes and has ",
        text.size());
    }
  }
  const Json document = DocumentOf(text);
  for (const char* list : { "extensionsRequired", "extensionsUsed" })
  {
    const bool isRequired = list == std::string("extensionsRequired");
    for (const Json& one : ListIn(document, list))
    {
      const std::string name = one.is_string() ? one.get<std::string>() : std::string();
      failIf(one.is_string() && (isRequired ? !IsKnown(name) : name == "CESIUM_RTC"),
        isRequired ? "requires" : "uses", " the glTF extension ", name,
        ", which is not supported: export it without this extension");
    }
  }
  for (const Json& buffer : ListIn(document, "buffers"))
  {
    const Json& uri = ValueIn(buffer, "uri");
    failIf(uri.is_string() && !StartsWith(uri.get_ref<const std::string&>(), "data:") &&
        IsOutside(uri.get_ref<const std::string&>()),
      "names the buffer ", uri.dump(),
      ", which is not in its folder: copy the buffer into the "
      "folder and correct the name");
  }
  std::vector<std::string> warnings;
  if (ListIn(document, "skins").size() > 0)
  {
    warnings.push_back("it has skins, which are left out: it is read in the pose of its vertices");
  }
  for (const char* list : { "nodes", "meshes" })
  {
    for (const Json& one : ListIn(document, list))
    {
      const Json& weights = ListIn(one, "weights");
      if (std::any_of(weights.begin(), weights.end(),
            [](const Json& weight) { return weight.is_number() && weight.get<double>() != 0.0; }))
      {
        warnings.push_back("it has weights of morph targets, which are left out");
        return warnings;
      }
    }
  }
  return warnings;
}

GltfFiles GltfInFloats(
  const std::string& text, const std::function<std::string(const std::string&)>& read)
{
  return InFloats(text, read).Write();
}

std::string PercentDecoded(const std::string& uri)
{
  std::string decoded;
  for (std::size_t at = 0; at < uri.size(); ++at)
  {
    unsigned char byte = 0;
    const char* const end = uri.data() + std::min(at + 3, uri.size());
    const bool isCode = uri[at] == '%' && at + 2 < uri.size() &&
      std::from_chars(uri.data() + at + 1, end, byte, 16).ptr == end && byte != 0;
    decoded += isCode ? static_cast<char>(byte) : uri[at];
    at += isCode ? 2 : 0;
  }
  return decoded;
}
}
