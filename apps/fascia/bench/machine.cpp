#include "bench/machine.h"

#include <ctime>
#include <fstream>

#include <fmt/core.h>
#include <malloc.h>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  return fmt::format("{:04}-{:02}-{:02}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday);
}

}  // namespace

Json machineInfo() {
  return Json::Object{{"processor", processor()},
                      {"hardware_threads", hardwareThreads()},
                      {"compiler", __VERSION__},
                      {"date", today()}};
}

std::string machineLine() {
  return fmt::format("{}, {} hardware threads, {}", processor(), hardwareThreads(), today());
}

std::size_t heapInUse_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

}  // namespace fascia
