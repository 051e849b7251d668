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

/// A block as one rank has it.
struct Part
{
  Leaf leaf;
  std::uint64_t hash = 0;
  double bytes = 0.0;    ///< of what is sent; 0: without triangles
  int owner = 0;         ///< the lowest rank that has it
  std::size_t place = 0; ///< among the leaves of that rank
  vtkSmartPointer<vtkPolyData> data;
};

/// The parts of each block, by its index.
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

/// Hash of field data; 0 if there are none.
std::uint64_t HashOfFields(vtkTable* carrier)
{
  if (carrier->GetFieldData()->GetNumberOfArrays() == 0)
  {
    return 0;
  }
  vtkNew<vtkCharArray> bytes;
  if (!vtkCommunicator::MarshalDataObject(carrier, bytes))
  {
    throw std::bad_alloc(); // VTK had no memory to serialise it
  }
  return avianlidar::hashOf(
    bytes->GetPointer(0), static_cast<std::size_t>(bytes->GetNumberOfValues()), 0);
}

/// The same surface with the arrays that a scan needs.
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

/// What a rank says of its leaves.
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

/// What differs of the lists of all ranks, but for parts that say nothing.
/// @param fieldOwner the lowest rank that has field data, or the last
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
    // A block that is empty everywhere is an object all the same; elsewhere empty parts say
    // nothing.
    const auto full = std::stable_partition(
      block.begin(), block.end(), [](const Part& part) { return part.bytes > 0.0; });
    block.erase(std::max(full, block.begin() + 1), block.end());
  }
  return blocks;
}

/// Give parts to all ranks, as many of one rank as go into one message: many blocks of one rank are
/// what readers make. @return the first part that is left
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
      throw std::bad_alloc(); // VTK leaves out what it has no memory to write
    }
  }
  return last;
}

/// True if both have the same arrays and names, so that they can be one block.
bool AreAlike(vtkPolyData* one, vtkPolyData* other)
{
  const std::vector<vtkDataArray*> a = SurfaceArrays(one).Numbers();
  const std::vector<vtkDataArray*> b = SurfaceArrays(other).Numbers();
  const auto sameType = [](vtkDataArray* c, vtkDataArray* d)
  { return c && d ? c->GetDataType() == d->GetDataType() : c == d; };
  return std::equal(a.begin(), a.end(), b.begin(), sameType) &&
    Leaf::HashOfNames(one->GetFieldData(), 0) == Leaf::HashOfNames(other->GetFieldData(), 0);
}

/// Parts that are alike as one, in their order.
vtkSmartPointer<vtkPolyData> Join(
  std::vector<Part>::const_iterator begin, std::vector<Part>::const_iterator end)
{
  if (begin + 1 == end)
  {
    return begin->data;
  }
  vtkNew<vtkAppendPolyData> append; // keeps the arrays that all have
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

/// What is merged on this rank.
struct vtkAvianLidarSurfaceExchange::Scene
{
  std::vector<Leaf> leaves;
  std::vector<vtkSmartPointer<vtkPolyData>> kept; ///< what leaves point to
  vtkNew<vtkTable> fields; ///< VTK sends those of a vtkPolyData without points as ASCII
  bool changed = true;     ///< it is not the scene of the last exchange
};

//------------------------------------------------------------------------------
std::shared_ptr<const vtkAvianLidarSurfaces> vtkAvianLidarSurfaceExchange::Merge(
  const vtkAvianLidarRanks& ranks, vtkAlgorithm* self, vtkDataObject* input,
  const std::string& what, int threads, const std::shared_ptr<const vtkAvianLidarSurfaces>& known)
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
    this->Collect(ranks, self, input, what, scene);
  }
  std::shared_ptr<const vtkAvianLidarSurfaces> result = known;
  ranks.Together(self,
    [&]()
    {
      if (scene.changed)
      {
        result = std::make_shared<const vtkAvianLidarSurfaces>(ranks.Alone()
            ? vtkAvianLidarSurfaces::Merge(input, known.get(), share)
            : vtkAvianLidarSurfaces::Merge(scene.leaves, this->Fields, known.get(), share, false));
      }
      vtkAvianLidarRequire(result->problem, what);
    });
  return result;
}
catch (...)
{
  this->Forget(); // what was sent may not have arrived
  throw;
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Collect(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  vtkDataObject* input, const std::string& what, Scene& scene)
{
  std::vector<vtkMultiProcessStream> lists;
  std::uint64_t hash = 0;
  ranks.Together(self,
    [&]()
    {
      std::string problem;
      scene.leaves = Leaf::Collect(input, problem);
      for (const Leaf& leaf : scene.leaves)
      {
        const std::string wrong = problem.empty() ? leaf.Check(SurfaceArrays(leaf.data)) : "";
        problem = wrong.empty() ? problem : leaf.Message(wrong);
      }
      scene.fields->GetFieldData()->PassData(input->GetFieldData());
      vtkAvianLidarScene::Detach(scene.fields); // it cannot be sent
      vtkAvianLidarRequire(problem, what);
      lists.push_back(ListOf(scene.leaves, scene.fields));
      hash = HashOf(lists);
    });
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
    this->Send(ranks, self, what, lists, scene);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Send(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  const std::string& what, std::vector<vtkMultiProcessStream>& lists, Scene& scene)
{
  Blocks blocks;
  std::vector<Part*> parts; // of all blocks
  int fieldOwner = 0;
  ranks.Together(self,
    [&]()
    {
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
    });
  ranks.Broadcast(scene.fields, fieldOwner, this->BytesSent);
  for (auto next = parts.begin(); next != parts.end();)
  {
    next = Broadcast(ranks, next, parts.end(), this->BytesSent);
  }
  this->Fields = scene.fields->GetFieldData();
  const std::uint64_t some = this->Fields->GetNumberOfArrays() > 0;
  const bool received = ranks.Same(Leaf::HashOfNames(this->Fields, some));
  ranks.Together(self,
    [&]()
    {
      if (!received)
      {
        throw std::bad_alloc(); // VTK leaves out what it has no memory to read
      }
      scene.leaves.clear();
      for (const auto& [index, block] : blocks)
      {
        for (auto next = block.begin(); next != block.end();)
        {
          const auto first = next;
          next = std::find_if(first, block.end(),
            [&](const Part& part) { return !AreAlike(first->data, part.data); });
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
    });
}
