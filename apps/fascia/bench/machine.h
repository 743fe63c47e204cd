#pragma once

#include <cstddef>
#include <string>

#include <fascia/io/json/json.h>

namespace fascia {

// Where and when figures were taken: processor family, threads, date. Names no machine.
Json machineInfo();
std::string machineLine();

// Bytes that the program has allocated and not yet freed.
std::size_t heapInUse_bytes();

}  // namespace fascia
