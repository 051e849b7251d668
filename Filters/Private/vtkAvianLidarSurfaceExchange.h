// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceExchange.h
 * @brief Surfaces of all ranks reach every rank, whoever read them: one rank, all, or each a part.
 * Not installed.
 *
 * 1. Each rank hashes what it has, block by block, and all compare one hash: if all have the same,
 *    nothing is sent; nor if what the ranks have is what they had at the last exchange.
 * 2. Otherwise they tell each other which blocks they have, with the hashes. Blocks are told apart
 *    by their place in the composite (its flat index); what is equal counts once, what differs are
 *    parts of one block. Of each part that not every rank has, the lowest rank that has it sends
 *    triangles, points, materials, ids and names as raw arrays, without ghost cells.
 * 3. Every rank puts the parts together: blocks in leaf order, parts of a block in the order of
 *    ranks. So the scene, its ids and its names are the same on all ranks.
 */
#ifndef vtkAvianLidarSurfaceExchange_h
#define vtkAvianLidarSurfaceExchange_h

#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarSurfaceLeaf.h"

#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

class vtkAlgorithm;
class vtkAvianLidarByteReader;
class vtkAvianLidarByteWriter;
class vtkDataObject;
struct vtkAvianLidarSurfaces;

class vtkAvianLidarSurfaceExchange
{
public:
  vtkAvianLidarSurfaceExchange();
  ~vtkAvianLidarSurfaceExchange();

  /// Merge the whole scene, of this process if it is alone, else of all ranks, which must all call
  /// it. @param input what this rank has @param what begins an error: "Input port 1, " @param known
  /// the result of the last call, which the new one shares what it can with @param result may be
  /// `known` @param threads as for vtkAvianLidarRanks::Threads()
  vtkAvianLidarRanks::Outcome Merge(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
    vtkDataObject* input, const std::string& what, int threads, const vtkAvianLidarSurfaces& known,
    vtkAvianLidarSurfaces& result);

  /// Take the next scene for another one: the result of the last call was not used.
  void Forget();

  vtkSmartPointer<vtkFieldData> Fields; ///< those of the scene merged last
  std::size_t BytesSent = 0;            ///< what this rank gave to others, so far

private:
  struct Part;
  vtkAvianLidarRanks::Outcome Run(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
    vtkDataObject* input, const std::string& what);
  void Release();
  std::string LookAt(vtkDataObject* input);
  bool Remember(std::uint64_t scene);
  void Choose(const std::vector<std::string>& lists);
  void AddBlock(std::vector<Part>& block, const std::vector<Part>& mine);
  vtkAvianLidarRanks::Outcome Send(
    const vtkAvianLidarRanks& ranks, vtkAlgorithm* self, const std::vector<std::string>& lists);
  void Pack(const vtkAvianLidarRanks& ranks, vtkAvianLidarByteWriter& bytes);
  void Unpack(const vtkAvianLidarRanks& ranks, int rank, vtkAvianLidarByteReader& bytes);
  void Join();

  std::vector<vtkAvianLidarSurfaceLeaf> Leaves;   ///< of the whole scene, if it has changed
  std::vector<Part> Parts;                        ///< of this rank, then of the whole
  std::vector<vtkSmartPointer<vtkPolyData>> Kept; ///< what leaves point to
  std::string FieldBytes;                         ///< of this rank
  int FieldOwner = 0;                             ///< whose field data are those of the whole
  bool SendFields = false;
  bool Changed = false; ///< the last Run() found another scene than the one before
  bool IsKnown = false;
  std::uint64_t Known = 0; ///< hash of what the ranks had at the last exchange
};

#endif
