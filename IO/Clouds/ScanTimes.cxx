// SPDX-License-Identifier: BSD-3-Clause
#include "ScanTimes.h"

#include "TextLines.h"

#include <boost/date_time/posix_time/posix_time_types.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <optional>
#include <regex>
#include <set>

namespace avianlidar::formats
{
namespace
{
namespace fs = std::filesystem;
using Times = std::vector<double>;

// Times that a number in a name may be, s since 1970: 2001-09-09 to 2100-01-01.
constexpr double Earliest = 1e9;
constexpr double Latest = 4102444800.0;

/// Converts a date and a time in ISO 8601 to seconds since 1970. Without an offset the time is UTC.
std::optional<double> isoTime(const std::smatch& found)
{
  using namespace boost::posix_time;
  const auto number = [&](int group) { return std::stoi(found[group].str()); };
  try
  {
    const boost::gregorian::date day(number(1), number(2), number(3));
    if (number(4) > 23 || number(5) > 59 || number(6) > 60)
    {
      return std::nullopt;
    }
    const ptime time(day, hours(number(4)) + minutes(number(5)) + seconds(number(6)));
    const ptime origin(boost::gregorian::date(1970, 1, 1));
    double offset = 0.0;
    if (found[10].matched)
    {
      const int minutesOfZone = found[11].matched ? number(11) : 0;
      offset = (found[9].str() == "-" ? -60.0 : 60.0) * (60 * number(10) + minutesOfZone);
    }
    const std::string digits = found[7].str() + found[8].str(); // one of them is empty
    const double fraction = digits.empty() ? 0.0 : std::stod("0." + digits);
    return static_cast<double>((time - origin).total_seconds()) + fraction - offset;
  }
  catch (const std::out_of_range&) // there is no such day
  {
    return std::nullopt;
  }
}

const std::regex& isoPattern()
{
  static const std::regex pattern(
    "(?:^|[^0-9])(\\d{4})[-_.]?(\\d\\d)[-_.]?(\\d\\d)[T_ "
    "-]?(\\d\\d)[-:_.h]?(\\d\\d)[-:_.m]?(\\d\\d)"
    "(?:[.,](\\d{1,9})|[-_]?(\\d{3}|\\d{6}|\\d{9}))?(?:([+-])(\\d\\d)(?::?(\\d\\d))?|Z)?(?![0-9])");
  return pattern;
}

/// Converts digits that count units since 1970 to seconds.
std::optional<double> sinceEpoch(const std::string& digits, const std::string& fraction)
{
  const std::size_t count = digits.size();
  if (count != 10 && (count < 13 || count > 19 || (count - 10) % 3 != 0 || !fraction.empty()))
  {
    return std::nullopt;
  }
  const double time = std::stod(digits.substr(0, 10)) +
    (count > 10 ? std::stod("0." + digits.substr(10)) : 0.0) +
    (fraction.empty() ? 0.0 : std::stod("0." + fraction));
  return time >= Earliest && time < Latest ? std::optional<double>(time) : std::nullopt;
}

/// Returns the time in a name, s since 1970. The last time in the name counts, since a name may
/// begin with the time of the whole recording.
std::optional<double> timeInName(const std::string& name)
{
  std::optional<double> time;
  static const std::regex digits("(\\d+)(?:(?:\\.(\\d{3}|\\d{6}|\\d{9})|_(\\d{9}))(?![0-9]))?");
  for (std::sregex_iterator it(name.begin(), name.end(), digits), end; it != end; ++it)
  {
    const std::optional<double> found = sinceEpoch((*it)[1].str(), (*it)[2].str() + (*it)[3].str());
    time = found ? found : time;
  }
  if (!time)
  {
    for (std::sregex_iterator it(name.begin(), name.end(), isoPattern()), end; it != end; ++it)
    {
      const std::optional<double> found = isoTime(*it);
      time = found ? found : time;
    }
  }
  return time;
}

/// Returns a function's values for all items, or nothing if an item has no value.
template <class F>
std::optional<Times> forAll(const std::vector<std::string>& items, const F& valueOf)
{
  Times values;
  for (const std::string& item : items)
  {
    const std::optional<double> value = valueOf(item);
    if (!value)
    {
      return std::nullopt;
    }
    values.push_back(*value);
  }
  return values;
}

/// Returns whether no two times are the same. Otherwise the numbers in the names are no times, but,
/// for example, serial numbers.
bool differ(const Times& times)
{
  return std::set<double>(times.begin(), times.end()).size() == times.size();
}

/// Returns the numbers by which the names differ, if they differ by one number alone.
std::optional<Times> countsInNames(const std::vector<std::string>& names)
{
  static const std::regex digits("\\d+");
  std::vector<std::vector<std::string>> numbers; // of each name
  std::set<std::string> shapes;                  // names without numbers
  for (const std::string& name : names)
  {
    shapes.insert(std::regex_replace(name, digits, "#"));
    numbers.emplace_back(
      std::sregex_token_iterator(name.begin(), name.end(), digits), std::sregex_token_iterator());
  }
  if (shapes.size() != 1)
  {
    return std::nullopt;
  }
  std::optional<Times> counts;
  for (std::size_t place = 0; place < numbers.front().size(); ++place)
  {
    std::vector<std::string> here;
    for (const std::vector<std::string>& of : numbers)
    {
      here.push_back(of[place]);
    }
    if (std::set<std::string>(here.begin(), here.end()).size() > 1)
    {
      if (counts)
      {
        return std::nullopt;
      }
      counts = forAll(here, [](const std::string& text) { return parsed<double>(text); });
    }
  }
  return counts;
}

/// Returns the times in the lines of a file.
Times timesInFile(const std::string& file)
{
  FileSource source(file);
  TextLines lines(source, 0);
  Times times;
  for (std::string line; lines.get(line);)
  {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos)
    {
      continue;
    }
    line = line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
    std::optional<double> time = parsed<double>(line);
    std::smatch found;
    if (!time && line.size() < 64 && std::regex_search(line, found, isoPattern()))
    {
      time = isoTime(found);
    }
    failIf(!time || !std::isfinite(*time), file, ": line ", times.size() + 1, " has \"",
      shown(line), "\", expected seconds, or a date and a time as 2011-09-26 13:02:25.59");
    times.push_back(*time);
  }
  return times;
}

std::string fileOfTimes(const std::string& scan)
{
  const fs::path home = fs::absolute(scan).parent_path();
  for (const fs::path& folder : { home, home.parent_path() })
  {
    for (const char* name : { "times.txt", "timestamps.txt" })
    {
      if (fs::is_regular_file(folder / name))
      {
        return (folder / name).string();
      }
    }
  }
  return "";
}

/// Returns the times of files from the lines of a file of times.
Times timesOfLines(const std::string& file, std::size_t scans, const std::optional<Times>& counts)
{
  const Times lines = timesInFile(file);
  const bool numbered =
    counts && *std::max_element(counts->begin(), counts->end()) < static_cast<double>(lines.size());
  failIf(!numbered && lines.size() != scans, file, ": has ", lines.size(),
    " times, expected one for each of ", scans, " scans");
  Times times = lines;
  if (numbered)
  {
    times.clear();
    for (const double count : *counts)
    {
      times.push_back(lines[static_cast<std::size_t>(count)]);
    }
  }
  return times;
}
}

//------------------------------------------------------------------------------
ScanTimes timesOfScans(const std::vector<std::string>& files, double rate)
{
  ScanTimes scans;
  if (files.empty())
  {
    return scans;
  }
  std::vector<std::string> names;
  for (const std::string& file : files)
  {
    names.push_back(fs::path(file).stem().string());
  }
  const std::optional<Times> counts = countsInNames(names);
  const std::string listed = rate > 0.0 ? "" : fileOfTimes(files.front());
  Times times(files.size());
  std::iota(times.begin(), times.end(), 0.0);
  const auto atRate = [&](double hertz)
  {
    times = counts.value_or(times);
    const double first = *std::min_element(times.begin(), times.end());
    std::for_each(times.begin(), times.end(), [&](double& time) { time = (time - first) / hertz; });
  };
  if (rate > 0.0)
  {
    atRate(rate);
    scans.origin = joined(rate, " scans a second, as given");
  }
  else if (!listed.empty())
  {
    times = timesOfLines(listed, files.size(), counts);
    scans.origin = fs::path(listed).filename().string();
  }
  else if (const std::optional<Times> inNames = forAll(names, timeInName);
           inNames && differ(*inNames))
  {
    times = *inNames;
    scans.origin = "names of the files, s since 1970";
  }
  else
  {
    atRate(AssumedScanRate);
    scans.origin = joined(AssumedScanRate, " scans a second, assumed");
  }
  std::vector<std::size_t> order(files.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(
    order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
  for (const std::size_t i : order)
  {
    if (!scans.seconds.empty() && times[i] == scans.seconds.back())
    {
      fail(files[i], " and ", fs::path(scans.files.back()).filename().string(),
        " have the same time, ", times[i], " s, expected scans at different times");
    }
    scans.seconds.push_back(times[i]);
    scans.files.push_back(files[i]);
  }
  return scans;
}
}
