// SPDX-License-Identifier: BSD-3-Clause
#include "LazFormat.h"

#ifdef AVIANLIDAR_LASZIP
#include "AvailableMemory.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <istream>
#include <new>
#include <ostream>
#include <streambuf>

#include <laszip/laszip_api.h>
#endif

namespace avianlidar::formats
{
#ifdef AVIANLIDAR_LASZIP
namespace
{
using Bytes = std::vector<unsigned char>;

constexpr std::size_t HeaderSize = 227; // size of the header of LAS 1.2, bytes
constexpr std::size_t ItemsAt = 34;     // offset of the items in the compression's record, bytes
constexpr std::size_t ItemSize = 6;
constexpr std::size_t CoreLayers = 9; // number of layers of the core in formats 6 and above
constexpr std::uint64_t BytesPerRead = 1 << 16;
constexpr std::uint32_t AnySize = 0xFFFFFFFF;

void require(bool sound)
{
  failIf(!sound, "its compressed points are damaged or cut short");
}

/// Reader or writer of LASzip.
class Laszip
{
public:
  Laszip()
  {
    if (laszip_create(&this->Handle) != 0)
    {
      throw std::bad_alloc();
    }
  }
  ~Laszip()
  {
    // Closing a reader or writer that is not open has no effect.
    laszip_close_reader(this->Handle);
    laszip_close_writer(this->Handle);
    laszip_destroy(this->Handle);
  }
  Laszip(const Laszip&) = delete;
  Laszip& operator=(const Laszip&) = delete;

  operator laszip_POINTER() const { return this->Handle; }

  void set(const LasLayout& layout)
  {
    this->check(laszip_set_point_type_and_size(
      this->Handle, static_cast<laszip_U8>(layout.format), static_cast<laszip_U16>(layout.length)));
  }

  laszip_point& point()
  {
    laszip_point* point = nullptr;
    this->check(laszip_get_point_pointer(this->Handle, &point));
    return *point;
  }

  void check(laszip_I32 failed) const
  {
    if (failed)
    {
      laszip_CHAR* why = nullptr;
      laszip_get_error(this->Handle, &why);
      fail("LASzip says: ", why ? why : "no reason");
    }
  }

private:
  laszip_POINTER Handle = nullptr;
};

/// Returns a header as long as the file's header, with only the entries that LASzip needs.
Bytes headerFor(const LazPoints& points)
{
  Bytes header(points.begin);
  const auto text = [&](std::size_t at, const char* words)
  { std::copy_n(words, std::strlen(words), header.begin() + at); };
  text(0, "LASF");
  header[24] = 1;
  header[25] = 2;
  store(static_cast<std::uint16_t>(HeaderSize), header.data() + 94);
  store(static_cast<std::uint32_t>(points.begin), header.data() + 96);
  store(std::uint32_t{ 1 }, header.data() + 100);
  header[104] = static_cast<unsigned char>(points.layout.format | LazFlag);
  store(static_cast<std::uint16_t>(points.layout.length), header.data() + 105);
  text(HeaderSize + 2, LazUser);
  store(static_cast<std::uint16_t>(LazRecord), header.data() + HeaderSize + 18);
  store(static_cast<std::uint16_t>(points.record.size()), header.data() + HeaderSize + 20);
  std::copy(
    points.record.begin(), points.record.end(), header.begin() + HeaderSize + LasVlrHeaderSize);
  return header;
}

/// File as LASzip reads it: the header of headerFor(), and the bytes after the file's own header.
class Input : public std::streambuf
{
public:
  Input(ByteSource& source, const LazPoints& points)
    : Source(source)
    , Block(headerFor(points))
    , End(points.begin)
    , Limit(source.size())
  {
    this->show();
  }

  /// Continues reading at the offset `at`, up to the offset `limit`.
  void enter(std::uint64_t at, std::uint64_t limit)
  {
    this->setg(nullptr, nullptr, nullptr);
    this->End = at;
    this->Limit = limit;
  }

  std::uint64_t at() const { return this->End - static_cast<std::uint64_t>(egptr() - gptr()); }

protected:
  int_type underflow() override
  {
    const std::uint64_t left = this->End < this->Limit ? this->Limit - this->End : 0;
    this->Block.resize(std::min(left, BytesPerRead));
    if (this->Block.empty())
    {
      return traits_type::eof();
    }
    this->Source.read(this->End, this->Block.size(), this->Block.data());
    this->End += this->Block.size();
    this->show();
    return traits_type::to_int_type(*this->gptr());
  }

  pos_type seekoff(off_type off, std::ios_base::seekdir from, std::ios_base::openmode) override
  {
    if (from == std::ios_base::cur && off == 0)
    {
      return static_cast<off_type>(this->at());
    }
    const std::uint64_t base = from == std::ios_base::beg ? 0
      : from == std::ios_base::cur                        ? this->at()
                                                          : this->Source.size();
    this->enter(base + static_cast<std::uint64_t>(off), this->Limit);
    return static_cast<off_type>(this->End);
  }

  pos_type seekpos(pos_type to, std::ios_base::openmode) override
  {
    return this->seekoff(to, std::ios_base::beg, std::ios_base::in);
  }

private:
  void show()
  {
    char* bytes = reinterpret_cast<char*>(this->Block.data());
    this->setg(bytes, bytes, bytes + this->Block.size());
  }

  ByteSource& Source;
  Bytes Block;
  std::uint64_t End; ///< offset of the end of the block in the file, bytes
  std::uint64_t Limit;
};

/// Throws FormatError unless the record of the compression is equal to the record that LASzip
/// writes for such points. Versions may differ.
void checkRecord(const LazPoints& points)
{
  const Bytes own = lazRecordOf(points.layout);
  const Bytes& record = points.record;
  require(record.size() == own.size());
  const auto word = [](const Bytes& bytes, std::size_t at)
  { return load<std::uint16_t>(bytes.data() + at); };
  const auto same = [&](std::size_t at) { return word(record, at) == word(own, at); };
  // Early files of the old formats do not have chunks.
  require(same(0) || (!points.layout.extended && word(record, 0) == 1));
  require(same(2) && same(ItemsAt - 2));
  for (std::size_t at = ItemsAt; at < own.size(); at += ItemSize)
  {
    const std::uint16_t other = points.layout.extended ? 4 : 1;
    require(same(at) && same(at + 2) && (same(at + 4) || word(record, at + 4) == other));
  }
}

/// Points that are compressed together.
struct Chunk
{
  std::uint64_t points = 0;
  std::uint64_t end = 0; ///< greatest offset of the end in the file, bytes
};

class Chunks
{
public:
  Chunks(ByteSource& source, const LazPoints& points)
    : Source(source)
    , Points(points)
    , Size(load<std::uint32_t>(points.record.data() + 12))
    , Begin(points.begin)
    , End(source.size())
  {
    if (load<std::uint16_t>(points.record.data()) == 1)
    {
      this->Size = 0; // one chunk
      return;
    }
    this->Begin += 8;
    this->End = this->number<std::uint64_t>(points.begin);
    if (this->End == ~std::uint64_t{ 0 })
    {
      // The offset of the table stands at the end if the file was written to a pipe.
      require(source.size() >= 8);
      this->End = this->number<std::uint64_t>(source.size() - 8);
    }
    const std::uint64_t room = this->End > this->Begin ? this->End - this->Begin : 0;
    const std::uint64_t count = this->number<std::uint32_t>(this->End + 4);
    require(this->number<std::uint32_t>(this->End) == 0 && count > 0 &&
      count <= room / points.layout.length);
    this->checkDecoder(this->End + 8);
    if (this->Size == AnySize || this->Size == 0)
    {
      failIf(!points.layout.extended,
        "its compressed points are in chunks of several sizes, which are read only in the point "
        "data record formats 6 to 8");
      this->Size = AnySize;
    }
    else
    {
      require(points.count <= count * this->Size);
    }
  }

  std::uint64_t begin() const { return this->Begin; }
  /// Returns whether the last chunk may end at an offset. The end of a single chunk is not known.
  bool endsAt(std::uint64_t at) const { return this->Size == 0 || at == this->End; }

  /// Returns the chunk that begins at the offset `begin`, if `left` points are left.
  Chunk at(std::uint64_t begin, std::uint64_t left)
  {
    const LasLayout& layout = this->Points.layout;
    Chunk chunk{ this->Size == 0 ? left : std::min<std::uint64_t>(left, this->Size), this->End };
    std::uint64_t at = begin + layout.length; // offset after the first point
    if (!layout.extended)
    {
      this->checkDecoder(at);
      return chunk;
    }
    const std::size_t layers = CoreLayers + (layout.rgb >= 0 ? 1 : 0) + (layout.nir >= 0 ? 1 : 0) +
      layout.length - layout.core;
    const Bytes head = this->Source.bytes(at, 4 * (1 + layers));
    const std::uint64_t points = load<std::uint32_t>(head.data());
    require(points == chunk.points || (this->Size == AnySize && 0 < points && points < left));
    at += head.size();
    for (std::size_t i = 4; i < head.size(); i += 4)
    {
      const std::uint32_t size = load<std::uint32_t>(head.data() + i);
      if (size > 0)
      {
        this->checkDecoder(at);
      }
      at += size;
    }
    require(at <= this->End);
    return { points, at };
  }

private:
  template <class T>
  T number(std::uint64_t at)
  {
    require(this->Source.holds(at, sizeof(T)));
    return load<T>(this->Source.bytes(at, sizeof(T)).data());
  }

  /// Throws FormatError if a decoder would begin with 0xFFFFFFFF. Encoders do not write this value,
  /// and decoders would read beyond their tables.
  void checkDecoder(std::uint64_t at) { require(this->number<std::uint32_t>(at) != 0xFFFFFFFF); }

  ByteSource& Source;
  const LazPoints& Points;
  std::uint32_t Size; ///< number of points of a chunk, or 0 for a single chunk
  std::uint64_t Begin, End;
};

/// Writes the record of a point. A laszip_point begins as a record of the old formats.
void pack(const laszip_point& point, const LasLayout& layout, unsigned char* to)
{
  std::memcpy(to, &point, 20);
  if (layout.extended)
  {
    to[14] = static_cast<unsigned char>(
      point.extended_return_number | point.extended_number_of_returns << 4);
    to[15] = point.extended_classification_flags; // channel and direction are not needed
    to[16] = point.extended_classification;
    to[17] = point.user_data;
    store(point.extended_scan_angle, to + 18);
    store(point.point_source_ID, to + 20);
  }
  if (layout.time >= 0)
  {
    store(point.gps_time, to + layout.time);
  }
  const int colours = (layout.rgb >= 0 ? 3 : 0) + (layout.nir >= 0 ? 1 : 0);
  for (int c = 0; c < colours; ++c)
  {
    store(point.rgb[c], to + layout.rgb + 2 * c);
  }
  std::copy_n(point.extra_bytes, layout.length - layout.core, to + layout.core);
}

/// Reads the record of a point of formats 6 and 7 into a laszip_point.
void unpack(const unsigned char* from, const LasLayout& layout, laszip_point& point)
{
  std::memcpy(&point, from, 14);
  point.extended_return_number = from[14] & 15;
  point.extended_number_of_returns = from[14] >> 4;
  point.extended_classification_flags = from[15] & 15;
  // LASzip requires that the flags of the old formats agree.
  point.synthetic_flag = from[15] & 1;
  point.keypoint_flag = (from[15] >> 1) & 1;
  point.withheld_flag = (from[15] >> 2) & 1;
  point.extended_classification = from[16];
  point.user_data = from[17];
  point.extended_scan_angle = load<std::int16_t>(from + 18);
  point.point_source_ID = load<std::uint16_t>(from + 20);
  point.gps_time = load<double>(from + layout.time);
  for (int c = 0; layout.rgb >= 0 && c < 3; ++c)
  {
    point.rgb[c] = load<std::uint16_t>(from + layout.rgb + 2 * c);
  }
  std::copy_n(from + layout.core, layout.length - layout.core, point.extra_bytes);
}

/// File as LASzip writes it. LASzip ignores failures, so the first failure is kept for check().
class Output : public std::streambuf
{
public:
  Output(OutputFile& file, std::uint64_t at)
    : File(file)
    , At(at)
  {
  }

  void check() const
  {
    if (this->Failure)
    {
      std::rethrow_exception(this->Failure);
    }
  }

protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override
  {
    this->attempt([&] { this->File.write(bytes, static_cast<std::size_t>(count)); });
    this->At += static_cast<std::uint64_t>(count);
    return count;
  }

  int_type overflow(int_type c) override
  {
    const char byte = traits_type::to_char_type(c);
    this->xsputn(&byte, 1);
    return traits_type::not_eof(c);
  }

  /// Returns the current offset. LASzip calls this function only to find the offset.
  pos_type seekoff(off_type, std::ios_base::seekdir, std::ios_base::openmode) override
  {
    return static_cast<off_type>(this->At);
  }

  pos_type seekpos(pos_type to, std::ios_base::openmode) override
  {
    this->At = static_cast<std::uint64_t>(off_type(to));
    this->attempt([&] { this->File.seek(this->At); });
    return to;
  }

private:
  template <class F>
  void attempt(F work)
  {
    try
    {
      if (!this->Failure)
      {
        work();
      }
    }
    catch (...)
    {
      this->Failure = std::current_exception();
    }
  }

  OutputFile& File;
  std::uint64_t At;
  std::exception_ptr Failure;
};
}

void checkLaz(ByteSource& source, const LazPoints& points)
{
  if (points.count > 0)
  {
    checkRecord(points);
    require(points.begin >= HeaderSize + LasVlrHeaderSize + points.record.size() &&
      points.begin <= source.size());
    Chunks(source, points);
    // Two headers: the result of headerFor(), and LASzip's copy.
    requireMemory(static_cast<double>(points.begin), "bytes before the points", 2.0 * points.begin);
  }
}

void forEachLazRecord(ByteSource& source, const LazPoints& points,
  const std::function<void(std::uint64_t, const unsigned char*)>& take)
{
  if (points.count == 0)
  {
    return;
  }
  Chunks chunks(source, points);
  Input input(source, points);
  std::istream stream(&input);
  stream.exceptions(std::ios_base::badbit); // LASzip catches the exceptions
  Laszip laszip;
  laszip_BOOL compressed = 0;
  laszip.check(laszip_open_reader_stream(laszip, stream, &compressed));
  laszip.check(laszip_seek_point(laszip, 0)); // reads the table of chunks
  const laszip_point& point = laszip.point();
  Bytes bytes(points.layout.length);
  std::uint64_t at = chunks.begin();
  for (std::uint64_t i = 0; i < points.count;)
  {
    const Chunk chunk = chunks.at(at, points.count - i);
    input.enter(at, chunk.end);
    for (const std::uint64_t end = i + chunk.points; i < end; ++i)
    {
      require(laszip_read_point(laszip) == 0);
      pack(point, points.layout, bytes.data());
      take(i, bytes.data());
    }
    at = input.at();
  }
  require(chunks.endsAt(at));
}

std::vector<unsigned char> lazRecordOf(const LasLayout& layout)
{
  Laszip laszip;
  laszip.set(layout);
  laszip_U8* record = nullptr;
  laszip_U32 size = 0;
  laszip.check(laszip_create_laszip_vlr(laszip, &record, &size));
  return Bytes(record + LasVlrHeaderSize, record + size);
}

void writeLazRecords(OutputFile& file, std::uint64_t begin, const LasLayout& layout,
  std::int64_t count, const std::function<void(std::int64_t, unsigned char*)>& make)
{
  Output output(file, begin);
  std::ostream stream(&output);
  Laszip laszip;
  laszip.set(layout);
  laszip.check(laszip_open_writer_stream(laszip, stream, 1, 1));
  laszip_point& point = laszip.point();
  point.extended_point_type = 1;
  Bytes bytes(layout.length);
  for (std::int64_t i = 0; i < count; ++i)
  {
    make(i, bytes.data());
    unpack(bytes.data(), layout, point);
    laszip.check(laszip_write_point(laszip));
    output.check();
  }
  laszip.check(laszip_close_writer(laszip));
  output.check();
}

#else
namespace
{
[[noreturn]] void missing()
{
  fail("LAZ needs LASzip, which this build is without: install liblaszip-dev (Debian 13) and build "
       "again, or use LAS");
}
}

void checkLaz(ByteSource&, const LazPoints&)
{
  missing();
}

void forEachLazRecord(
  ByteSource&, const LazPoints&, const std::function<void(std::uint64_t, const unsigned char*)>&)
{
  missing();
}

std::vector<unsigned char> lazRecordOf(const LasLayout&)
{
  missing();
}

void writeLazRecords(OutputFile&, std::uint64_t, const LasLayout&, std::int64_t,
  const std::function<void(std::int64_t, unsigned char*)>&)
{
  missing();
}
#endif
}
