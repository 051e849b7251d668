// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTreeExchange.h"

#include "TreeSerialization.h"
#include "vtkAvianLidarBytes.h"

#include <algorithm>
#include <string>
#include <vector>

namespace
{
using Outcome = vtkAvianLidarRanks::Outcome;

/// What the others must know before a tree can come.
std::string HeaderOf(const avianlidar::FlatTree& flat)
{
  vtkAvianLidarByteWriter header;
  header.Put(flat.options);
  header.Put(flat.checksum);
  for (const std::size_t size : { flat.nodes.size(), flat.order.size(), flat.volumes.size() })
  {
    header.Put<std::uint64_t>(size);
  }
  return header.Bytes;
}

void MakeRoom(const std::string& bytes, avianlidar::FlatTree& flat)
{
  vtkAvianLidarByteReader header(bytes.data(), bytes.size());
  flat.options = header.Get<avianlidar::TreeOptions>();
  flat.checksum = header.Get<std::uint64_t>();
  flat.nodes.resize(header.Get<std::uint64_t>());
  flat.order.resize(header.Get<std::uint64_t>());
  flat.volumes.resize(header.Get<std::uint64_t>());
}

template <class T>
std::size_t Send(const vtkAvianLidarRanks& ranks, std::vector<T>& values, int from)
{
  ranks.Broadcast(values.data(), values.size() * sizeof(T), from);
  return values.size() * sizeof(T);
}
}

namespace vtkAvianLidarTreeExchange
{
//------------------------------------------------------------------------------
Outcome Share(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  const std::shared_ptr<const avianlidar::TriangleMesh>& mesh, int threads, Tree& tree,
  const std::function<Tree()>& build, std::size_t& sent)
{
  const std::vector<std::string> have = ranks.Gather(tree ? "1" : "");
  if (std::count(have.begin(), have.end(), "1") == ranks.Size())
  {
    return Outcome::Done;
  }
  const auto first = std::find(have.begin(), have.end(), "1");
  const int owner = first == have.end() ? 0 : static_cast<int>(first - have.begin());
  const bool own = owner == ranks.Rank();
  avianlidar::FlatTree flat;
  Outcome outcome = ranks.Together(self,
    [&]() -> std::string
    {
      if (own && !tree)
      {
        tree = build();
        if (!tree)
        {
          throw avianlidar::WorkStopped{};
        }
      }
      if (own && !ranks.Alone())
      {
        flat = avianlidar::flattenForTransfer(*tree);
      }
      return {};
    });
  if (ranks.Alone() || outcome != Outcome::Done)
  {
    return outcome;
  }
  const std::vector<std::string> headers = ranks.Gather(own ? HeaderOf(flat) : "");
  outcome = ranks.Together(self,
    [&]() -> std::string
    {
      if (!own)
      {
        MakeRoom(headers[owner], flat);
      }
      return {};
    });
  if (outcome != Outcome::Done)
  {
    return outcome;
  }
  const std::size_t bytes = Send(ranks, flat.nodes, owner) + Send(ranks, flat.order, owner) +
    Send(ranks, flat.volumes, owner);
  sent += own ? bytes : 0;
  return ranks.Together(self,
    [&]() -> std::string
    {
      if (!tree)
      {
        tree = avianlidar::restoreTransferred(mesh, std::move(flat), threads);
      }
      return {};
    });
}
}
