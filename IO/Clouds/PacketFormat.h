// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketFormat.h
 * @brief Reads packets of a Velodyne VLP-16 from a recording of the network.
 *
 * The files are pcap (microseconds or nanoseconds, either byte order) or pcapng (packet blocks),
 * with Ethernet, Linux's cooked capture, BSD's loopback or raw IP. The code reads UDP over IPv4
 * with 1206 bytes, to port 2368, or to another port if the bytes have the blocks of a Velodyne's
 * packet. Other traffic is ignored. Sources: draft-ietf-opsawg-pcap and draft-ietf-opsawg-pcapng;
 * Velodyne, "VLP-16 User Manual", 63-9243 (second-hand, but checked with a real revolution).
 *
 * A sensor is identified by the address from which it sends and the port to which it sends. Packets
 * are taken in the order of the sensor's clock.
 *
 * A packet has 12 blocks. A block has an azimuth and two firing sequences of 16 lasers. The azimuth
 * of each laser is interpolated to the next block by the times of the firings. The vertical offsets
 * of the lasers, at most 11.2 mm (second-hand), are ignored.
 */
#ifndef AvianLidarPacketFormat_h
#define AvianLidarPacketFormat_h

#include "ByteSource.h"
#include "CloudData.h"

namespace avianlidar::formats
{
/// Positions of packets and starts of revolutions. A revolution ends where the azimuth passes zero.
struct PacketIndex
{
  struct Turn
  {
    std::size_t packet;
    int block;
    double time; ///< time, s since the full hour before the first packet; rising
  };
  std::vector<std::uint64_t> packets; ///< offset in the file of each payload, bytes
  std::vector<Turn> turns;            ///< starts of the revolutions, at least one
  std::string warning;                ///< sentence on packets left out, or empty
};

/// Returns whether a source begins like a pcap or pcapng file.
bool hasPackets(ByteSource& source);

/// Finds the packets of one sensor. `sensor` is an address ("192.168.1.201"), an address with a
/// port ("192.168.1.201:2368"), or empty if the file has only one sensor. Leaves out damaged
/// packets. The warning gives the number of damaged packets and the place where the file is cut
/// short. Throws FormatError if the file is not pcap or pcapng, has no whole packet of a VLP-16, or
/// if not exactly one sensor fits.
PacketIndex indexPackets(ByteSource& source, const std::string& sensor, const KeepGoing& keepGoing);

/// Reads one revolution with the columns `intensity` (0 to 255), `laser_id` (0 is the lowest),
/// `distance_m`, `azimuth`, `vertical_angle`, `timestamp`, `return_number` (1 is the nearest),
/// `number_of_returns`. Two returns at the same distance become one point.
Cloud readTurn(
  ByteSource& source, const PacketIndex& index, std::size_t turn, const KeepGoing& keepGoing);
}

#endif
