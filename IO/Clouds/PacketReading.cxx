// SPDX-License-Identifier: BSD-3-Clause
#include "PacketFormat.h"

#include "TextLines.h"
#include "Vector.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace avianlidar::formats
{
namespace
{
constexpr std::uint64_t PayloadSize = 1206;
constexpr std::uint32_t SectionBlock = 0x0A0D0D0A; // type of a block, in either byte order
constexpr std::uint64_t UdpSize = 8;
constexpr std::uint64_t MostBeforePayload = 128; // greatest size of all headers, bytes
constexpr unsigned DataPort = 2368;
constexpr int BlocksPerPacket = 12;
constexpr int BytesPerBlock = 100;
constexpr int Lasers = 16;
constexpr std::size_t PointsPerPacket = BlocksPerPacket * 2 * Lasers;
constexpr std::size_t PacketsPerCall = 256; // number of packets between calls of KeepGoing
constexpr unsigned DualReturn = 0x39;
constexpr int FullTurn = 36000;       // azimuth of a revolution, 0.01 deg
constexpr int LargestGap = 300;       // greatest step of the azimuth, 0.01 deg (80 at 20 Hz)
constexpr double LaserTime = 2.304;   // time from one laser to the next, us
constexpr double FiringTime = 55.296; // time from one firing sequence to the next, us
constexpr double HourTime = 3.6e9;    // period of the sensor's clock, us
constexpr double LeastStep = 1e-6;    // least difference of the times of steps, s
constexpr double GreatestDelay = 1e6; // greatest delay of a packet, us

unsigned bigEndian16(const unsigned char* bytes)
{
  return unsigned{ bytes[0] } << 8 | bytes[1];
}

std::uint32_t load32(const unsigned char* bytes, bool turned)
{
  const auto value = load<std::uint32_t>(bytes);
  return turned ? __builtin_bswap32(value) : value;
}

std::uint32_t load16(const unsigned char* bytes, bool turned)
{
  return turned ? bigEndian16(bytes) : load<std::uint16_t>(bytes);
}

std::uint32_t magicOf(ByteSource& source)
{
  return source.holds(0, 24) ? load<std::uint32_t>(source.at(0, 4)) : 0;
}

bool isPcap(std::uint32_t magic)
{
  return magic == 0xA1B2C3D4 || magic == 0xD4C3B2A1 || magic == 0xA1B23C4D || magic == 0x4D3CB2A1;
}

/// Returns the offset of the IPv4 header in a packet of a link type, bytes, or at least `size` if
/// the packet does not have an IPv4 header.
std::uint64_t beginOfIp(std::uint32_t link, const unsigned char* bytes, std::uint64_t size)
{
  std::uint64_t type = 0; // offset of the number of the protocol, bytes
  switch (link)
  {
    case 1: // Ethernet
      type = 12;
      while (type + 2 <= size &&
        (bigEndian16(bytes + type) == 0x8100 || bigEndian16(bytes + type) == 0x88A8))
      {
        type += 4; // size of a tag of a virtual network
      }
      break;
    case 0:
    case 108: // BSD's loopback, which begins with 2 for IPv4 in either byte order
      return size >= 4 && (bytes[0] == 2 || bytes[3] == 2) ? 4 : size;
    case 113: // Linux's cooked capture, version 1
      type = 14;
      break;
    case 276: // Linux's cooked capture, version 2
      return size >= 2 && bigEndian16(bytes) == 0x0800 ? 20 : size;
    case 12:
    case 101:
    case 228: // raw IP
      return 0;
    default:
      return size;
  }
  return type + 2 <= size && bigEndian16(bytes + type) == 0x0800 ? type + 2 : size;
}

bool isBlock(const unsigned char* bytes)
{
  return bytes[0] == 0xFF && bytes[1] == 0xEE;
}

/// Returns whether most of the 1206 bytes are in blocks of a Velodyne.
bool hasBlocks(const unsigned char* payload)
{
  int blocks = 0;
  for (int b = 0; b < BlocksPerPacket; ++b)
  {
    blocks += isBlock(payload + b * BytesPerBlock) ? 1 : 0;
  }
  return 2 * blocks > BlocksPerPacket;
}

/// Packet of 1206 bytes that may come from a lidar.
struct Datagram
{
  std::uint64_t begin = 0; ///< offset of the lidar's bytes in the packet; 0 for other traffic
  bool isFragment = false;
  bool isForLidars = false; ///< whether the packet was sent to DataPort
  std::string sensor;       ///< address and port of the sensor
};

Datagram datagramOf(std::uint32_t link, const unsigned char* bytes, std::uint64_t size)
{
  constexpr unsigned offset = 0x1FFF, more = 0x2000;
  Datagram datagram;
  const std::uint64_t ip = beginOfIp(link, bytes, size);
  if (ip + 20 > size || bytes[ip] >> 4 != 4 || bytes[ip + 9] != 17 ||
    (bigEndian16(bytes + ip + 6) & offset) != 0)
  {
    return datagram;
  }
  const std::uint64_t udp = ip + 4 * std::uint64_t{ bytes[ip] & 0xFu };
  if (udp + UdpSize > size || bigEndian16(bytes + udp + 4) != UdpSize + PayloadSize)
  {
    return datagram;
  }
  const unsigned port = bigEndian16(bytes + udp + 2);
  datagram.begin = udp + UdpSize;
  datagram.isFragment = (bigEndian16(bytes + ip + 6) & more) != 0;
  datagram.isForLidars = port == DataPort;
  for (int i = 0; i < 4; ++i)
  {
    datagram.sensor += (i > 0 ? "." : "") + std::to_string(bytes[ip + 12 + i]);
  }
  datagram.sensor += ":" + std::to_string(port);
  return datagram;
}

/// Calls packet(link type, offset, number of recorded bytes) for each packet.
template <class F>
void forEachPacket(ByteSource& source, F packet)
{
  const auto need = [&](std::uint64_t at, std::uint64_t count)
  {
    failIf(!source.holds(at, count), "it is cut short: a packet that begins at byte ", at,
      " goes beyond its end, and the last ", source.size() - at, " bytes are left out");
    return source.at(at, std::min(count, MostBeforePayload));
  };
  const std::uint32_t first = magicOf(source);
  if (isPcap(first))
  {
    const bool turned = (first & 0xFF) == 0xA1;
    const std::uint32_t link = load32(source.at(0, 24) + 20, turned) & 0xFFFF;
    for (std::uint64_t at = 24; at < source.size();)
    {
      const std::uint64_t size = load32(need(at, 16) + 8, turned);
      need(at, 16 + size);
      packet(link, at + 16, size);
      at += 16 + size;
    }
    return;
  }
  failIf(first != SectionBlock, "this is not a pcap or pcapng file");
  bool turned = false;
  std::vector<std::uint32_t> links;
  for (std::uint64_t at = 0; at < source.size();)
  {
    const unsigned char* head = need(at, 12);
    if (load<std::uint32_t>(head) == SectionBlock)
    {
      turned = load<std::uint32_t>(head + 8) == 0x4D3C2B1A;
      links.clear();
    }
    const std::uint32_t kind = load32(head, turned);
    const std::uint64_t size = load32(head + 4, turned);
    // Packet blocks are enhanced (6), simple (3), or obsolete (2) with the layout of enhanced
    // blocks.
    const bool isEnhanced = kind == 6 || kind == 2;
    const std::uint64_t least = isEnhanced ? 32 : kind == 1 || kind == 3 ? 16 : 12;
    failIf(size < least || size % 4 != 0, "the block at byte ", at, " has the length ", size,
      ", expected at least ", least,
      " and a multiple of 4: this block and the rest of the file are left out");
    const unsigned char* block = need(at, size);
    const std::uint32_t number = kind == 6 ? load32(block + 8, turned)
      : kind == 2                          ? load16(block + 8, turned)
                                           : 0; // number of the interface
    if (kind == 1)
    {
      links.push_back(load16(block + 8, turned));
    }
    else if ((kind == 3 || isEnhanced) && number < links.size())
    {
      const std::uint64_t before = isEnhanced ? 28 : 12;
      const std::uint64_t captured = load32(block + (isEnhanced ? 20 : 8), turned);
      packet(links[number], at + before, std::min(captured, size - before - 4));
    }
    at += size;
  }
}

/// Returns the fault of a packet of a VLP-16, or an empty text.
std::string problemOf(const unsigned char* bytes)
{
  if (bytes[1205] != 0x22)
  {
    return "is of the product " + std::to_string(bytes[1205]) + ", expected 34, a VLP-16";
  }
  if (bytes[1204] < 0x37 || bytes[1204] > DualReturn)
  {
    return "has the return mode " + std::to_string(bytes[1204]) +
      ", expected 55 (strongest), 56 (last) or 57 (dual)";
  }
  constexpr std::uint32_t hour = 3'600'000'000u; // duration, us
  if (load<std::uint32_t>(bytes + 1200) > hour)
  {
    return "has a time beyond the hour";
  }
  for (int b = 0; b < BlocksPerPacket; ++b)
  {
    const unsigned char* block = bytes + b * BytesPerBlock;
    if (!isBlock(block) || load<std::uint16_t>(block + 2) >= FullTurn)
    {
      return "has no azimuth below 360 deg in block " + std::to_string(b);
    }
  }
  return {};
}

int azimuthOf(const unsigned char* payload, int block)
{
  return load<std::uint16_t>(payload + block * BytesPerBlock + 2);
}

/// Time since the full hour before the first packet, us.
struct HourClock
{
  double hours = 0.0;
  double last = 0.0;

  double timeOfPacket(const unsigned char* payload)
  {
    const double time = load<std::uint32_t>(payload + 1200);
    this->hours += time < this->last - 0.5 * HourTime ? HourTime : 0.0;
    this->last = time;
    return this->hours + time;
  }
};

/// Returns the number of blocks of one firing, which is two in dual mode.
int blocksAtOnce(const unsigned char* payload)
{
  return payload[1204] == DualReturn ? 2 : 1;
}

/// Returns the time from the time of the packet to the begin of a block, us.
double offsetOfBlock(const unsigned char* payload, int block)
{
  return 2.0 * FiringTime * (block / blocksAtOnce(payload));
}

struct TurnPoints
{
  Cloud cloud;
  std::vector<double> distance, azimuth, elevation, time;
  std::vector<std::uint8_t> intensity, laser, number, count;

  void add(const unsigned char* value, int channel, double turned, double moment, int i, int n)
  {
    const double range = 0.002 * load<std::uint16_t>(value);
    // Lasers at -15, 1, -13, 3, ..., -1, 15 deg fire in this order.
    const int ring = channel / 2 + (channel % 2) * Lasers / 2;
    const double up = 2.0 * ring - 15.0;
    const double a = RadiansPerDegree * turned / 100.0;
    const double e = RadiansPerDegree * up;
    const double flat = range * std::cos(e);
    this->cloud.points.insert(
      this->cloud.points.end(), { flat * std::sin(a), flat * std::cos(a), range * std::sin(e) });
    this->distance.push_back(range);
    this->azimuth.push_back(turned);
    this->elevation.push_back(up);
    this->time.push_back(moment);
    this->intensity.push_back(value[2]);
    this->laser.push_back(static_cast<std::uint8_t>(ring));
    this->number.push_back(static_cast<std::uint8_t>(i));
    this->count.push_back(static_cast<std::uint8_t>(n));
  }
};

/// Adds the points of the two firing sequences of a block and, in dual mode, of the next block.
void addBlock(TurnPoints& points, const unsigned char* payload, int block, double time, double gap)
{
  const int returns = blocksAtOnce(payload);
  for (int firing = 0; firing < 2 * Lasers; ++firing)
  {
    const double after = FiringTime * (firing / Lasers) + LaserTime * (firing % Lasers);
    double turned = azimuthOf(payload, block) + gap * after / (2.0 * FiringTime);
    turned -= turned < FullTurn ? 0.0 : FullTurn;
    const double moment = time + offsetOfBlock(payload, block) + after;
    const unsigned char* near = payload + block * BytesPerBlock + 4 + 3 * firing;
    const unsigned char* far = near + (returns - 1) * BytesPerBlock;
    int n = load<std::uint16_t>(near) == load<std::uint16_t>(far) ? 1 : 2;
    if (load<std::uint16_t>(near) > load<std::uint16_t>(far))
    {
      std::swap(near, far);
    }
    if (load<std::uint16_t>(near) == 0)
    {
      near = far;
      n = load<std::uint16_t>(far) == 0 ? 0 : 1;
    }
    for (int i = 1; i <= n; ++i)
    {
      points.add(i == 1 ? near : far, firing % Lasers, turned, moment, i, n);
    }
  }
}

/// Offset of a packet in the file, and the time when the sensor sent the packet.
struct SentPacket
{
  int epoch = 0;     ///< number of times that the sensor's clock went back before
  double time = 0.0; ///< time of the sensor's clock, us
  std::uint64_t begin = 0;
};

/// Packets of one sensor.
struct Sender
{
  std::vector<SentPacket> packets;
  std::size_t damaged = 0;
  std::string problem; ///< fault of the first damaged packet
  int epoch = 0;
  double latest = 0.0; ///< latest time in this epoch, us

  void add(std::uint64_t begin, const unsigned char* payload)
  {
    const double time = load<std::uint32_t>(payload + 1200);
    const bool goesBack = time < this->latest - GreatestDelay;
    const bool isLate = this->epoch > 0 && time > this->latest + 0.5 * HourTime;
    this->epoch += goesBack ? 1 : 0;
    this->packets.push_back({ this->epoch - (isLate ? 1 : 0), time, begin });
    this->latest = goesBack ? time : isLate ? this->latest : std::max(this->latest, time);
  }

  void leaveOut(const std::string& what)
  {
    if (this->damaged++ == 0)
    {
      this->problem = "packet " + std::to_string(this->packets.size()) + " of the lidar " + what;
    }
  }
};

struct Recording
{
  std::map<std::string, Sender> senders; ///< packets of each address and port
  std::string cut;                       ///< reason why the recording is cut short, or empty
};

Recording scanPackets(ByteSource& source, const KeepGoing& keepGoing)
{
  Recording recording;
  std::size_t number = 0;
  const auto take = [&](std::uint32_t link, std::uint64_t at, std::uint64_t size)
  {
    if (number++ % PacketsPerCall == 0)
    {
      goOn(keepGoing, 0.5 * static_cast<double>(at) / static_cast<double>(source.size()));
    }
    const std::uint64_t looked = std::min(size, MostBeforePayload);
    const Datagram datagram = datagramOf(link, source.at(at, looked), looked);
    const bool isWhole = datagram.begin + PayloadSize <= size;
    const unsigned char* payload =
      datagram.begin > 0 && isWhole ? source.at(at + datagram.begin, PayloadSize) : nullptr;
    if (datagram.begin == 0 || (!datagram.isForLidars && !(payload && hasBlocks(payload))))
    {
      return;
    }
    Sender& sender = recording.senders[datagram.sensor];
    const std::string problem = datagram.isFragment
      ? "is in fragments of IP, expected whole packets"
      : payload ? problemOf(payload)
                : "has " + std::to_string(size - datagram.begin) +
        " of its 1206 bytes: it was not recorded whole";
    problem.empty() ? sender.add(at + datagram.begin, payload) : sender.leaveOut(problem);
  };
  try
  {
    forEachPacket(source, take);
  }
  catch (const FormatError& error)
  {
    if (recording.senders.empty())
    {
      throw;
    }
    recording.cut = error.what();
  }
  return recording;
}

/// Returns the wanted sensor, given by its address with or without its port. An empty text fits all
/// sensors. Throws FormatError unless one sensor fits.
Sender& choose(std::map<std::string, Sender>& senders, const std::string& wanted)
{
  std::vector<Sender*> fitting;
  std::string all;
  for (auto& [name, sender] : senders)
  {
    if (wanted.empty() || wanted == name || wanted == name.substr(0, name.find(':')))
    {
      fitting.push_back(&sender);
    }
    all += (all.empty() ? "" : ", ") + name + " (" +
      std::to_string(sender.packets.size() + sender.damaged) + " packets)";
  }
  failIf(senders.empty(), "it has no packet of a VLP-16: UDP with 1206 bytes");
  failIf(fitting.empty(), "it has no packets of the sensor ", shown(wanted),
    ", expected the SensorAddress (--sensor-address) of one of these: ", all);
  failIf(fitting.size() > 1,
    "it has packets of several sensors, expected the SensorAddress (--sensor-address) of one of "
    "these: ",
    all);
  return *fitting.front();
}

/// Leaves out packets that were recorded twice, as by two interfaces. Returns the number of such
/// packets.
std::size_t dropCopies(ByteSource& source, std::vector<SentPacket>& packets)
{
  unsigned char before[PayloadSize] = {};
  const auto isCopy = [&](const SentPacket& a, const SentPacket& b)
  {
    if (a.epoch != b.epoch || a.time != b.time)
    {
      return false;
    }
    std::copy_n(source.at(a.begin, PayloadSize), PayloadSize, before);
    return std::equal(before, before + PayloadSize, source.at(b.begin, PayloadSize));
  };
  const auto end = std::unique(packets.begin(), packets.end(), isCopy);
  const auto copies = static_cast<std::size_t>(packets.end() - end);
  packets.erase(end, packets.end());
  return copies;
}

/// Throws FormatError if two sensors sent the packets. The azimuth of two sensors often goes back,
/// by more than the jitter of a motor that stands still.
void checkOneSensor(ByteSource& source, const std::vector<std::uint64_t>& packets)
{
  std::size_t backwards = 0;
  int before = -1;
  for (const std::uint64_t at : packets)
  {
    const int azimuth = azimuthOf(source.at(at, PayloadSize), 0);
    const int back = before < 0 ? 0 : (before - azimuth + FullTurn) % FullTurn;
    backwards += back > LargestGap && back < FullTurn / 2 ? 1 : 0;
    before = azimuth;
  }
  failIf(4 * backwards > packets.size(),
    "its packets come from more than one sensor with the same address: the azimuth goes back ",
    backwards, " times in ", packets.size(),
    " packets. Expected another address or port for each sensor");
}

/// Returns the starts of the revolutions.
std::vector<PacketIndex::Turn> turnsOf(
  ByteSource& source, const std::vector<std::uint64_t>& packets, const KeepGoing& keepGoing)
{
  std::vector<PacketIndex::Turn> turns;
  int before = -1;
  HourClock clock;
  for (std::size_t number = 0; number < packets.size(); ++number)
  {
    const unsigned char* payload = source.at(packets[number], PayloadSize);
    const double time = clock.timeOfPacket(payload);
    for (int block = 0; block < BlocksPerPacket; block += blocksAtOnce(payload))
    {
      const int azimuth = azimuthOf(payload, block);
      if (before < 0 || azimuth < before - FullTurn / 2)
      {
        const double seconds = 1e-6 * (time + offsetOfBlock(payload, block));
        turns.push_back({ number, block,
          turns.empty() ? seconds : std::max(seconds, turns.back().time + LeastStep) });
      }
      before = azimuth;
    }
    if (number % PacketsPerCall == 0)
    {
      goOn(keepGoing, 0.5);
    }
  }
  return turns;
}
}

bool hasPackets(ByteSource& source)
{
  const std::uint32_t magic = magicOf(source);
  return isPcap(magic) || magic == SectionBlock;
}

PacketIndex indexPackets(ByteSource& source, const std::string& sensor, const KeepGoing& keepGoing)
{
  Recording recording = scanPackets(source, keepGoing);
  Sender& sender = choose(recording.senders, sensor);
  failIf(sender.packets.empty(), sender.problem);
  // Networks may change the order of packets.
  std::stable_sort(sender.packets.begin(), sender.packets.end(),
    [](const SentPacket& a, const SentPacket& b)
    { return a.epoch != b.epoch ? a.epoch < b.epoch : a.time < b.time; });
  const std::size_t copies = dropCopies(source, sender.packets);
  PacketIndex index;
  for (const SentPacket& packet : sender.packets)
  {
    index.packets.push_back(packet.begin);
  }
  checkOneSensor(source, index.packets);
  index.turns = turnsOf(source, index.packets, keepGoing);
  if (sender.damaged > 0)
  {
    index.warning = std::to_string(sender.damaged) + " of " +
      std::to_string(sender.packets.size() + sender.damaged) +
      " packets of the lidar are left out: " + sender.problem;
  }
  if (copies > 0)
  {
    index.warning += (index.warning.empty() ? "" : "; ") + std::to_string(copies) +
      " packets were recorded twice, and are taken once";
  }
  if (!recording.cut.empty())
  {
    index.warning += (index.warning.empty() ? "" : "; ") + recording.cut;
  }
  return index;
}

Cloud readTurn(
  ByteSource& source, const PacketIndex& index, std::size_t turn, const KeepGoing& keepGoing)
{
  const PacketIndex::Turn& from = index.turns[turn];
  const PacketIndex::Turn to = turn + 1 < index.turns.size()
    ? index.turns[turn + 1]
    : PacketIndex::Turn{ index.packets.size(), 0, 0.0 };
  const std::size_t packets = to.packet - from.packet + 1;
  requireMemoryFor(packets * PointsPerPacket, sizeof(double));
  TurnPoints points;
  double gap = 0.0; // azimuth from one firing to the next, 0.01 deg
  HourClock clock;
  unsigned char payload[PayloadSize];
  for (std::size_t p = from.packet; p < index.packets.size() && p <= to.packet; ++p)
  {
    std::copy_n(source.at(index.packets[p], PayloadSize), PayloadSize, payload);
    const std::string problem = problemOf(payload);
    // The file may have changed since indexPackets().
    failIf(!problem.empty(), "packet ", p, " of the lidar ", problem);
    const int behind = p + 1 < index.packets.size()
      ? azimuthOf(source.at(index.packets[p + 1], PayloadSize), 0)
      : -1;
    const int step = blocksAtOnce(payload);
    const double time = clock.timeOfPacket(payload);
    if (p == from.packet) // sets the hour of the index
    {
      const double since = 1e6 * from.time - offsetOfBlock(payload, from.block) - time;
      clock.hours = HourTime * std::round(since / HourTime);
    }
    const int end = p == to.packet ? to.block : BlocksPerPacket;
    const int begin = p == from.packet ? from.block / step * step : 0;
    for (int block = begin; block < end; block += step)
    {
      const int next = block + step < BlocksPerPacket ? azimuthOf(payload, block + step) : behind;
      const int difference = (next - azimuthOf(payload, block) + FullTurn) % FullTurn;
      gap = next >= 0 && difference <= LargestGap ? difference : gap;
      addBlock(points, payload, block, clock.hours + clock.last, gap);
    }
    if (p % PacketsPerCall == 0)
    {
      const auto done = static_cast<double>(p - from.packet);
      goOn(keepGoing, 0.5 + 0.5 * done / static_cast<double>(packets));
    }
  }
  Cloud& cloud = points.cloud;
  cloud.columns.push_back({ "intensity", "1", 1, std::move(points.intensity) });
  cloud.columns.push_back({ "laser_id", "", 1, std::move(points.laser) });
  cloud.columns.push_back({ "distance_m", "m", 1, std::move(points.distance) });
  cloud.columns.push_back({ "azimuth", "0.01 deg", 1, std::move(points.azimuth) });
  cloud.columns.push_back({ "vertical_angle", "deg", 1, std::move(points.elevation) });
  cloud.columns.push_back({ "timestamp", "us", 1, std::move(points.time) });
  cloud.columns.push_back({ "return_number", "1", 1, std::move(points.number) });
  cloud.columns.push_back({ "number_of_returns", "1", 1, std::move(points.count) });
  cloud.notes.push_back({ "revolution", "", { static_cast<double>(turn) }, {} });
  cloud.notes.push_back(
    { "number_of_revolutions", "1", { static_cast<double>(index.turns.size()) }, {} });
  cloud.sensor = Point{ 0.0, 0.0, 0.0 };
  return std::move(cloud);
}
}
