// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "TreeSerialization.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
std::shared_ptr<const TriangleMesh> mesh()
{
  Numbers random(81);
  return std::make_shared<TriangleMesh>(
    closedSurface(3, [&](const Vec3&) { return random(4.0, 5.0); }));
}

FlatTree flat(BoundingVolumeType type = BoundingVolumeType::AABB)
{
  TreeOptions options;
  options.boundingVolume = type;
  return flattenTree(*buildCollisionTree(mesh(), options));
}

std::string errorOf(const FlatTree& tree)
{
  try
  {
    restoreTree(mesh(), tree);
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return {};
}

void expectError(const std::function<void(FlatTree&)>& damage, const std::string& words,
  BoundingVolumeType type = BoundingVolumeType::AABB)
{
  FlatTree tree = flat(type);
  damage(tree);
  const std::string error = errorOf(tree);
  EXPECT_NE(error.find(words), std::string::npos)
    << "'" << error << "' does not say '" << words << "'";
}

std::size_t firstLeaf(const FlatTree& tree)
{
  std::size_t node = 0;
  while (tree.nodes[2 * node + 1] == 0)
  {
    ++node;
  }
  return node;
}

template <typename Value>
bool sameBytes(const std::vector<Value>& one, const std::vector<Value>& two)
{
  return one.size() == two.size() &&
    (one.empty() || std::memcmp(one.data(), two.data(), one.size() * sizeof(Value)) == 0);
}
}

TEST(TreeSerialization, RoundTripIsExact)
{
  for (int rule = 0; rule < 4; ++rule)
  {
    for (int type = 0; type < 3; ++type)
    {
      const TreeOptions options{ static_cast<SplitRule>(rule),
        static_cast<BoundingVolumeType>(type), 3 };
      const auto tree = buildCollisionTree(mesh(), options);
      const FlatTree once = flattenTree(*tree);
      EXPECT_EQ(once.volumes.size(), tree->nodes.size() * numbersPerVolume(options.boundingVolume));
      const auto restored = restoreTree(mesh(), once);
      EXPECT_EQ(restored->checksum, tree->checksum);
      EXPECT_EQ(restored->options.maximumLeafSize, 3);
      const FlatTree again = flattenTree(*restored);
      EXPECT_EQ(once.nodes, again.nodes);
      EXPECT_EQ(once.order, again.order);
      EXPECT_TRUE(sameBytes(once.volumes, again.volumes));
    }
  }
}

TEST(TreeSerialization, TransferIsExact)
{
  for (int type = 0; type < 3; ++type)
  {
    const TreeOptions options{ SplitRule::SurfaceAreaHeuristic,
      static_cast<BoundingVolumeType>(type), 3 };
    const auto tree = buildCollisionTree(mesh(), options);
    const FlatTree sent = flattenForTransfer(*tree);
    EXPECT_EQ(sent.volumes.empty(), type == 0); // boxes follow from the triangles
    const auto restored = restoreTransferred(mesh(), sent, 2);
    const FlatTree once = flattenTree(*tree);
    const FlatTree again = flattenTree(*restored);
    EXPECT_EQ(once.nodes, again.nodes);
    EXPECT_EQ(once.order, again.order);
    EXPECT_TRUE(sameBytes(once.volumes, again.volumes));
    EXPECT_TRUE(sameBytes(tree->wide.nodes, restored->wide.nodes));
    EXPECT_EQ(tree->leafTriangles.size(), restored->leafTriangles.size());
    EXPECT_EQ(tree->checksum, restored->checksum);
  }
  FlatTree sent = flattenForTransfer(*buildCollisionTree(mesh(), TreeOptions()));
  sent.order.pop_back();
  EXPECT_THROW(restoreTransferred(mesh(), sent, 1), std::invalid_argument);
  const auto nothing = std::make_shared<const TriangleMesh>();
  EXPECT_TRUE(
    restoreTransferred(nothing, flattenForTransfer(*buildCollisionTree(nothing, TreeOptions())), 1)
      ->nodes.empty());
}

TEST(TreeSerialization, EmptyTree)
{
  const auto nothing = std::make_shared<const TriangleMesh>();
  const auto restored =
    restoreTree(nothing, flattenTree(*buildCollisionTree(nothing, TreeOptions())));
  EXPECT_TRUE(restored->nodes.empty());
}

TEST(TreeSerialization, DamageIsNamed)
{
  EXPECT_THROW(restoreTree(nullptr, flat()), std::invalid_argument);
  expectError([](FlatTree& t) { t.options.maximumLeafSize = 0; }, "options");
  expectError([](FlatTree& t) { t.options.splitRule = static_cast<SplitRule>(9); }, "options");
  expectError(
    [](FlatTree& t) { t.options.boundingVolume = static_cast<BoundingVolumeType>(3); }, "options");
  expectError(
    [](FlatTree& t) { t.options.boundingVolume = BoundingVolumeType::OBB; }, "numbers of bounding");
  expectError([](FlatTree& t) { ++t.checksum; }, "checksums differ");
  expectError([](FlatTree& t) { t.order.pop_back(); }, "orders 511 triangles");
  expectError([](FlatTree& t) { t.nodes.pop_back(); }, "odd number");
  expectError([](FlatTree& t) { t.nodes.clear(); }, "0 nodes do not fit");
  expectError([](FlatTree& t) { t.nodes.insert(t.nodes.end(), 4000, 0u); }, "do not fit");
  expectError([](FlatTree& t) { t.volumes.pop_back(); }, "numbers of bounding volumes");
  expectError(
    [](FlatTree& t) { t.nodes[2] = 0; }, "node 1: its first child is 0, expected 3"); // a cycle
  expectError([](FlatTree& t) { t.nodes[0] = 0xffffffffu; }, "node 0: its first child");
  expectError([](FlatTree& t) { t.order[7] = t.order[8]; }, "twice");
  expectError([](FlatTree& t) { t.order[7] = 512; }, "triangle 512 of 512");
  expectError([](FlatTree& t) { t.nodes[2 * firstLeaf(t) + 1] = 5; }, "a leaf of 5 triangles");
  expectError([](FlatTree& t) { t.nodes[2 * firstLeaf(t)] = 0xfffffffeu; }, "a leaf of");
  expectError([](FlatTree& t) { t.nodes[2 * firstLeaf(t) + 1] -= 1; }, "in no leaf");
  expectError(
    [](FlatTree& t)
    {
      const std::size_t leaf = firstLeaf(t);
      t.nodes[2 * leaf] = t.nodes[2 * leaf] == 0 ? 1 : t.nodes[2 * leaf] - 1;
    },
    "two leaves");
  // Leaves in place of inner nodes leave their children without a parent.
  expectError(
    [](FlatTree& t)
    {
      t.options.maximumLeafSize = 600;
      t.nodes[0] = 0;
      t.nodes[1] = 512;
      t.nodes[3] = 0;
    },
    "node");
}

TEST(TreeSerialization, AListInPlaceOfATreeIsRefusedBeforeItsContentsAreChecked)
{
  // Each node has a leaf of one triangle and all the rest: a check of what volumes hold would take
  // the square of so many steps.
  constexpr std::uint32_t count = 20000;
  auto many = std::make_shared<TriangleMesh>();
  FlatTree list;
  list.options.maximumLeafSize = 1;
  for (std::uint32_t t = 0; t < count; ++t)
  {
    const double x = static_cast<double>(t);
    many->points.insert(many->points.end(), { Vec3(x, 0, 0), Vec3(x, 1, 0), Vec3(x, 0, 1) });
    many->triangles.push_back({ 3 * t, 3 * t + 1, 3 * t + 2 });
    list.order.push_back(t);
  }
  list.nodes = { 1, 0 }; // the root; then at each level a leaf and an inner node, or the last leaf
  for (std::uint32_t level = 1; level < count; ++level)
  {
    const bool last = level + 1 == count;
    list.nodes.insert(
      list.nodes.end(), { level - 1, 1u, last ? level : 2 * level + 1, last ? 1u : 0u });
  }
  for (std::size_t node = 0; node < list.nodes.size() / 2; ++node)
  {
    list.volumes.insert(list.volumes.end(), { 0.0, 0.0, 0.0, 1.0 * count, 1.0, 1.0 });
  }
  list.checksum = many->checksum();
  try
  {
    restoreTree(many, list);
    ADD_FAILURE() << "taken";
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find("129 levels below the root"), std::string::npos)
      << error.what();
  }
}

TEST(TreeSerialization, DamagedVolumesAreNamed)
{
  for (const double bad : { static_cast<double>(NAN), static_cast<double>(INFINITY), 1e300 })
  {
    expectError([&](FlatTree& t) { t.volumes[6 * 5 + 3] = bad; }, "node 5: a number of its volume");
  }
  expectError([](FlatTree& t) { std::swap(t.volumes[0], t.volumes[3]); }, "node 0: a lower corner");
  expectError(
    [](FlatTree& t) { t.volumes[4] -= 0.5; }, "node 0: its volume does not hold triangle");
  expectError([](FlatTree& t) { t.volumes[15 * 2 + 3] += 1e-6; }, "node 2: the axes",
    BoundingVolumeType::OBB);
  expectError(
    [](FlatTree& t) { t.volumes[15 * 2 + 13] *= -1.0; }, "node 2: a half", BoundingVolumeType::OBB);
  expectError([](FlatTree& t) { t.volumes[15 * 2 + 13] *= 0.99; },
    "node 2: its volume does not hold", BoundingVolumeType::OBB);
  expectError([](FlatTree& t) { t.volumes[4 * 3 + 3] = -1.0; }, "node 3: the radius",
    BoundingVolumeType::Sphere);
  expectError([](FlatTree& t) { t.volumes[4 * 3 + 3] *= 0.99; }, "node 3: its volume does not hold",
    BoundingVolumeType::Sphere);
}

TEST(TreeSerialization, NoSingleChangedNumberIsAcceptedUnlessItIsHarmless)
{
  // Whatever is accepted holds every triangle where it belongs, so hits cannot change; all else is
  // refused, not crashed on (run under the sanitizers as well).
  Numbers random(82);
  const FlatTree good = flat();
  for (int i = 0; i < 3000; ++i)
  {
    FlatTree tree = good;
    const std::uint32_t number = random() < 0.5
      ? static_cast<std::uint32_t>(random.index(600))
      : static_cast<std::uint32_t>(random.index(1u << 31) * 2);
    std::vector<std::uint32_t>& target = random() < 0.5 ? tree.nodes : tree.order;
    const std::size_t at = random.index(target.size());
    if (target[at] != number)
    {
      target[at] = number;
      EXPECT_NE(errorOf(tree), "");
    }
  }
}

TEST(TreeSerialization, MeshWithMissingPointsIsRefused)
{
  TriangleMesh broken = *mesh();
  FlatTree tree = flat();
  broken.triangles[9][1] = 100000;
  tree.checksum = broken.checksum();
  EXPECT_THROW(restoreTree(std::make_shared<TriangleMesh>(broken), tree), std::invalid_argument);
}
