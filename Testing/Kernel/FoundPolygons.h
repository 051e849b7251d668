// SPDX-License-Identifier: BSD-3-Clause
// What beams see of all triangles of a mesh, as polygons.
#ifndef FoundPolygons_h
#define FoundPolygons_h

#include "CollisionTree.h"
#include "VisiblePolygons.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <vector>

namespace echotest
{
class FoundPolygons
{
public:
  /// See PolygonFinder.
  explicit FoundPolygons(const avianlidar::CollisionTree& tree, std::size_t mostTriangles = 100,
    std::size_t mostCandidates = 0)
    : Scene(tree)
    , Finder(this->Scene, mostTriangles, mostCandidates)
    , All(tree.mesh->size())
  {
    std::iota(this->All.begin(), this->All.end(), 0u);
  }

  /// @param reversed the triangles are given in the opposite order
  avianlidar::SeenByBeam find(const avianlidar::BeamFrame& frame, bool reversed = false)
  {
    std::vector<std::uint32_t> order = this->All;
    if (reversed)
    {
      std::reverse(order.begin(), order.end());
    }
    this->Finder.begin(frame);
    this->Finder.add(order.data(), order.size()); // find() knows if they were too many
    return this->Finder.find(this->polygons);
  }

  const std::vector<const avianlidar::BeamSurface*>& candidates() const
  {
    return this->Finder.candidates();
  }
  const avianlidar::SceneTriangles& scene() const { return this->Scene; }

  std::unique_ptr<avianlidar::VisiblePolygons> polygons; ///< those of the beam found last

private:
  const avianlidar::SceneTriangles Scene;
  avianlidar::PolygonFinder Finder;
  std::vector<std::uint32_t> All;
};
}

#endif
