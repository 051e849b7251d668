// SPDX-License-Identifier: BSD-3-Clause
#include "AvailableMemory.h"
#include "Figures.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

using namespace avianlidar;

namespace
{
constexpr double Unlimited = std::numeric_limits<double>::infinity();

/// Files of a system in a folder that goes with it.
class System
{
public:
  System()
    : Root(std::filesystem::temp_directory_path() /
        ("avianlidar-memory-" +
          std::string(testing::UnitTest::GetInstance()->current_test_info()->name())))
  {
    std::filesystem::remove_all(this->Root);
  }
  ~System() { std::filesystem::remove_all(this->Root); }
  System& with(const std::string& file, const std::string& text)
  {
    std::filesystem::create_directories((this->Root / file).parent_path());
    std::ofstream(this->Root / file) << text;
    return *this;
  }
  double left(double addressLimit = Unlimited) const
  {
    return availableMemory(this->Root.string(), addressLimit);
  }

private:
  std::filesystem::path Root;
};

std::string messageOf(double count, double bytes)
{
  return statistics::errorOf([=]() { requireMemory(count, "beams", bytes); });
}
}

TEST(TestAvailableMemory, isUnlimitedWhereNothingIsSaid)
{
  EXPECT_EQ(System().left(), Unlimited);
}

TEST(TestAvailableMemory, isWhatTheSystemHas)
{
  System system;
  system.with("proc/meminfo", "MemTotal: 9000 kB\nMemFree: 10 kB\nMemAvailable:    2000 kB\n");
  EXPECT_EQ(system.left(), 2000.0 * 1024);
  // 300 kB of 1000 kB are taken.
  system.with("proc/self/status", "Name: x\nVmPeak: 900 kB\nVmSize:\t 300 kB\n");
  EXPECT_EQ(system.left(1000.0 * 1024), 700.0 * 1024);
  EXPECT_EQ(system.left(200.0 * 1024), 0.0);
}

TEST(TestAvailableMemory, isWhatGroupsOfVersion2Leave)
{
  System system;
  system.with("proc/self/cgroup", "0::/a/b\n")
    .with("sys/fs/cgroup/a/b/memory.max", "max\n")
    .with("sys/fs/cgroup/a/memory.max", "5000\n")
    .with("sys/fs/cgroup/a/memory.current", "3000\n")
    .with("sys/fs/cgroup/a/memory.stat", "anon 2000\ninactive_file 600\nactive_file 400\n");
  EXPECT_EQ(system.left(), 3000.0);
  system.with("sys/fs/cgroup/a/b/memory.max", "1000\n")
    .with("sys/fs/cgroup/a/b/memory.current", "900\n");
  EXPECT_EQ(system.left(), 100.0);
}

TEST(TestAvailableMemory, isWhatGroupsOfVersion1LeaveAlsoWhereOnlyTheRootIsMounted)
{
  System system;
  system.with("proc/self/cgroup", "9:name=systemd:/\n4:memory:/process/x\n0::/\n")
    .with("sys/fs/cgroup/memory/memory.limit_in_bytes", "8000\n")
    .with("sys/fs/cgroup/memory/memory.usage_in_bytes", "1000\n");
  EXPECT_EQ(system.left(), 7000.0);
}

TEST(TestAvailableMemory, numbersInSentencesHaveNoExponent)
{
  const struct
  {
    double value;
    int digits;
    const char* text;
  } cases[] = { { 99.6, 2, "100" }, { 12000.0, 4, "12000" }, { -5412345.6, 3, "-5410000" },
    { 3525.22, 4, "3525" }, { 9.996, 3, "10" }, { 0.25, 3, "0.25" }, { 3.5e-5, 3, "3.5e-05" },
    { 1.7e9, 15, "1700000000" }, { 2e15, 3, "2e+15" }, { 0.0, 3, "0" } };
  for (const auto& c : cases)
  {
    EXPECT_EQ(figures(c.value, c.digits), c.text);
  }
  EXPECT_EQ(figures(Unlimited, 3), "inf");
}

TEST(TestAvailableMemory, refusesWhatIsNotThere)
{
  EXPECT_EQ(messageOf(10, 1e6), "");
  EXPECT_EQ(messageOf(1, 65e6), "");
  const std::string said = messageOf(1e8, 1e18);
  EXPECT_EQ(said.find("100,000,000 beams need about 1e+09 GB, "), 0u) << said;
  statistics::expectSays(said, " GB are available");
  EXPECT_EQ(messageOf(1.2e18, 1e19).find("1.2e+18 beams need about 1e+10 GB, "), 0u);
}
