// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceExchange.h
 * @brief Surfaces of all ranks reach every rank, whoever read them: one rank, all, or each a part.
 * Not installed.
 *
 * 1. Each rank hashes what it has, block by block, and all compare one hash: if all have the same,
 *    nothing is sent; nor if what the ranks have is what they had at the last exchange.
 * 2. Otherwise they list their blocks, with the hashes. A block is known by its place in the
 *    composite (its flat index); what is equal counts once, what differs are parts of one block.
 *    The lowest rank that has a part gives it to all, as a vtkPolyData with the arrays that a scan
 *    needs.
 * 3. Every rank puts the parts together: blocks in leaf order, parts of a block in the order of
 *    ranks. So the scene, its ids and its names are the same on all ranks.
 */
#ifndef vtkAvianLidarSurfaceExchange_h
#define vtkAvianLidarSurfaceExchange_h

#include "vtkAvianLidarRanks.h"

#include "vtkFieldData.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <optional>
#include <string>

class vtkAlgorithm;
class vtkDataObject;
struct vtkAvianLidarSurfaces;

class vtkAvianLidarSurfaceExchange
{
public:
  /// Merge the whole scene, of this process if it is alone, else of all ranks, which must all call
  /// it. @param input what this rank has @param what begins an error: "Input port 1, " @param known
  /// the result of the last call, which the new one shares what it can with @param result may be
  /// `known` @param threads as for vtkAvianLidarRanks::Threads()
  vtkAvianLidarRanks::Outcome Merge(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
    vtkDataObject* input, const std::string& what, int threads, const vtkAvianLidarSurfaces& known,
    vtkAvianLidarSurfaces& result);

  /// Take the next scene for another one: the result of the last call was not used.
  void Forget() { this->Known.reset(); }

  vtkSmartPointer<vtkFieldData> Fields; ///< those of the scene merged last
  double BytesSent = 0.0;               ///< what this rank gave to others, so far

private:
  struct Scene;
  vtkAvianLidarRanks::Outcome Collect(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
    vtkDataObject* input, const std::string& what, Scene& scene);
  vtkAvianLidarRanks::Outcome Send(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
    const std::string& what, std::vector<vtkMultiProcessStream>& lists, Scene& scene);

  std::optional<std::uint64_t> Known; ///< hash of what the ranks had at the last exchange
};

#endif
