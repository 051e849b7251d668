// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketFormat.h
 * @brief Reads packets of a Velodyne VLP-16 from a recording of the network.
 *
 * Read: pcap (microseconds or nanoseconds, either byte order) and pcapng (its packet blocks) with
 * Ethernet, Linux's cooked capture, BSD's loopback or bare IP; of these IPv4, UDP with 1206 bytes
 * to port 2368, or to another one where they are in blocks as a Velodyne's. Other traffic is passed
 * over. Sources: draft-ietf-opsawg-pcap and draft-ietf-opsawg-pcapng; Velodyne, "VLP-16 User
 * Manual", 63-9243 (second-hand; a real revolution agrees).
 *
 * A sensor is identified by the address from which it sends and the port to which it sends. Packets
 * are taken in the order of the sensor's clock.
 *
 * A packet has 12 blocks of an azimuth and two firing sequences of 16 lasers. The azimuth of each
 * laser is interpolated to the next block by the times of the firings. Not applied: the vertical
 * offsets of the lasers, at most 11.2 mm (second-hand).
 */
#ifndef AvianLidarPacketFormat_h
#define AvianLidarPacketFormat_h

#include "ByteSource.h"
#include "CloudData.h"

namespace avianlidar::formats
{
/// Where packets and revolutions begin. A revolution ends where the azimuth passes zero.
struct PacketIndex
{
  struct Turn
  {
    std::size_t packet;
    int block;
    double time; ///< s since the full hour before the first packet; rising
  };
  std::vector<std::uint64_t> packets; ///< the lidar's bytes, from the begin of the file
  std::vector<Turn> turns;            ///< at least one
  std::string warning;                ///< what was left out; or empty
};

/// Whether a source begins like pcap or pcapng.
bool hasPackets(ByteSource& source);

/// Packets of one sensor: "192.168.1.201", "192.168.1.201:2368", or empty if there is but one.
/// Damaged packets and those behind a cut are left out, and counted. FormatError: no pcap, no whole
/// packet of a VLP-16, several sensors that fit.
PacketIndex indexPackets(ByteSource& source, const std::string& sensor, const KeepGoing& keepGoing);

/// One revolution: `intensity` (0 to 255), `laser_id` (0 is the lowest), `distance_m`, `azimuth`,
/// `vertical_angle`, `timestamp`, `return_number` (1 is the nearest), `number_of_returns`. Two
/// returns that are the same are one point.
Cloud readTurn(
  ByteSource& source, const PacketIndex& index, std::size_t turn, const KeepGoing& keepGoing);
}

#endif
