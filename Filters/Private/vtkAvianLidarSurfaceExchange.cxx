// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceExchange.h"

#include "Hash.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBytes.h"
#include "vtkAvianLidarSurfacePart.h"
#include "vtkAvianLidarSurfaceState.h"
#include "vtkAvianLidarTreeAccess.h"

#include "vtkCharArray.h"
#include "vtkCommunicator.h"
#include "vtkDataObject.h"

#include <algorithm>
#include <exception>
#include <map>
#include <stdexcept>

namespace
{
using Outcome = vtkAvianLidarRanks::Outcome;
using Leaf = vtkAvianLidarSurfaceLeaf;
namespace Parts = vtkAvianLidarSurfacePart;

std::uint64_t HashOf(const std::string& bytes)
{
  return avianlidar::hashOf(bytes.data(), bytes.size(), 0);
}

/// Field data but for those of a tree, which goes its own way; empty if there are none.
std::string BytesOf(vtkFieldData* fields)
{
  vtkNew<vtkPolyData> carrier;
  carrier->GetFieldData()->PassData(fields);
  vtkAvianLidarTreeAccess::Detach(carrier);
  if (carrier->GetFieldData()->GetNumberOfArrays() == 0)
  {
    return {};
  }
  vtkNew<vtkCharArray> bytes;
  vtkCommunicator::MarshalDataObject(carrier, bytes);
  return std::string(bytes->GetPointer(0), static_cast<std::size_t>(bytes->GetNumberOfValues()));
}

vtkSmartPointer<vtkFieldData> FieldsOf(const std::string& bytes)
{
  auto fields = vtkSmartPointer<vtkFieldData>::New();
  if (bytes.empty())
  {
    return fields;
  }
  vtkNew<vtkCharArray> array;
  vtkAvianLidarArrays::SetTuples(array.Get(), static_cast<vtkIdType>(bytes.size()));
  std::copy(bytes.begin(), bytes.end(), array->GetPointer(0));
  vtkNew<vtkPolyData> carrier;
  if (!vtkCommunicator::UnMarshalDataObject(array, carrier))
  {
    throw std::runtime_error("Field data of the surfaces cannot be read as another rank sent them");
  }
  fields->ShallowCopy(carrier->GetFieldData());
  return fields;
}
}

/// Of one block: on this rank, or of the whole scene.
struct vtkAvianLidarSurfaceExchange::Part
{
  Leaf leaf; ///< its data are null while only others have them
  std::uint64_t hash = 0;
  bool empty = false;
  int owner = 0;   ///< the lowest rank that has it
  int holders = 0; ///< ranks that have it

  void Write(vtkAvianLidarByteWriter& list) const
  {
    list.Put(this->leaf.index);
    list.Put<char>(this->leaf.named);
    list.Put(this->leaf.name);
    list.Put(this->hash);
    list.Put<char>(this->empty);
  }

  static Part Read(vtkAvianLidarByteReader& list, int rank)
  {
    Part part;
    part.leaf.index = list.Get<unsigned int>();
    part.leaf.named = list.Get<char>() != 0;
    part.leaf.name = list.GetText();
    part.hash = list.Get<std::uint64_t>();
    part.empty = list.Get<char>() != 0;
    part.owner = rank;
    part.holders = 1;
    return part;
  }
};

//------------------------------------------------------------------------------
vtkAvianLidarSurfaceExchange::vtkAvianLidarSurfaceExchange() = default;
vtkAvianLidarSurfaceExchange::~vtkAvianLidarSurfaceExchange() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Release()
{
  this->Leaves.clear();
  this->Parts.clear();
  this->Kept.clear();
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Forget()
{
  this->Release();
  this->IsKnown = false;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarSurfaceExchange::Remember(std::uint64_t scene)
{
  this->Changed = !this->IsKnown || this->Known != scene;
  this->IsKnown = true;
  this->Known = scene;
  return this->Changed;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarSurfaceExchange::LookAt(vtkDataObject* input)
{
  std::string problem;
  this->Release();
  this->Fields = input->GetFieldData();
  this->FieldBytes = BytesOf(this->Fields);
  this->Leaves = Leaf::Collect(input, problem);
  for (const Leaf& leaf : this->Leaves)
  {
    const std::string wrong =
      problem.empty() ? leaf.Check(vtkAvianLidarSurfaceArrays(leaf.data)) : "";
    problem = wrong.empty() ? problem : leaf.Complaint(wrong);
  }
  for (std::size_t i = 0; problem.empty() && i < this->Leaves.size(); ++i)
  {
    Part part;
    part.leaf = this->Leaves[i];
    part.hash = vtkAvianLidarSurfaceState::HashOf(part.leaf.data);
    part.empty = !Parts::HasTriangles(part.leaf);
    this->Parts.push_back(part);
  }
  return problem;
}

//------------------------------------------------------------------------------
Outcome vtkAvianLidarSurfaceExchange::Run(const vtkAvianLidarRanks& ranks, vtkAlgorithm* self,
  vtkDataObject* input, const std::string& what)
{
  vtkAvianLidarByteWriter list;
  const Outcome looked = ranks.Together(self,
    [&]()
    {
      const std::string problem = this->LookAt(input);
      list.Put(HashOf(this->FieldBytes));
      for (const Part& part : this->Parts)
      {
        part.Write(list);
      }
      return problem.empty() ? problem : what + problem;
    });
  if (looked != Outcome::Done)
  {
    this->Forget();
    return looked;
  }
  if (ranks.Same(HashOf(list.Bytes)))
  {
    this->Remember(HashOf(list.Bytes)); // every rank has read all of it
    return Outcome::Done;
  }
  const std::vector<std::string> lists = ranks.Gather(list.Bytes);
  std::uint64_t all = 0;
  for (const std::string& bytes : lists)
  {
    all = avianlidar::hashOf(bytes.data(), bytes.size(), all);
  }
  if (!this->Remember(all))
  {
    this->Release();
    return Outcome::Done;
  }
  const Outcome sent = this->Send(ranks, self, lists);
  if (sent != Outcome::Done)
  {
    this->Forget();
  }
  return sent;
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Choose(const std::vector<std::string>& lists)
{
  std::map<unsigned int, std::vector<Part>> blocks;
  std::vector<std::uint64_t> fieldHashes;
  for (std::size_t rank = 0; rank < lists.size(); ++rank)
  {
    vtkAvianLidarByteReader list(lists[rank].data(), lists[rank].size());
    fieldHashes.push_back(list.Get<std::uint64_t>());
    while (!list.AtEnd())
    {
      const Part part = Part::Read(list, static_cast<int>(rank));
      std::vector<Part>& block = blocks[part.leaf.index];
      const auto same = std::find_if(
        block.begin(), block.end(), [&](const Part& known) { return known.hash == part.hash; });
      if (same == block.end())
      {
        block.push_back(part);
      }
      else
      {
        ++same->holders;
      }
    }
  }
  const auto owner = std::find_if(fieldHashes.begin(), fieldHashes.end(),
    [](std::uint64_t hash) { return hash != HashOf(std::string()); });
  this->FieldOwner = owner == fieldHashes.end() ? 0 : static_cast<int>(owner - fieldHashes.begin());
  this->SendFields = std::count(fieldHashes.begin(), fieldHashes.end(),
                       fieldHashes[this->FieldOwner]) != static_cast<std::ptrdiff_t>(lists.size());

  const std::vector<Part> mine = std::move(this->Parts);
  this->Parts.clear();
  for (auto& [index, block] : blocks)
  {
    this->AddBlock(block, mine);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::AddBlock(std::vector<Part>& block, const std::vector<Part>& mine)
{
  // A block that is empty everywhere is an object all the same; elsewhere empty parts say nothing.
  const bool empty =
    std::all_of(block.begin(), block.end(), [](const Part& part) { return part.empty; });
  bool first = true;
  for (Part& part : block)
  {
    if (part.empty && !(empty && first))
    {
      continue;
    }
    first = false;
    // A rank has one part of a block, in the order of blocks.
    const auto own = std::lower_bound(mine.begin(), mine.end(), part.leaf.index,
      [](const Part& p, unsigned int index) { return p.leaf.index < index; });
    const bool isMine =
      own != mine.end() && own->leaf.index == part.leaf.index && own->hash == part.hash;
    part.leaf.data = isMine ? own->leaf.data : nullptr;
    this->Parts.push_back(part);
  }
}

//------------------------------------------------------------------------------
Outcome vtkAvianLidarSurfaceExchange::Send(
  const vtkAvianLidarRanks& ranks, vtkAlgorithm* self, const std::vector<std::string>& lists)
{
  vtkAvianLidarByteWriter mine;
  Outcome outcome = ranks.Together(self,
    [&]() -> std::string
    {
      this->Choose(lists);
      this->Pack(ranks, mine);
      return {};
    });
  if (outcome != Outcome::Done)
  {
    return outcome;
  }
  vtkAvianLidarByteWriter size;
  size.Put<std::uint64_t>(mine.Bytes.size());
  std::vector<std::uint64_t> sizes;
  for (const std::string& bytes : ranks.Gather(size.Bytes))
  {
    sizes.push_back(vtkAvianLidarByteReader(bytes.data(), bytes.size()).Get<std::uint64_t>());
  }
  std::string buffer;
  outcome = ranks.Together(self,
    [&]() -> std::string
    {
      buffer.resize(*std::max_element(sizes.begin(), sizes.end()));
      return {};
    });
  std::exception_ptr trouble; // of unpacking: all must go on receiving
  for (int rank = 0; rank < ranks.Size() && outcome == Outcome::Done; ++rank)
  {
    const bool own = rank == ranks.Rank();
    ranks.Broadcast(own ? &mine.Bytes[0] : &buffer[0], sizes[rank], rank);
    this->BytesSent += own ? sizes[rank] : 0;
    try
    {
      if (!own && sizes[rank] > 0 && !trouble)
      {
        vtkAvianLidarByteReader reader(buffer.data(), sizes[rank]);
        this->Unpack(ranks, rank, reader);
      }
    }
    catch (...)
    {
      trouble = std::current_exception();
    }
  }
  if (outcome != Outcome::Done)
  {
    return outcome;
  }
  return ranks.Together(self,
    [&]() -> std::string
    {
      if (trouble)
      {
        std::rethrow_exception(trouble);
      }
      mine.Bytes = std::string();
      buffer = std::string();
      this->Join();
      return {};
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Pack(
  const vtkAvianLidarRanks& ranks, vtkAvianLidarByteWriter& bytes)
{
  if (this->SendFields && this->FieldOwner == ranks.Rank())
  {
    bytes.Put(this->FieldBytes);
    this->Fields = FieldsOf(this->FieldBytes); // the same as all others get
  }
  for (Part& part : this->Parts)
  {
    if (part.leaf.data)
    {
      this->Kept.push_back(Parts::Lean(part.leaf));
      part.leaf.data = this->Kept.back();
    }
    if (part.owner == ranks.Rank() && part.holders < ranks.Size())
    {
      Parts::Write(part.leaf.data, bytes);
    }
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Unpack(
  const vtkAvianLidarRanks& ranks, int rank, vtkAvianLidarByteReader& bytes)
{
  if (this->SendFields && this->FieldOwner == rank)
  {
    this->Fields = FieldsOf(bytes.GetText());
  }
  for (Part& part : this->Parts)
  {
    if (part.owner == rank && part.holders < ranks.Size())
    {
      const vtkSmartPointer<vtkPolyData> data = Parts::Read(bytes);
      if (!part.leaf.data)
      {
        this->Kept.push_back(data);
        part.leaf.data = data;
      }
    }
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarSurfaceExchange::Join()
{
  this->Leaves.clear();
  for (std::size_t i = 0; i < this->Parts.size();)
  {
    Leaf leaf = this->Parts[i].leaf;
    std::vector<vtkPolyData*> alike;
    for (; i < this->Parts.size() && this->Parts[i].leaf.index == leaf.index &&
         Parts::AreAlike(leaf.data, this->Parts[i].leaf.data);
         ++i)
    {
      alike.push_back(this->Parts[i].leaf.data);
    }
    if (alike.size() > 1)
    {
      this->Kept.push_back(Parts::Join(alike));
      leaf.data = this->Kept.back();
    }
    if (!leaf.named && !leaf.name.empty())
    {
      leaf.name = Leaf::NameOfBlock(this->Leaves.size());
    }
    this->Leaves.push_back(leaf);
  }
}
