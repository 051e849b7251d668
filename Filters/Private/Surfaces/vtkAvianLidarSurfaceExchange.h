// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceExchange.h
 * @brief Gives every rank the surfaces of all ranks. Surfaces may be read by one rank, by all
 * ranks, or in part by each rank. Not installed.
 *
 * 1. Each rank hashes its surfaces, block by block, and all ranks compare one hash. Nothing is sent
 *    if all ranks have equal surfaces, or if no surfaces have changed since the last exchange.
 * 2. Otherwise the ranks list their blocks, with the hashes. Blocks with the same place in the
 *    composite (flat index) are one block. If ranks have equal data of a block, the data count
 *    once. Data that differ are parts of the block. The lowest rank that has a part sends the part
 *    to all ranks, as a vtkPolyData with the arrays that a scan needs.
 * 3. Every rank puts the parts together: blocks in leaf order, parts of a block in the order of
 *    ranks. So the scene, its ids and its names are the same on all ranks.
 */
#ifndef vtkAvianLidarSurfaceExchange_h
#define vtkAvianLidarSurfaceExchange_h

#include "vtkAvianLidarRanks.h"

#include "vtkFieldData.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

class vtkDataObject;
struct vtkAvianLidarSurfaces;

class vtkAvianLidarSurfaceExchange
{
public:
  /// Merge the scene of this process or of all ranks, which must all call this function.
  /// @param input surfaces of this rank @param what beginning of error messages, such as "Input
  /// port 1, " @param threads as for vtkAvianLidarRanks::Threads() @param known result of the last
  /// call, null at first. If no surface changed, `known` is returned. Otherwise the new result
  /// shares the mesh of `known` if the geometry is equal.
  std::shared_ptr<const vtkAvianLidarSurfaces> Merge(const vtkAvianLidarRanks& ranks,
    vtkDataObject* input, const std::string& what, int threads,
    const std::shared_ptr<const vtkAvianLidarSurfaces>& known);

  /// Treat the next scene as new, because the result of the last call was not used.
  void Forget() { this->Known.reset(); }

  vtkSmartPointer<vtkFieldData> Fields; ///< field data of the scene merged last
  double BytesSent = 0.0;               ///< bytes that this rank has sent so far

private:
  struct Scene;
  void Collect(
    const vtkAvianLidarRanks& ranks, vtkDataObject* input, const std::string& what, Scene& scene);
  void Send(const vtkAvianLidarRanks& ranks, const std::string& what,
    std::vector<vtkMultiProcessStream>& lists, Scene& scene);

  std::optional<std::uint64_t> Known; ///< hash of the ranks' surfaces at the last exchange
};

#endif
