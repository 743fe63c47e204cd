#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

// What one run of the program did.
struct Outcome {
  int exitCode = -1;  // -1: a signal ended it
  int signal = 0;
  std::string out, err;

  nlohmann::json json() const;  // of `out`; a failure of the test if it is none
};

// A program that runs beside the test.
class Process {
 public:
  Process(const std::filesystem::path& folder, const std::vector<std::string>& arguments);
  ~Process();  // killed if still there
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool running();
  void send(int signal) const;
  bool hasChild() const;  // another program that it has started
  Outcome wait();

 private:
  void note(int status);

  std::filesystem::path out_, err_;
  int pid_ = 0;
  bool ended_ = false;
  Outcome outcome_;
};

// A scratch folder that holds ball.fascia.json, and the program run inside of it.
class Cli : public testing::Test {
 protected:
  Cli();
  ~Cli() override;

  Outcome run(const std::vector<std::string>& arguments) const;
  bool exists(const std::string& file) const { return std::filesystem::exists(folder_ / file); }
  std::string content(const std::string& file) const;
  void write(const std::string& file, const std::string& text) const;
  std::vector<std::string> files() const;  // names, sorted, hidden ones too

  std::filesystem::path folder_;
};

std::string readWhole(const std::filesystem::path& path);
