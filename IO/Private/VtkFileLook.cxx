// SPDX-License-Identifier: BSD-3-Clause
#include "FileLook.h"

#include "AvailableMemory.h"
#include "LookedBytes.h"
#include "XmlTags.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string_view>

namespace avianlidar::scene
{
namespace
{
namespace fs = std::filesystem;

// Bytes of a point and a cell of a surface until they are triangles of a scene.
constexpr double BytesPerPoint = 100.0;
constexpr double BytesPerCell = 150.0;
// Bytes of a block of which nothing is known but that there is one.
constexpr double BytesPerBlock = 100.0;
// Bits: the smallest value.
constexpr double ValuesPerByte = 8.0;

/// What a grid of so many points along each axis gives: its outside.
double outsideOf(const double points[3])
{
  const double a = std::max(1.0, points[0]);
  const double b = std::max(1.0, points[1]);
  const double c = std::max(1.0, points[2]);
  return 2.0 * (a * b + b * c + c * a);
}

/// The number that a word is; false if it is none.
bool isNumber(const std::string& word, double& number)
{
  char* end = nullptr;
  number = std::strtod(word.c_str(), &end);
  return end != word.c_str() && *end == '\0';
}

/// A legacy file word by word. Counts may be at most what the file has room for.
class Legacy
{
public:
  explicit Legacy(const std::string& file)
    : Bytes(file)
  {
    std::error_code ignored;
    const auto size = fs::file_size(file, ignored);
    this->MostValues = ignored ? 0.0 : ValuesPerByte * static_cast<double>(size);
  }

  void Look()
  {
    this->ReadHead();
    for (std::string word; this->Next(word);)
    {
      this->Take(vtksys::SystemTools::LowerCase(word));
    }
  }

private:
  void ReadHead()
  {
    std::string line = this->Line();
    const std::size_t number = line.find_first_of("0123456789");
    this->RunsOfIds = number == std::string::npos || std::atoi(line.c_str() + number) < 5;
    this->Line(); // the title
    std::string word;
    this->Next(word);
    this->IsBinary = vtksys::SystemTools::LowerCase(word) == "binary";
  }

  void Take(const std::string& word)
  {
    double number = 0.0;
    if (isNumber(word, number))
    {
      this->BeforeLast = this->Last;
      this->Last = number;
      return;
    }
    if (word == "vertices" || word == "lines" || word == "polygons" || word == "triangle_strips" ||
      word == "cells")
    {
      this->TakeCells();
    }
    else if (word == "dimensions")
    {
      this->TakeDimensions();
    }
    else if (word == "cell_types" || word == "edges" || word == "color_scalars" ||
      word == "children")
    {
      this->RequireRoomFor(this->Number());
    }
    else if (word.size() > 5 && word.compare(word.size() - 5, 5, "_data") == 0)
    {
      this->Tuples = std::max(0.0, this->Number()); // POINT_DATA, CELL_DATA, ROW_DATA, ...
    }
    else if (word == "scalars" || word == "texture_coordinates")
    {
      this->TakeScalars();
    }
    else if (word == "vectors" || word == "normals" || word == "tensors" || word == "tensors6" ||
      word == "global_ids" || word == "pedigree_ids" || word == "edge_flags")
    {
      this->RequireRoomFor(this->Tuples);
    }
    else if (word == "child" || word == "endchild")
    {
      this->Level += word == "child" ? 1 : -1;
      RefuseLevel(this->Level);
    }
    else if (isType(word))
    {
      // "POINTS 3 float"; an array of field data is "name 2 3 float".
      this->RequireRoomFor(std::max(1.0, this->BeforeLast) * std::max(0.0, this->Last));
    }
    this->BeforeLast = this->Last = 0.0;
  }

  static bool isType(const std::string& word)
  {
    for (const char* type : { "bit", "char", "signed_char", "unsigned_char", "short",
           "unsigned_short", "int", "unsigned_int", "long", "unsigned_long", "float", "double",
           "vtkidtype", "vtktypeint64", "vtktypeuint64", "string", "utf8_string", "variant" })
    {
      if (word == type)
      {
        return true;
      }
    }
    return false;
  }

  void RequireRoomFor(double values) const
  {
    if (values > this->MostValues)
    {
      std::ostringstream text;
      text << "is broken: it says that it has " << values
           << " values in one place, and has room for " << this->MostValues;
      throw Error(text.str());
    }
  }

  void TakeCells()
  {
    const double cells = this->Number();
    const double size = this->Number();
    this->RequireRoomFor(cells);
    this->RequireRoomFor(size);
    if (this->RunsOfIds && size > 0.0)
    {
      this->LookAtRuns(static_cast<std::int64_t>(size));
    }
    if (!this->RunsOfIds && cells > 0.0)
    {
      this->LookAtArray("OFFSETS", cells);
      this->LookAtArray("CONNECTIVITY", size);
    }
  }

  /// "OFFSETS vtktypeint64" and so many numbers: VTK follows a null pointer where the type is
  /// missing.
  void LookAtArray(const std::string& title, double numbers)
  {
    std::string word;
    this->Next(word);
    if (vtksys::SystemTools::UpperCase(word) != title)
    {
      throw Error("is broken: '" + word + "' stands where " + title + " is expected");
    }
    this->Next(word, /*sameLine=*/true);
    const int bytes = BytesOfInteger(vtksys::SystemTools::LowerCase(word));
    if (bytes == 0)
    {
      throw Error("is broken: after " + title + " '" + word +
        "' stands, expected vtktypeint64 or another type of integers");
    }
    if (this->IsBinary)
    {
      this->Line();
    }
    for (double left = this->IsBinary ? numbers * bytes : numbers; left > 0.0; --left)
    {
      if (this->Bytes.Peek() == LookedBytes::End)
      {
        return; // its reader says so
      }
      this->IsBinary ? static_cast<void>(this->Bytes.Get()) : static_cast<void>(this->Next(word));
    }
  }

  /// 0 if it is none.
  static int BytesOfInteger(const std::string& type)
  {
    const std::string plain = type.compare(0, 9, "unsigned_") == 0 ? type.substr(9) : type;
    return plain == "vtktypeint64" || plain == "vtktypeuint64" || plain == "vtkidtype" ||
        plain == "long"
      ? 8
      : plain == "int"   ? 4
      : plain == "short" ? 2
      : plain == "char"  ? 1
                         : 0;
  }

  /// A cell is the number of its points and these: it must end before the last of them.
  void LookAtRuns(std::int64_t size)
  {
    if (this->IsBinary && this->Bytes.Peek() != LookedBytes::End)
    {
      this->Line();
    }
    double points = 0.0;
    for (std::int64_t i = 0; i < size; ++i)
    {
      if (!this->Id(points))
      {
        return; // its reader says so
      }
      const std::int64_t room = size - i - 1;
      if (!(points >= 0.0 && points <= static_cast<double>(room)))
      {
        std::ostringstream text;
        text.precision(15);
        text << "is broken: a cell says that it has " << points << " points, and has room for "
             << room;
        throw Error(text.str());
      }
      for (auto left = static_cast<std::int64_t>(points); left > 0; --left, ++i)
      {
        double ignored = 0.0;
        if (!this->Id(ignored))
        {
          return;
        }
      }
    }
  }

  bool Id(double& id)
  {
    if (!this->IsBinary)
    {
      std::string word;
      return this->Next(word) && isNumber(word, id);
    }
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i)
    {
      bits = bits << 8 | static_cast<std::uint32_t>(this->Bytes.Get() & 0xFF);
    }
    id = static_cast<std::int32_t>(bits);
    return this->Bytes.Peek() != LookedBytes::End;
  }

  /// A grid without points of its own becomes its outside.
  void TakeDimensions()
  {
    double points[3];
    for (double& along : points)
    {
      along = this->Number();
    }
    const double faces = outsideOf(points);
    requireMemory(faces, "faces", faces * BytesPerCell);
  }

  /// "SCALARS name float 3", "TEXTURE_COORDINATES name 2 float"
  void TakeScalars()
  {
    std::string word;
    this->Next(word);
    double components = 1.0;
    for (int i = 0; i < 2 && this->Next(word, /*sameLine=*/true); ++i)
    {
      double number = 0.0;
      components = isNumber(word, number) ? number : components;
    }
    this->RequireRoomFor(this->Tuples * components);
  }

  /// The number that follows, or 0.
  double Number()
  {
    std::string word;
    double number = 0.0;
    return this->Next(word) && isNumber(word, number) ? number : 0.0;
  }

  /// The next word, of which as much as VTK looks at; false at the end, or of the line.
  bool Next(std::string& word, bool sameLine = false)
  {
    constexpr std::size_t longest = 255;
    word.clear();
    for (int byte = this->Bytes.Peek(); byte != LookedBytes::End; byte = this->Bytes.Peek())
    {
      const bool blank = byte == ' ' || (byte >= '\t' && byte <= '\r');
      if ((blank && !word.empty()) || (sameLine && byte == '\n'))
      {
        break;
      }
      this->Bytes.Get();
      if (!blank && word.size() < longest)
      {
        word += static_cast<char>(byte);
      }
    }
    return !word.empty();
  }

  /// The rest of the line.
  std::string Line()
  {
    std::string line;
    for (int byte = 0; (byte = this->Bytes.Get()) != LookedBytes::End && byte != '\n';)
    {
      line += static_cast<char>(byte);
    }
    return line;
  }

  LookedBytes Bytes;
  double MostValues = 0.0;
  bool RunsOfIds = true;
  bool IsBinary = false;
  double BeforeLast = 0.0;
  double Last = 0.0;
  double Tuples = 0.0;
  int Level = 0;
};

/// What a VTK file of XML asks for, by the attributes of its tags.
class XmlSizes
{
public:
  void Take(const XmlTag& tag, const fs::path& folder, int level);

  void Check() const { requireMemory(this->Count, "points and cells", this->Bytes); }

private:
  void TakeExtent(const XmlTag& tag);
  static void CheckCompressor(const std::string& compressor);
  static void CheckType(const std::string& type);

  double Whole[6] = { 0, 0, 0, 0, 0, 0 }; // extent
  double Points = 0.0;                    // of the piece
  double Cells = 0.0;
  bool OfCells = false; // arrays that follow have values for cells
  double Count = 0.0;   // of all
  double Bytes = 0.0;
};

double numberOf(const XmlTag& tag, const char* key)
{
  const double number = std::strtod(tag.Attribute(key).c_str(), nullptr);
  if (number < 0.0)
  {
    throw Error(
      std::string("is broken: ") + key + " is " + tag.Attribute(key) + ", expected at least 0");
  }
  return number;
}

/// The six numbers of an extent; false if there are not so many.
bool extentOf(const XmlTag& tag, const char* key, double extent[6])
{
  std::istringstream text(tag.Attribute(key));
  for (int i = 0; i < 6; ++i)
  {
    text >> extent[i];
  }
  return !text.fail();
}

void XmlSizes::TakeExtent(const XmlTag& tag)
{
  double extent[6];
  if (extentOf(tag, "Extent", extent))
  {
    double points[3], cells[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double from = extent[2 * axis], to = extent[2 * axis + 1];
      if (from < this->Whole[2 * axis] || to > this->Whole[2 * axis + 1])
      {
        throw Error("is broken: the extent of a piece, " + tag.Attribute("Extent") +
          ", leaves the whole extent");
      }
      points[axis] = std::max(0.0, to - from + 1.0);
      cells[axis] = std::max(1.0, points[axis] - 1.0);
    }
    this->Points = points[0] * points[1] * points[2];
    this->Cells = cells[0] * cells[1] * cells[2];
    const double faces = outsideOf(points);
    this->Count += faces;
    this->Bytes += faces * BytesPerCell;
  }
}

/// VTK follows a null pointer where it does not know the compressor.
void XmlSizes::CheckCompressor(const std::string& compressor)
{
  const std::string_view known[] = { "", "vtkZLibDataCompressor", "vtkLZ4DataCompressor",
    "vtkLZMADataCompressor" };
  if (std::find(std::begin(known), std::end(known), compressor) == std::end(known))
  {
    throw Error("is broken: its compressor is '" + compressor +
      "', expected vtkZLibDataCompressor, vtkLZ4DataCompressor or vtkLZMADataCompressor");
  }
}

/// The same where it does not know an array's type.
void XmlSizes::CheckType(const std::string& type)
{
  const std::string_view known[] = { "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64",
    "UInt64", "Float32", "Float64", "String", "Bit" };
  if (std::find(std::begin(known), std::end(known), type) == std::end(known))
  {
    throw Error("is broken: an array is of the type '" + type +
      "', expected Int8 to Int64, UInt8 to UInt64, Float32, Float64, String or Bit");
  }
}

void LookAtXmlFile(const std::string& file, int level)
{
  XmlTags tags(file);
  XmlSizes sizes;
  const fs::path folder = fs::path(file).parent_path();
  for (XmlTag tag; tags.Next(tag) && tag.name != "AppendedData";)
  {
    if (tag.opens)
    {
      sizes.Take(tag, folder, level);
    }
  }
  sizes.Check();
}

void XmlSizes::Take(const XmlTag& tag, const fs::path& folder, int level)
{
  // Files of files of files are none of VTK's.
  constexpr int deepest = 3;
  if (tag.name == "VTKFile")
  {
    CheckCompressor(tag.Attribute("compressor"));
  }
  else if (!tag.Attribute("WholeExtent").empty())
  {
    extentOf(tag, "WholeExtent", this->Whole);
  }
  else if (tag.name == "Piece")
  {
    this->Points = numberOf(tag, "NumberOfPoints");
    this->Cells = numberOf(tag, "NumberOfCells") + numberOf(tag, "NumberOfVerts") +
      numberOf(tag, "NumberOfLines") + numberOf(tag, "NumberOfStrips") +
      numberOf(tag, "NumberOfPolys");
    this->Count += this->Points + this->Cells;
    this->Bytes += this->Points * BytesPerPoint + this->Cells * BytesPerCell;
    this->TakeExtent(tag);
  }
  else if (tag.name == "PointData" || tag.name == "CellData")
  {
    this->OfCells = tag.name == "CellData";
  }
  else if (tag.name == "DataArray" || tag.name == "Array")
  {
    CheckType(tag.Attribute("type"));
    const double tuples = tag.Attribute("NumberOfTuples").empty()
      ? (this->OfCells ? this->Cells : this->Points)
      : numberOf(tag, "NumberOfTuples");
    this->Bytes += tuples * std::max(1.0, numberOf(tag, "NumberOfComponents"));
  }
  else if (tag.name == "Block" || tag.name == "DataSet")
  {
    this->Bytes += BytesPerBlock * numberOf(tag, "index");
    const std::string part = tag.Attribute("file");
    if (!part.empty() && level < deepest)
    {
      LookAtXmlFile((folder / part).string(), level + 1);
    }
  }
}
}

void LookAtVtkFile(const std::string& file)
{
  if (vtksys::SystemTools::LowerCase(fs::path(file).extension().string()) == ".vtk")
  {
    Legacy(file).Look();
  }
  else
  {
    LookAtXmlFile(file, 1);
  }
}
}
