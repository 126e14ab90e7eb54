// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: <target>_replay FOLDER_OR_FILE...
//        <target>_replay --blind COUNT SEED FOLDER_OR_FILE...
// Runs a fuzz target once on each file, with any compiler; or on COUNT mixtures of them, made at random. Without
// sanitizers that is many times faster than the fuzzer, and finds what does not hold, but not how to get there. A
// finding ends it, as it ends the fuzzer; a mixture that ends it is written to blind_input.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "fuzz.h"

namespace {

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void run(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// The beginning of one input, the end of another, and some other bytes.
std::string mixture(const std::vector<std::string>& inputs, std::mt19937& dice) {
  const auto pick = [&dice](std::size_t count) { return count == 0 ? 0 : dice() % count; };
  std::string bytes = inputs[pick(inputs.size())];
  const std::string& other = inputs[pick(inputs.size())];
  const std::size_t cut = pick(std::min(bytes.size(), other.size()));
  bytes = bytes.substr(0, cut) + other.substr(cut);
  for (std::size_t changes = pick(12); changes > 0 && !bytes.empty(); --changes) {
    bytes[pick(bytes.size())] = static_cast<char>(dice());
  }
  for (std::size_t more = pick(4) == 0 ? pick(80) : 0; more > 0; --more) {
    bytes += static_cast<char>(dice());
  }
  return bytes;
}

std::string mixed;

void keep_mixed(int signal) {
  std::ofstream("blind_input", std::ios::binary) << mixed;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

int main(int argc, char** argv) {
  const bool blind = argc > 4 && std::string(argv[1]) == "--blind";
  std::vector<std::filesystem::path> files;
  for (int k = blind ? 4 : 1; k < argc; ++k) {
    if (std::filesystem::is_directory(argv[k])) {
      for (const auto& entry : std::filesystem::directory_iterator(argv[k])) {
        files.push_back(entry.path());
      }
    } else {
      files.emplace_back(argv[k]);
    }
  }
  std::sort(files.begin(), files.end());
  LLVMFuzzerTestOneInput(nullptr, 0);
  std::vector<std::string> inputs;
  for (const std::filesystem::path& file : files) {
    inputs.push_back(contents(file));
    if (!blind) {
      std::fprintf(stderr, "%s\n", file.c_str());  // the last one is what ended it
      run(inputs.back());
    }
  }
  if (blind && !inputs.empty()) {
    for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS}) {
      std::signal(signal, keep_mixed);
    }
    std::mt19937 dice(static_cast<unsigned>(std::stoul(argv[3])));
    for (unsigned long k = std::stoul(argv[2]); k > 0; --k) {
      mixed = mixture(inputs, dice);
      run(mixed);
    }
  }
  std::fprintf(stderr, "%zu inputs\n", files.size());
  return files.empty() ? 1 : 0;
}
