// SPDX-License-Identifier: BSD-3-Clause
#include "DetectionLaws.h"

#include <algorithm>

namespace avianlidar
{
std::shared_ptr<const DetectionLaw> DetectionLaws::get(const Sensor& sensor,
  const std::shared_ptr<const TargetViews>& views, double lowest, double highest, int mostBeams)
{
  std::vector<double> numbers = { lowest, highest, static_cast<double>(mostBeams),
    static_cast<double>(sensor.receiverModel) };
  for (const SensorField& field : sensorFields())
  {
    numbers.push_back(sensor.*field.member);
  }
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const auto found = std::find_if(this->Laws.begin(), this->Laws.end(),
    [&](const Kept& kept) { return kept.views == views && kept.numbers == numbers; });
  if (found != this->Laws.end())
  {
    std::rotate(found, found + 1, this->Laws.end());
    return this->Laws.back().law;
  }
  std::size_t bytes = 0;
  const auto last = std::find_if(this->Laws.rbegin(), this->Laws.rend(),
    [&bytes](const Kept& kept) { return (bytes += kept.law->bytes()) > MostBytes; });
  this->Laws.erase(this->Laws.begin(), last.base()); // before the new law needs memory
  auto law = std::make_shared<const DetectionLaw>(sensor, *views, lowest, highest, mostBeams);
  this->Laws.push_back({ std::move(numbers), views, std::move(law) });
  return this->Laws.back().law;
}
}
