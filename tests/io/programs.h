#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <fascia/io/file/child_process.h>

namespace fascia::test {

inline void expectSuccess(const std::string& program, const std::vector<std::string>& arguments) {
  std::optional<ChildProcess> process = ChildProcess::start(program, arguments);
  ASSERT_TRUE(process.has_value());
  const bool good = process->finish();
  EXPECT_TRUE(good) << process->complaints();
}

}  // namespace fascia::test
