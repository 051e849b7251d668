// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceExchange.h"

#include "Hash.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarScene.h"
#include "vtkAvianLidarSurfaceLeaf.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkAppendPolyData.h"
#include "vtkCellData.h"
#include "vtkCharArray.h"
#include "vtkCommunicator.h"
#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <map>
#include <new>
#include <vector>

namespace
{
using Leaf = vtkAvianLidarSurfaceLeaf;
using SurfaceArrays = vtkAvianLidarSurfaceArrays;
namespace names = vtkAvianLidarArrays;

/// The part of a block that one rank has.
struct Part
{
  Leaf leaf;
  std::uint64_t hash = 0;
  double bytes = 0.0;    ///< size of the data to send, bytes; 0: no triangles
  int owner = 0;         ///< lowest rank that has the part
  std::size_t place = 0; ///< index among the leaves of the owner
  vtkSmartPointer<vtkPolyData> data;
};

/// The parts of each block, by the index of the block.
using Blocks = std::map<unsigned int, std::vector<Part>>;

std::uint64_t HashOf(const std::vector<vtkMultiProcessStream>& lists)
{
  std::uint64_t hash = 0;
  for (const vtkMultiProcessStream& list : lists)
  {
    std::vector<unsigned char> bytes;
    list.GetRawData(bytes);
    hash = avianlidar::hashOf(bytes.data(), bytes.size(), hash);
  }
  return hash;
}

/// Hash of field data; 0 without arrays.
std::uint64_t HashOfFields(vtkTable* carrier)
{
  if (carrier->GetFieldData()->GetNumberOfArrays() == 0)
  {
    return 0;
  }
  vtkNew<vtkCharArray> bytes;
  if (!vtkCommunicator::MarshalDataObject(carrier, bytes))
  {
    throw std::bad_alloc(); // VTK had no memory to serialise the data
  }
  return avianlidar::hashOf(
    bytes->GetPointer(0), static_cast<std::size_t>(bytes->GetNumberOfValues()), 0);
}

/// A surface with only the arrays that a scan needs.
vtkSmartPointer<vtkPolyData> Lean(vtkPolyData* surface)
{
  auto lean = vtkSmartPointer<vtkPolyData>::New();
  lean->CopyStructure(surface);
  const SurfaceArrays a(surface);
  std::vector<vtkDataArray*> arrays = a.Numbers();
  arrays.push_back(a.ghosts);
  for (vtkDataArray* array : arrays)
  {
    if (array)
    {
      lean->GetCellData()->AddArray(array);
    }
  }
  for (const names::Name& name : names::SurfaceTexts)
  {
    if (vtkAbstractArray* array = surface->GetFieldData()->GetAbstractArray(name.name))
    {
      lean->GetFieldData()->AddArray(array);
    }
  }
  return lean;
}

/// Names, hashes and sizes of a rank's leaves, and the hash of the field data, for the other ranks.
vtkMultiProcessStream ListOf(const std::vector<Leaf>& leaves, vtkTable* fields)
{
  vtkMultiProcessStream list;
  list << vtkTypeUInt64{ HashOfFields(fields) };
  for (const Leaf& leaf : leaves)
  {
    const bool empty = leaf.data->GetNumberOfPolys() + leaf.data->GetNumberOfStrips() == 0;
    list << leaf.index << static_cast<int>(leaf.named) << leaf.name
         << vtkTypeUInt64{ Leaf::HashOf(leaf.data) }
         << (empty ? 0.0 : vtkAvianLidarRanks::BytesOf(Lean(leaf.data)));
  }
  return list;
}

Part ReadPart(vtkMultiProcessStream& list)
{
  Part part;
  int named = 0;
  vtkTypeUInt64 hash = 0;
  list >> part.leaf.index >> named >> part.leaf.name >> hash >> part.bytes;
  part.leaf.named = named != 0;
  part.hash = hash;
  return part;
}

/// The different parts of all blocks of all ranks, without parts that are not needed.
/// @param fieldOwner lowest rank that has field data; without field data, the last rank
Blocks BlocksOf(std::vector<vtkMultiProcessStream>& lists, int& fieldOwner)
{
  Blocks blocks;
  const int ranks = static_cast<int>(lists.size());
  fieldOwner = ranks - 1;
  for (int rank = 0; rank < ranks; ++rank)
  {
    vtkMultiProcessStream& list = lists[rank];
    vtkTypeUInt64 fieldHash = 0;
    list >> fieldHash;
    fieldOwner = fieldHash != 0 ? std::min(fieldOwner, rank) : fieldOwner;
    for (std::size_t place = 0; !list.Empty(); ++place)
    {
      Part part = ReadPart(list);
      part.owner = rank;
      part.place = place;
      std::vector<Part>& block = blocks[part.leaf.index];
      if (std::none_of(
            block.begin(), block.end(), [&](const Part& known) { return known.hash == part.hash; }))
      {
        block.push_back(part);
      }
    }
  }
  for (auto& [index, block] : blocks)
  {
    // A block that is empty on all ranks is still an object, so one part is kept. Other empty parts
    // are not needed.
    const auto full = std::stable_partition(
      block.begin(), block.end(), [](const Part& part) { return part.bytes > 0.0; });
    block.erase(std::max(full, block.begin() + 1), block.end());
  }
  return blocks;
}

/// Send the next parts of one rank to all ranks, as many parts as fit into one message, because
/// readers often make many blocks on one rank. @return first part that was not sent
std::vector<Part*>::iterator Broadcast(const vtkAvianLidarRanks& ranks,
  std::vector<Part*>::iterator begin, std::vector<Part*>::iterator end, double& sent)
{
  const int owner = (*begin)->owner;
  double bytes = 0.0;
  vtkNew<vtkPartitionedDataSet> message;
  unsigned int count = 0;
  auto last = begin;
  for (; last != end && (*last)->owner == owner &&
       (last == begin || bytes + (*last)->bytes < vtkAvianLidarRanks::MostBytes);
       ++last)
  {
    bytes += (*last)->bytes;
    message->SetPartition(count++, (*last)->data);
  }
  ranks.Broadcast(message, owner, sent);
  count = 0;
  for (auto part = begin; part != last; ++part)
  {
    (*part)->data = vtkPolyData::SafeDownCast(message->GetPartition(count++));
    if (!(*part)->data)
    {
      throw std::bad_alloc(); // VTK leaves out parts that it has no memory to write
    }
  }
  return last;
}

/// True if two surfaces have the same arrays and names, so that the surfaces can be one block.
bool AreAlike(vtkPolyData* one, vtkPolyData* other)
{
  const std::vector<vtkDataArray*> a = SurfaceArrays(one).Numbers();
  const std::vector<vtkDataArray*> b = SurfaceArrays(other).Numbers();
  const auto sameType = [](vtkDataArray* c, vtkDataArray* d)
  { return c && d ? c->GetDataType() == d->GetDataType() : c == d; };
  return std::equal(a.begin(), a.end(), b.begin(), sameType) &&
    Leaf::HashOfNames(one->GetFieldData(), 0) == Leaf::HashOfNames(other->GetFieldData(), 0);
}

/// One surface of parts that are alike, in the order of the parts.
vtkSmartPointer<vtkPolyData> Join(
  std::vector<Part>::const_iterator begin, std::vector<Part>::const_iterator end)
{
  if (begin + 1 == end)
  {
    return begin->data;
  }
  vtkNew<vtkAppendPolyData> append; // keeps the arrays that all parts have
  for (auto part = begin; part != end; ++part)
  {
    if (!SurfaceArrays(part->data).ghosts)
    {
      vtkNew<vtkUnsignedCharArray> none;
      none->SetName(vtkDataSetAttributes::GhostArrayName());
      names::SetTuples(none.Get(), part->data->GetNumberOfCells());
      none->Fill(0);
      part->data->GetCellData()->AddArray(none);
    }
    append->AddInputData(part->data);
  }
  append->Update();
  return append->GetOutput();
}
}

/// The surfaces that are merged on this rank.
struct vtkAvianLidarSurfaceExchange::Scene
{
  std::vector<Leaf> leaves;
  std::vector<vtkSmartPointer<vtkPolyData>> kept; ///< data to which leaves point
  vtkNew<vtkTable> fields; ///< field data; VTK sends field data of an empty vtkPolyData as ASCII
  bool changed = true;     ///< false for the scene of the last exchange
};

//------------------------------------------------------------------------------
std::shared_ptr<const vtkAvianLidarSurfaces> vtkAvianLidarSurfaceExchange::Merge(
  const vtkAvianLidarRanks& ranks, vtkDataObject* input, const std::string& what, int threads,
  const std::shared_ptr<const vtkAvianLidarSurfaces>& known)
try
{
  const int share = ranks.Threads(threads);
  Scene scene;
  if (ranks.Alone())
  {
    this->Forget();
    this->Fields = input->GetFieldData();
  }
  else
  {
    this->Collect(ranks, input, what, scene);
  }
  std::shared_ptr<const vtkAvianLidarSurfaces> result = known;
  if (scene.changed)
  {
    result = std::make_shared<const vtkAvianLidarSurfaces>(ranks.Alone()
        ? vtkAvianLidarSurfaces::Merge(input, known.get(), share)
        : vtkAvianLidarSurfaces::Merge(scene.leaves, this->Fields, known.get(), share, false));
  }
  vtkAvianLidarRequire(result->problem, what);
  return result;
}
catch (...)
{
  this->Forget(); // other ranks may not have received the surfaces
  throw;
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Collect(
  const vtkAvianLidarRanks& ranks, vtkDataObject* input, const std::string& what, Scene& scene)
{
  std::vector<vtkMultiProcessStream> lists;
  std::uint64_t hash = 0;
  std::string problem;
  scene.leaves = Leaf::Collect(input, problem);
  for (const Leaf& leaf : scene.leaves)
  {
    const std::string wrong = problem.empty() ? leaf.Check(SurfaceArrays(leaf.data)) : "";
    problem = wrong.empty() ? problem : leaf.Message(wrong);
  }
  scene.fields->GetFieldData()->PassData(input->GetFieldData());
  vtkAvianLidarScene::Detach(scene.fields); // a scene cannot be sent
  vtkAvianLidarRequire(problem, what);
  lists.push_back(ListOf(scene.leaves, scene.fields));
  hash = HashOf(lists);
  const bool same = ranks.Same(hash);
  if (same)
  {
    this->Fields = input->GetFieldData();
  }
  else
  {
    lists = ranks.Gather(lists[0]);
    hash = HashOf(lists);
  }
  scene.changed = !ranks.All(this->Known == hash);
  this->Known = hash;
  if (!same && scene.changed)
  {
    this->Send(ranks, what, lists, scene);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Send(const vtkAvianLidarRanks& ranks, const std::string& what,
  std::vector<vtkMultiProcessStream>& lists, Scene& scene)
{
  Blocks blocks;
  std::vector<Part*> parts; // parts of all blocks
  int fieldOwner = 0;
  std::string wrong = vtkAvianLidarRanks::CheckSize(scene.fields);
  wrong = wrong.empty() ? wrong : "field data of the surfaces: " + wrong;
  blocks = BlocksOf(lists, fieldOwner);
  for (auto& [index, block] : blocks)
  {
    for (Part& part : block)
    {
      parts.push_back(&part);
      if (part.owner == ranks.Rank())
      {
        part.data = Lean(scene.leaves[part.place].data);
        const std::string large = vtkAvianLidarRanks::CheckSize(part.data);
        wrong = large.empty() ? wrong : part.leaf.Message(large);
      }
    }
  }
  vtkAvianLidarRequire(wrong, what);
  ranks.Broadcast(scene.fields, fieldOwner, this->BytesSent);
  for (auto next = parts.begin(); next != parts.end();)
  {
    next = Broadcast(ranks, next, parts.end(), this->BytesSent);
  }
  this->Fields = scene.fields->GetFieldData();
  const std::uint64_t some = this->Fields->GetNumberOfArrays() > 0;
  const bool received = ranks.Same(Leaf::HashOfNames(this->Fields, some));
  if (!received)
  {
    throw std::bad_alloc(); // VTK leaves out arrays that it has no memory to read
  }
  scene.leaves.clear();
  for (const auto& [index, block] : blocks)
  {
    for (auto next = block.begin(); next != block.end();)
    {
      const auto first = next;
      next = std::find_if(
        first, block.end(), [&](const Part& part) { return !AreAlike(first->data, part.data); });
      scene.kept.push_back(Join(first, next));
      Leaf leaf = block[0].leaf;
      leaf.data = scene.kept.back();
      if (!leaf.named && !leaf.name.empty())
      {
        leaf.name = Leaf::NameOfBlock(scene.leaves.size());
      }
      scene.leaves.push_back(leaf);
    }
  }
}
