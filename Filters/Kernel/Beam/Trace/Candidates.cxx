// SPDX-License-Identifier: BSD-3-Clause
#include "Candidates.h"

#include "Descents.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Collects the triangles of leaves.
struct LeafCollector
{
  std::vector<std::uint32_t>& triangles;
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t* first, std::uint32_t count)
  {
    this->triangles.insert(this->triangles.end(), first, first + count);
    return true;
  }
};
}

void BeamCandidates::begin(
  const SceneTriangles& scene, const BeamFrame* frames, std::size_t count, bool together)
{
  const CollisionTree& tree = scene.tree();
  this->Scene = &scene;
  this->Tree = &tree;
  this->Frames = frames;
  this->Order.clear();
  this->Groups.clear();
  this->Now = { 0, 0 };
  const std::size_t beams = tree.empty() && scene.moved().empty() ? 0 : count;
  for (std::size_t first = 0; first < beams;)
  {
    this->Stretch.clear();
    const BeamFrame& begun = frames[first];
    for (; first < beams && areTogether(begun, frames[first]); ++first)
    {
      this->Stretch.push_back(static_cast<std::uint32_t>(first));
    }
    orderBeams(frames, this->Stretch, this->Keys);
    const std::size_t size = together && !tree.other ? ConeLanes::Width : 1;
    for (std::size_t k = 0; k < this->Stretch.size(); k += size)
    {
      this->Groups.push_back({ this->Order.size() + k, std::min(size, this->Stretch.size() - k) });
    }
    this->Order.insert(this->Order.end(), this->Stretch.begin(), this->Stretch.end());
  }
  std::reverse(this->Groups.begin(), this->Groups.end());
}

bool BeamCandidates::next()
{
  do
  {
    while (this->Now.count > 0)
    {
      this->Beam = this->Order[this->Now.first++];
      --this->Now.count;
      const EntryPoints* const entryPoints =
        this->FromRoot ? nullptr : &this->Work.entryPoints[this->Member++];
      if (this->collect(entryPoints))
      {
        return true;
      }
    }
  } while (this->descendNextGroup());
  return false;
}

/// Descend with the next group. @return false after the last one
bool BeamCandidates::descendNextGroup()
{
  if (this->Groups.empty())
  {
    return false;
  }
  this->Now = this->Groups.back();
  this->Groups.pop_back();
  this->Member = 0;
  this->Share = 0;
  this->FromRoot = this->Now.count == 1;
  if (this->FromRoot)
  {
    return true;
  }
  const std::uint32_t* const beams = &this->Order[this->Now.first];
  this->Work.cones.count = 0;
  for (std::size_t k = 0; k < this->Now.count; ++k)
  {
    this->Work.cones.add(this->Frames, beams + k, 1);
  }
  this->Work.cones.close();
  const std::int64_t visited =
    findEntryPoints(this->Tree->wide, this->Frames[beams[0]].origin, this->Work);
  if (visited < 0)
  {
    // The beams lie too far apart: halve the group.
    const std::size_t half = this->Now.count / 2;
    this->Groups.push_back({ this->Now.first + half, this->Now.count - half });
    this->Groups.push_back({ this->Now.first, half });
    this->Now.count = 0;
    return true;
  }
  this->Share = static_cast<std::uint64_t>(visited) / this->Now.count;
  return true;
}

/// Collect the triangles of the beam. @param entryPoints null: descend from the root @return false
/// if there are no triangles
bool BeamCandidates::collect(const EntryPoints* entryPoints)
{
  this->Triangles.clear();
  this->NodesVisited = this->Share;
  if (!this->Tree->empty() && (!entryPoints || !entryPoints->nodes.empty()))
  {
    LeafCollector leaves{ this->Triangles };
    this->NodesVisited +=
      descendCone(*this->Tree, this->Frames[this->Beam], leaves, this->Work.stack, entryPoints);
  }
  const std::vector<std::uint32_t>& moved = this->Scene->moved();
  this->Triangles.insert(this->Triangles.end(), moved.begin(), moved.end());
  return !this->Triangles.empty();
}
}
